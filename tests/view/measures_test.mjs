// What the page measures on a surface.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {cutLength, volumeOf} from '../../view/page/measures.js';

// Boxes from corner to corner, each with vertices of its own, turned out.
function boxes(...list) {
  const rest = [],
    triangles = [];
  for (const [low, high, inside] of list) {
    const first = rest.length / 3;
    for (let i = 0; i < 8; ++i) for (let k = 0; k < 3; ++k) rest.push((i >> k) & 1 ? high[k] : low[k]);
    for (const [a, b, c, d] of [
      [0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5],
    ])
      for (const [u, v, w] of [[a, b, c], [a, c, d]])
        triangles.push(...(inside ? [u, w, v] : [u, v, w]).map(corner => corner + first));
  }
  return {
    rest: Float32Array.from(rest),
    triangles: Uint32Array.from(triangles),
    cut: new Uint8Array(triangles.length / 3),
  };
}

test('the volume of a box, of two, and of one with a cavity', () => {
  const box = [[1, 1, 1], [3, 2, 1.5]];
  assert.equal(volumeOf(boxes(box)), 1);
  assert.equal(volumeOf(boxes(box, [[5, 5, 5], [6, 6, 7]])), 3);
  assert.equal(volumeOf(boxes([[0, 0, 0], [4, 4, 4]], [[1, 1, 1], [3, 3, 3], true])), 56);
});

test('nothing is cut: there is no length', () => {
  assert.equal(cutLength(boxes([[0, 0, 0], [1, 1, 1]])), 0);
});

test('two boxes that a cut has parted: once around it, though it has two lips', () => {
  const surface = boxes([[0, 0, 0], [1, 1, 2]], [[1, 0, 0], [2, 1, 2]]);
  const at = (t, x) => [0, 1, 2].every(k => surface.rest[3 * surface.triangles[3 * t + k]] === x);
  for (let t = 0; t < surface.cut.length; ++t) surface.cut[t] = at(t, 1) ? 1 : 0;
  assert.equal(surface.cut.reduce((sum, c) => sum + c), 4);
  assert.equal(cutLength(surface), 6);
});

// Skin above and below at z = 2 and 0, and slits along y through it: of each where it is [x], and how long.
function slitPlate(...slits) {
  const rest = [],
    triangles = [],
    cut = [];
  const at = (...place) => rest.push(...place) / 3 - 1;
  for (const [x, above, below] of slits) {
    const [a, b, c, d] = [at(x, 0, 2), at(x, above, 2), at(x, 0, 0), at(x, below, 0)];
    const skin = [
      [a, b, at(x - 1, 0, 2)], [b, a, at(x + 1, 0, 2)],
      [d, c, at(x - 1, 0, 0)], [c, d, at(x + 1, 0, 0)],
    ];
    const lips = [[a, c, b], [c, d, b], [a, b, c], [c, b, d]];
    triangles.push(...skin.flat(), ...lips.flat());
    cut.push(...skin.map(() => 0), ...lips.map(() => 1));
  }
  return {rest: Float32Array.from(rest), triangles: Uint32Array.from(triangles), cut: Uint8Array.from(cut)};
}

test('a slit that comes out on the far side has the length of its longer side', () => {
  assert.equal(cutLength(slitPlate([0, 4, 3])), 4);
  assert.equal(cutLength(slitPlate([0, 4, 4])), 4);
  assert.equal(cutLength(slitPlate([0, 4, 3], [5, 2, 2.5])), 4 + 2.5);
});

// Positions at rest are those of now without displacements, in single precision: the lips that have come
// apart are then some nanometres from each other. Here by up to 1.5e-8 each, across borders of the grid, too.
test('lips that are not quite at the same place at rest are counted once', () => {
  for (const shift of [0, 1e-4, 4e-4, 0.1234567]) {
    const plate = slitPlate([0, 0.4, 0.3]);
    plate.rest = plate.rest.map((x, i) => 0.1 * x + shift + 0.15e-7 * Math.sin(7 * i));
    const lip = plate.rest.map((x, i) => x + 0.3e-7 * Math.sin(5 * i)),
      own = plate.rest.length / 3;
    // The second half of skin and lips has vertices of its own.
    plate.triangles = plate.triangles.map((v, i) => (Math.floor(i / 3) % 2 ? v + own : v));
    plate.rest = Float32Array.of(...plate.rest, ...lip);
    assert.ok(Math.abs(cutLength(plate) - 0.04) < 1e-6, `${cutLength(plate)} ≠ 0.04, moved by ${shift}`);
  }
});

// A wedge that points down; its edge is the line x = 0, z = 0. A cut at y = 0 has opened all of its front,
// and its back up to `behind`. Both sides of a wedge so sharp face down.
function cutWedge(behind) {
  const rest = [0, 0, 0, 1, 0, 3, -behind / 3, 0, behind, -1, 0, 3, 0, 1, 0, 0, -1, 0],
    lips = [[0, 1, 2], [2, 1, 0]],
    skin = [[0, 1, 4], [1, 0, 5], [2, 0, 4], [0, 2, 5], [3, 2, 4], [2, 3, 5]];
  return {
    rest: Float32Array.from(rest),
    triangles: Uint32Array.from([...skin, ...lips].flat()),
    cut: Uint8Array.from([...skin.map(() => 0), ...lips.map(() => 1)]),
  };
}

test('a cut through an edge of the organ has the length of its longer side, which the blade tells', () => {
  const from = x => [{at: [x, 0, 2], along: [-x, 0, 0]}],
    front = Math.hypot(1, 3),
    behind = Math.hypot(0.5, 1.5),
    near = (a, b) => assert.ok(Math.abs(a - b) < 1e-6, `${a} ≠ ${b}`);
  near(cutLength(cutWedge(1.5)), front + behind); // nothing is known of a blade
  near(cutLength(cutWedge(1.5), from(1)), front);
  near(cutLength(cutWedge(1.5), from(-1)), front);
  const box = boxes([[0, 0, 0], [1, 1, 2]], [[1, 0, 0], [2, 1, 2]]),
    at = (t, x) => [0, 1, 2].every(k => box.rest[3 * box.triangles[3 * t + k]] === x);
  box.cut.forEach((_, t) => (box.cut[t] = at(t, 1) ? 1 : 0));
  assert.equal(cutLength(box, [{at: [1, 0, 1], along: [0, 1, 0]}]), 2);
  assert.equal(cutLength(box, [{at: [1, 0.5, 2], along: [0, 0, -3]}]), 1);
});

test('what a cautery has opened is measured without a blade', () => {
  const wedge = cutWedge(1.5);
  wedge.cut = wedge.cut.map(kind => 2 * kind);
  assert.ok(cutLength(wedge, [{at: [1, 0, 2], along: [-1, 0, 0]}]) > 4);
});

test('two slits that meet below the skin count both', () => {
  const plate = slitPlate([0, 4, 3], [5, 2, 1]),
    [c, below] = [2, plate.rest.length / 3 / 2 + 2]; // the lower end of each, at y = 0
  plate.triangles = Uint32Array.of(...plate.triangles, c, below, 3);
  plate.cut = Uint8Array.of(...plate.cut, 1);
  assert.equal(cutLength(plate), 4 + 2);
});
