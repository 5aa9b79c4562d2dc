// What can be measured on the surface of the tetrahedra, at rest: the volume that it encloses, and how long
// the cuts are that open it.

/** @param {{triangles: Uint32Array, rest: Float32Array}} surface closed @returns {number} [m³] */
export function volumeOf({triangles, rest}) {
  let six = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    six +=
      rest[a] * (rest[b + 1] * rest[c + 2] - rest[b + 2] * rest[c + 1]) +
      rest[a + 1] * (rest[b + 2] * rest[c] - rest[b] * rest[c + 2]) +
      rest[a + 2] * (rest[b] * rest[c + 1] - rest[b + 1] * rest[c]);
  }
  return six / 6;
}

// The number of each vertex's place: vertices at the same place have the same.
function placesOf(rest) {
  const known = new Map(),
    places = new Uint32Array(rest.length / 3);
  for (let v = 0; v < places.length; ++v) {
    const key = `${rest[3 * v]} ${rest[3 * v + 1]} ${rest[3 * v + 2]}`;
    if (!known.has(key)) known.set(key, known.size);
    places[v] = known.get(key);
  }
  return places;
}

/**
 * How long the edge is at which faces that were opened meet the skin, each of its pieces counted once: of a
 * slit, whose two lips lie on each other, its length; of a hole, what is around it.
 * @param {{triangles: Uint32Array, rest: Float32Array, cut: Uint8Array}} surface @returns {number} [m]
 */
export function cutLength({triangles, rest, cut}) {
  if (!cut.some(kind => kind > 0)) return 0;
  const places = placesOf(rest),
    skin = new Set(),
    rim = new Map();
  const edges = function* (t) {
    for (let k = 0; k < 3; ++k) {
      const [v, w] = [triangles[3 * t + k], triangles[3 * t + ((k + 1) % 3)]],
        [a, b] = [places[v], places[w]];
      yield [Math.min(a, b) * rest.length + Math.max(a, b), v, w];
    }
  };
  for (let t = 0; t < cut.length; ++t) if (!cut[t]) for (const [key] of edges(t)) skin.add(key);
  for (let t = 0; t < cut.length; ++t)
    if (cut[t]) for (const [key, v, w] of edges(t)) if (skin.has(key)) rim.set(key, [v, w]);
  let length = 0;
  for (const [v, w] of rim.values())
    length += Math.hypot(...[0, 1, 2].map(k => rest[3 * v + k] - rest[3 * w + k]));
  return length;
}
