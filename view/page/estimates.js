// What a mesh of other edges would be like, from the one that is there.

/** Of regular tetrahedra with this edge [m] that fill a volume [m³]. */
export const tetrahedra = (volume, edge) => (6 * Math.SQRT2 * volume) / edge ** 3;

/** How fast it could go: each step costs what its tetrahedra do, and is as long as the smallest lets it.
 *  @param {{possible: number, tets: number}} now of the mesh that is there */
export const speed = ({possible, tets}, wanted) => possible * (tets / wanted) ** (4 / 3);

/** Of a body with this volume [m³] and surface [m²]. Where it is thin, each face has about one. */
export const tetrahedraOfBody = ({volume, area}, edge) =>
  Math.max(tetrahedra(volume, edge), area / ((Math.sqrt(3) / 4) * edge ** 2));

/** How fast another body could go, from the one that is there. Waves cross an edge [m] in a step.
 *  @param {{possible: number, tets: number, edge: number, wave: number}} now
 *  @param {{tets: number, edge: number, wave: number}} other with the speed of waves [m/s], or of both any
 *  multiple of it */
export const speedOfOther = (now, other) =>
  now.possible * (now.tets / other.tets) * (other.edge / now.edge) * (now.wave / other.wave);

// Of the liver in data/, pulled aside, with edge-smoothed tetrahedra against quadratic ones; under its weight
// the error is smaller (benchmarks/results/elements.csv).
const known = {tets: 10299, error: 0.0117},
  order = Math.log(0.0163 / 0.0117) / Math.log(10299 / 2103);

/** Of the displacement of a compact organ, in the mean over it. */
export const error = tets => known.error * (known.tets / tets) ** order;
