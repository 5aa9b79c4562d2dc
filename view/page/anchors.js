// Places on the drawn surface of the organ that move with it, and stay where they were in the tissue when the
// surface is another one, after a cut.
import * as THREE from './third_party/three-0.187.0/three.module.js';

const at = (array, v, into = new THREE.Vector3()) => into.fromArray(array, 3 * v);
const restOf = organ => organ.mesh.geometry.attributes.rest.array;

function anchor(organ, array, corners, point) {
  const weights = new THREE.Vector3();
  THREE.Triangle.getBarycoord(point, ...corners.map(v => at(array, v)), weights);
  return {smooth: organ.smooth, corners, weights: weights.toArray()};
}

const mean = (array, {corners, weights}) =>
  corners.reduce((sum, v, i) => sum.addScaledVector(at(array, v), weights[i]), new THREE.Vector3());

/** Where a ray has hit the organ. */
export function anchorOf(organ, {point, face}) {
  const found = anchor(organ, organ.position.array, [face.a, face.b, face.c], point);
  return {...found, rest: mean(restOf(organ), found)};
}

/** Where that is now. */
export function pointOf(organ, place) {
  if (place.smooth !== organ.smooth) Object.assign(place, nearest(organ, place.rest));
  return mean(organ.position.array, place);
}

// The place of the surface that is nearest to a point, both at rest.
function nearest(organ, point) {
  const rest = restOf(organ),
    {triangles} = organ.smooth,
    triangle = new THREE.Triangle(),
    close = new THREE.Vector3(),
    best = {distance: Infinity, corners: [0, 0, 0], point: point.clone()};
  for (let i = 0; i < triangles.length; i += 3) {
    const corners = [triangles[i], triangles[i + 1], triangles[i + 2]];
    [triangle.a, triangle.b, triangle.c].forEach((corner, k) => at(rest, corners[k], corner));
    triangle.closestPointToPoint(point, close);
    const distance = close.distanceToSquared(point);
    if (distance < best.distance) Object.assign(best, {distance, corners, point: close.clone()});
  }
  return anchor(organ, rest, best.corners, best.point);
}
