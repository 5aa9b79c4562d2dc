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

const between = 0.05, // cosine of what faces neither way
  dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2],
  apart = (u, v) => (u[0] - v[0]) ** 2 + (u[1] - v[1]) ** 2 + (u[2] - v[2]) ** 2;

// On which side of a cut an edge of its rim is, by the blade that came nearest to its middle: 1 where the
// blade came from, −1 on the far side, 0 between. The normal is that of the skin there.
function sideOf(middle, normal, blades) {
  let best = Infinity,
    nearest;
  for (const blade of blades) {
    const distance = apart(blade.at, middle);
    if (distance <= best) [best, nearest] = [distance, blade]; // of equals the newest
  }
  const cosine = dot(normal, nearest.along) / Math.hypot(...normal) / Math.hypot(...nearest.along);
  return Math.abs(cosine) < between ? 0 : -Math.sign(cosine);
}

/**
 * How long the edge is at which faces that were opened meet the skin, each of its pieces counted once: of a
 * slit, whose two lips lie on each other, its length; of a hole, what is around it. Where what was opened
 * comes out on the far side, too, the longer side counts. Where a blade has cut through an edge of the organ,
 * only the blade tells which side is which.
 * @param {{triangles: Uint32Array, rest: Float32Array, cut: Uint8Array}} surface closed
 * @param {{at: number[], along: number[]}[]} blades where blades came in, and in which direction, at rest
 * @returns {number} [m]
 */
export function cutLength(surface, blades = []) {
  if (!surface.cut.some(kind => kind > 0)) return 0;
  let length = 0;
  for (const rim of rimsOf(surface).values())
    length += blades.length > 0 && rim.isByBlade ? longerSide(rim, blades) : longerFace(rim);
  return length;
}

// The edges at which each cut meets the skin, {piece, length, middle, normal}, and whether a blade has made
// any of it.
function rimsOf(surface) {
  const {triangles, rest, cut} = surface,
    places = firstAtPlaces(rest),
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
  const found = new Map();
  for (const [edge, [v, w]] of rim) {
    const name = cuts.of(places[v]),
      ends = [v, w].map(u => [0, 1, 2].map(k => rest[3 * u + k]));
    if (!found.has(name)) found.set(name, {isByBlade: false, edges: []});
    found.get(name).edges.push({
      piece: pieces.of(places[v]),
      length: Math.hypot(...ends[0].map((x, k) => x - ends[1][k])),
      middle: ends[0].map((x, k) => (x + ends[1][k]) / 2),
      normal: normalOf(surface, skin.get(edge)),
    });
  }
  for (let t = 0; t < cut.length; ++t)
    if (cut[t] === 1 && found.has(cuts.of(places[triangles[3 * t]])))
      found.get(cuts.of(places[triangles[3 * t]])).isByBlade = true;
  return found;
}

function longerSide({edges}, blades) {
  const sides = {1: 0, 0: 0, '-1': 0};
  for (const {length, middle, normal} of edges) sides[sideOf(middle, normal, blades)] += length;
  return Math.max(sides[1], sides[-1]);
}

// Of pieces of the rim those that face as the longest one does.
function longerFace({edges}) {
  const pieces = new Map();
  for (const {piece, length, normal} of edges) {
    const sum = pieces.get(piece) ?? {length: 0, faces: [0, 0, 0]};
    sum.length += length;
    normal.forEach((n, k) => (sum.faces[k] += n));
    pieces.set(piece, sum);
  }
  const [first, ...others] = [...pieces.values()].toSorted((a, b) => b.length - a.length),
    same = others.filter(({faces}) => dot(first.faces, faces) > 0);
  return [first, ...same].reduce((sum, {length}) => sum + length, 0);
}
