// Which opened faces are charred.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Wounds} from '../../view/page/wounds.js';

// Triangles of corners (i, 0, 0), (i, 1, 0), (i, 0, 1), which are opened or not.
function surface(...cut) {
  const rest = cut.flatMap((_, i) => [i, 0, 0, i, 1, 0, i, 0, 1]);
  return {
    rest: Float32Array.from(rest),
    triangles: Uint32Array.from({length: 3 * cut.length}, (_, i) => i),
    cut: Uint8Array.from(cut),
  };
}
const cautery = x => ({tool: 1, type: 'cautery', on: true, position: [x, 0, 0]});
const quarterAboutY = [0, 0.5 ** 0.5, 0, 0.5 ** 0.5];
const blade = x => ({
  tool: 2,
  type: 'scalpel',
  on: true,
  position: [x, 0, 5],
  blade: [5, 0, 0],
  orientation: quarterAboutY,
});

test('what was open before anybody cut is not charred', () => {
  const body = surface(0, 1, 1);
  assert.deepEqual([...new Wounds().kinds(body, body.rest)], [0, 1, 1]);
});

test('the nearest instrument has opened a face, and that stays so', () => {
  const wounds = new Wounds(),
    body = surface(0, 1, 1);
  // The blade is turned: from (2, 0, 5) down to (2, 0, 0).
  wounds.see([cautery(1), blade(2), {tool: 3, type: 'grasp', on: true, position: [0, 0, 0]}], 0);
  assert.deepEqual([...wounds.kinds(body, body.rest)], [0, 2, 1]);
  wounds.see([], 500);
  assert.deepEqual([...wounds.kinds(surface(1, 1, 1), body.rest)], [2, 2, 1]); // the cautery was nearest
  wounds.see([blade(1)], 600);
  assert.deepEqual([...wounds.kinds(body, body.rest)], [0, 2, 1]);
  wounds.forget();
  assert.deepEqual([...wounds.kinds(body, body.rest)], [0, 1, 1]);
});

test('a blade that has just left is remembered beside a cautery that stays', () => {
  const wounds = new Wounds(),
    body = surface(1);
  wounds.see([cautery(3), blade(0)], 0);
  wounds.see([cautery(3)], 900);
  assert.deepEqual([...wounds.kinds(body, body.rest)], [1]);
  wounds.forget();
  wounds.see([cautery(3), blade(0)], 0);
  wounds.see([cautery(3)], 1100);
  assert.deepEqual([...wounds.kinds(body, body.rest)], [2]);
});

test('what is whole again after going back may be opened otherwise', () => {
  const wounds = new Wounds(),
    body = surface(1, 1);
  wounds.see([cautery(0)], 0);
  assert.deepEqual([...wounds.kinds(body, body.rest)], [2, 2]);
  wounds.kinds(surface(0, 1), body.rest); // as while one paints
  wounds.wentBack();
  wounds.kinds(surface(0, 1), body.rest);
  wounds.see([blade(0)], 2000);
  assert.deepEqual([...wounds.kinds(body, body.rest)], [1, 2]);
});

test('an instrument that is off opens nothing', () => {
  const wounds = new Wounds(),
    body = surface(1);
  wounds.see([{...cautery(0), on: false}, blade(7)]);
  assert.deepEqual([...wounds.kinds(body, body.rest)], [1]);
});
