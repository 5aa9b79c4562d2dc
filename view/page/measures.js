// What can be measured on the surface of the tetrahedra, at rest: the volume that it encloses, and how long
// the cuts are that open it.
import {firstAtPlaces} from './places.js';

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

// Whether things are joined: the name of each, the same for those that are.
class Joined {
  #next = new Map();
  of(thing) {
    let name = thing;
    while (this.#next.has(name)) name = this.#next.get(name);
    return name;
  }
  join(a, b) {
    const [from, to] = [this.of(a), this.of(b)];
    if (from !== to) this.#next.set(from, to);
  }
}

const edgesOf = (triangles, t) =>
  [0, 1, 2].map(k => [triangles[3 * t + k], triangles[3 * t + ((k + 1) % 3)]]);

// Of a triangle, as long as twice its area.
function normalOf({triangles, rest}, t) {
  const [a, b, c] = [0, 1, 2].map(k => 3 * triangles[3 * t + k]);
  const [u, v] = [b, c].map(i => [0, 1, 2].map(k => rest[i + k] - rest[a + k]));
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
}

/**
 * How long the edge is at which faces that were opened meet the skin, each of its pieces counted once: of a
 * slit, whose two lips lie on each other, its length; of a hole, what is around it. Where what was opened
 * comes out on the far side, too, the longer side counts.
 * @param {{triangles: Uint32Array, rest: Float32Array, cut: Uint8Array}} surface @returns {number} [m]
 */
export function cutLength(surface) {
  const {triangles, rest, cut} = surface;
  if (!cut.some(kind => kind > 0)) return 0;
  const places = firstAtPlaces(rest),
    skin = new Map(), // edge → a triangle
    rim = new Map(), // edge → its ends
    cuts = new Joined(), // places within a cut
    pieces = new Joined(); // places along a rim
  const key = (v, w) => {
    const [a, b] = [places[v], places[w]];
    return Math.min(a, b) * rest.length + Math.max(a, b);
  };
  for (let t = 0; t < cut.length; ++t)
    if (!cut[t]) for (const [v, w] of edgesOf(triangles, t)) skin.set(key(v, w), t);
  for (let t = 0; t < cut.length; ++t)
    if (cut[t])
      for (const [v, w] of edgesOf(triangles, t)) {
        cuts.join(places[v], places[w]);
        if (!skin.has(key(v, w))) continue;
        rim.set(key(v, w), [v, w]);
        pieces.join(places[v], places[w]);
      }
  const found = new Map(); // piece → the cut that it is of, its length, and where it faces
  for (const [edge, [v, w]] of rim) {
    const name = pieces.of(places[v]),
      piece = found.get(name) ?? {of: cuts.of(places[v]), length: 0, faces: [0, 0, 0]};
    piece.length += Math.hypot(...[0, 1, 2].map(k => rest[3 * v + k] - rest[3 * w + k]));
    normalOf(surface, skin.get(edge)).forEach((n, k) => (piece.faces[k] += n));
    found.set(name, piece);
  }
  const longest = new Map();
  let length = 0;
  for (const piece of [...found.values()].toSorted((a, b) => b.length - a.length)) {
    const first = longest.get(piece.of);
    if (!first) longest.set(piece.of, piece);
    if (!first || first.faces.reduce((sum, n, k) => sum + n * piece.faces[k], 0) > 0) length += piece.length;
  }
  return length;
}
