// What the page expects of a mesh that is not made yet.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {error, speed, speedOf, tetrahedra, tetrahedraOfParts} from '../../view/page/estimates.js';

test('regular tetrahedra fill the volume', () => {
  const edge = 0.01,
    volume = edge ** 3 / (6 * Math.SQRT2); // of one
  assert.ok(Math.abs(tetrahedra(10 * volume, edge) - 10) < 1e-9);
});

test('half the edge has eight times the tetrahedra and takes sixteen times as long', () => {
  const now = {possible: 8, tets: 1000};
  assert.ok(Math.abs(tetrahedra(1, 0.05) / tetrahedra(1, 0.1) - 8) < 1e-9);
  assert.equal(speed(now, 1000), 8);
  assert.ok(Math.abs(speed(now, 8000) - 0.5) < 1e-9);
});

test('another body is as fast as its steps are long and its tetrahedra few', () => {
  // The liver in data/, of liver (5.22 kPa, 1060 kg/m³), whose limit is 0.9 × 1.57 ms by `lobe run`.
  const liver = {tets: 10299, volume: 1.1217e-3, edge: 0.00974, wave: Math.sqrt(5220 / 1060)},
    pace = 2e-8,
    step = speedOf(liver, pace) * pace * liver.tets;
  assert.ok(Math.abs(step / 1.4e-3 - 1) < 0.06, `${step} s`);
  assert.ok(Math.abs(speedOf(liver, 2 * pace) / speedOf(liver, pace) - 0.5) < 1e-12);
  assert.ok(Math.abs(speedOf({...liver, wave: 2 * liver.wave}, pace) / speedOf(liver, pace) - 0.5) < 1e-12);
  // The same body with other edges.
  const finer = {...liver, tets: 8 * liver.tets, edge: liver.edge / 2};
  assert.ok(Math.abs(speedOf(finer, pace) / speed({possible: speedOf(liver, pace), tets: 1}, 8) - 1) < 0.01);
  // A plate has more tetrahedra than its volume says, which are thinner than their edges.
  assert.ok(speedOf({...liver, tets: 8 * liver.tets}, pace) < 1.01 * speedOf(finer, pace));
});

test('a thin part has a tetrahedron for each face of its surface, and parts add up', () => {
  const plate = {volume: 0.1 * 0.1 * 1e-4, area: 0.02}, // of a tenth of a millimetre
    cube = {volume: 1e-3, area: 0.06},
    ofPlate = 0.02 / (Math.sqrt(3) / 4 / 1e4);
  assert.ok(Math.abs(tetrahedraOfParts([plate], 0.01) - ofPlate) < 1e-6);
  assert.equal(tetrahedraOfParts([cube], 0.01), tetrahedra(1e-3, 0.01));
  assert.ok(Math.abs(tetrahedraOfParts([plate, cube], 0.01) - ofPlate - tetrahedra(1e-3, 0.01)) < 1e-6);
});

test('errors are those that were measured, and fall as the mesh gets finer', () => {
  assert.ok(Math.abs(error(10299) - 0.0117) < 1e-9);
  assert.ok(Math.abs(error(2103) - 0.0163) < 1e-9);
  assert.ok(error(80000) < 0.009 && error(80000) > 0.006);
});
