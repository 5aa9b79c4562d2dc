// Which vertices lie at the same place at rest, as those of the two lips of a cut do. The positions at rest
// that come are differences of numbers of single precision: they are off by some nanometres, and for each lip
// by others once the cut has opened.
const tolerance = 1e-6, // of the largest coordinate
  cell = 100; // of the grid, in tolerances; what lies in one of its cells is one place

/** @param {ArrayLike<number>} rest @returns {Uint32Array} for each vertex the first one at its place */
export function firstAtPlaces(rest) {
  let most = 0;
  for (let i = 0; i < rest.length; ++i) most = Math.max(most, Math.abs(rest[i]));
  const near = 1 / cell,
    scale = most > 0 ? near / (tolerance * most) : 1,
    known = new Map(), // cell → the first vertex in it
    first = new Uint32Array(rest.length / 3);
  // Near the border of a cell a place may be known in the next one.
  const cellsOf = at => {
    const own = Math.floor(at),
      low = Math.floor(at - near),
      high = Math.floor(at + near);
    return low < own ? [own, low] : high > own ? [own, high] : [own];
  };
  const keysOf = v => {
    const [x, y, z] = [0, 1, 2].map(k => cellsOf(rest[3 * v + k] * scale));
    return x.flatMap(i => y.flatMap(j => z.map(k => `${i},${j},${k}`)));
  };
  for (let v = 0; v < first.length; ++v) {
    const keys = keysOf(v),
      found = keys.find(key => known.has(key));
    first[v] = found === undefined ? v : known.get(found);
    if (found === undefined) known.set(keys[0], v);
  }
  return first;
}
