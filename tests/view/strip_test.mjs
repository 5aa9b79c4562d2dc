// Where a clip of the page closes: on what is narrow, as the viewer sees it.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {stripAt} from '../../view/page/bring.js';
import * as THREE from '../../view/page/third_party/three-0.187.0/three.module.js';

const vector = (x, y, z) => new THREE.Vector3(x, y, z),
  stage = {right: () => vector(1, 0, 0), above: () => vector(0, 1, 0), forward: () => vector(0, 0, -1)};

// A tube along x that is turned by an angle about the line of sight, with its middle on the axis.
function tube(radius, length, angle) {
  const x = [],
    triangles = [],
    around = 24;
  for (const end of [-length / 2, length / 2])
    for (let k = 0; k < around; ++k) {
      const phi = (2 * Math.PI * k) / around,
        y = radius * Math.cos(phi);
      x.push(end * Math.cos(angle) - y * Math.sin(angle), end * Math.sin(angle) + y * Math.cos(angle));
      x.push(radius * Math.sin(phi));
    }
  for (let k = 0; k < around; ++k) {
    const next = (k + 1) % around;
    triangles.push(k, next, around + k, next, around + next, around + k);
  }
  return {triangles, x};
}

// What is 4 mm wide, clicked 1 mm beside its middle.
for (const most of [0.006, 0.02, 0.08])
  for (const angle of [0, 0.4, 1.2])
    test(`a clip that opens ${1e3 * most} mm finds the sides of a tube at ${angle} rad`, () => {
      const across = vector(-Math.sin(angle), Math.cos(angle), 0),
        clicked = across.clone().multiplyScalar(0.001).setZ(0.0017),
        strip = stripAt(stage, tube(0.002, 0.12, angle), clicked, most);
      assert.ok(strip.width > 0.0036 && strip.width < 0.0046, `${strip.width} m`);
      assert.ok(Math.abs(strip.middle.dot(across)) < 4e-4, `${strip.middle.dot(across)} m beside`);
    });

test('where it is wider than a clip opens there is none', () => {
  assert.equal(stripAt(stage, tube(0.02, 0.12, 0), vector(0, 0, 0.02), 0.03), null);
});
