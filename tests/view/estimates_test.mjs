// What the page expects of a mesh that is not made yet.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {error, speed, speedOfOther, tetrahedra, tetrahedraOfBody} from '../../view/page/estimates.js';

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
  const now = {possible: 6, tets: 1000, edge: 0.01, wave: 2};
  assert.equal(speedOfOther(now, {tets: 1000, edge: 0.01, wave: 2}), 6);
  assert.equal(speedOfOther(now, {tets: 2000, edge: 0.01, wave: 2}), 3);
  assert.equal(speedOfOther(now, {tets: 1000, edge: 0.005, wave: 4}), 1.5);
  // The same body with other edges.
  const finer = {tets: 8000, edge: 0.005, wave: 2};
  assert.ok(Math.abs(speedOfOther(now, finer) - speed(now, 8000)) < 1e-12);
});

test('a thin body has a tetrahedron for each face of its surface', () => {
  const plate = {volume: 0.1 * 0.1 * 1e-4, area: 0.02}; // of a tenth of a millimetre
  assert.ok(Math.abs(tetrahedraOfBody(plate, 0.01) - 0.02 / (Math.sqrt(3) / 4 / 1e4)) < 1e-6);
  const cube = {volume: 1e-3, area: 0.06};
  assert.equal(tetrahedraOfBody(cube, 0.01), tetrahedra(1e-3, 0.01));
});

test('errors are those that were measured, and fall as the mesh gets finer', () => {
  assert.ok(Math.abs(error(10299) - 0.0117) < 1e-9);
  assert.ok(Math.abs(error(2103) - 0.0163) < 1e-9);
  assert.ok(error(80000) < 0.009 && error(80000) > 0.006);
});
