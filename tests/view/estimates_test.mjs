// What the page expects of a mesh that is not made yet.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {error, speed, tetrahedra} from '../../view/page/estimates.js';

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

test('errors are those that were measured, and fall as the mesh gets finer', () => {
  assert.ok(Math.abs(error(10299) - 0.0117) < 1e-9);
  assert.ok(Math.abs(error(2103) - 0.0163) < 1e-9);
  assert.ok(error(80000) < 0.009 && error(80000) > 0.006);
});
