// The forces on instruments, as the page shows them.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {colours, Forces, nearness} from '../../view/page/forces.js';

const tool = (number, force) => ({tool: number, force});

test('each instrument keeps its colour while others come and go', () => {
  const forces = new Forces(),
    first = [tool(7, [3, 0, 4]), tool(9, [0, 2, 0])];
  forces.take(first);
  assert.deepEqual(forces.values, [5, 2, null, null]);
  assert.deepEqual(first.map(({colour}) => colour), colours.slice(0, 2));
  const second = [tool(9, [0, 3, 0])];
  forces.take(second);
  assert.deepEqual(forces.values, [null, 3, null, null]);
  assert.equal(second[0].colour, colours[1]);
  const third = [tool(9, [0, 3, 0]), tool(12, [1, 0, 0])];
  forces.take(third);
  assert.deepEqual(forces.values, [1, 3, null, null]);
});

test('a fifth instrument has a colour, but no line', () => {
  const forces = new Forces(),
    tools = [1, 2, 3, 4, 5].map(number => tool(number, [number, 0, 0]));
  forces.take(tools);
  assert.deepEqual(forces.values, [1, 2, 3, 4]);
  assert.equal(tools[4].colour, colours[0]);
});

test('a force that is too small to be read is no figure', () => {
  const forces = new Forces();
  forces.take([tool(1, [0.004, 0, 0]), tool(2, [0.5, 0, 0])]);
  assert.deepEqual(forces.figures(), [{newtons: 0.5, colour: colours[1]}]);
});

test('a grasp is near to slipping from 60 % of what it bears', () => {
  assert.equal(nearness(12, 20), 0);
  assert.ok(Math.abs(nearness(16, 20) - 0.5) < 1e-12);
  assert.equal(nearness(25, 20), 1);
  assert.equal(nearness(100, undefined), 0);
});
