// What a mesh of other edges would be like, from the one that is there.

/** Of regular tetrahedra with this edge [m] that fill a volume [m³]. */
export const tetrahedra = (volume, edge) => (6 * Math.SQRT2 * volume) / edge ** 3;

/** How fast it could go: each step costs what its tetrahedra do, and is as long as the smallest lets it.
 *  @param {{possible: number, tets: number}} now of the mesh that is there */
export const speed = ({possible, tets}, wanted) => possible * (tets / wanted) ** (4 / 3);

/** Of parts with these volumes [m³] and areas [m²]. Where one is thin, each face has about one.
 *  @param {{volume: number, area: number}[]} parts */
export const tetrahedraOfParts = (parts, edge) =>
  parts.reduce(
    (sum, {volume, area}) =>
      sum + Math.max(tetrahedra(volume, edge), area / ((Math.sqrt(3) / 4) * edge ** 2)),
    0,
  );

// How much of a regular tetrahedron's edge a wave of speed √(E/ρ) passes in a step: 0.30 to 0.32 in livers of
// data/, 0.33 to 0.36 in kidneys, by `lobe run` of what `lobe scene` makes of them.
const edgePerStep = 0.32;

/** How fast a body could go that is not there yet. Where it is thin, tetrahedra are smaller than their edges.
 *  @param {{tets: number, volume: number, edge: number, wave: number}} body with √(E/ρ) of its tissue [m/s]
 *  @param {number} pace time that a tetrahedron takes for a step on the machine of the simulation [s] */
export const speedOf = ({tets, volume, edge, wave}, pace) => {
  const mean = Math.cbrt((6 * Math.SQRT2 * volume) / tets);
  return (edgePerStep * Math.min(edge, mean)) / wave / (pace * tets);
};

// Of the liver in data/, pulled aside, with edge-smoothed tetrahedra against quadratic ones; under its weight
// the error is smaller (benchmarks/results/elements.csv).
const known = {tets: 10299, error: 0.0117},
  order = Math.log(0.0163 / 0.0117) / Math.log(10299 / 2103);

/** Of the displacement of a compact organ, in the mean over it. */
export const error = tets => known.error * (known.tets / tets) ** order;
