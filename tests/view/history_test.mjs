// Undo in the page, without a page.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {History} from '../../view/page/history.js';

globalThis.document = {createElement: () => ({style: {}, remove() {}})};
const went = (times, from, to) => ({number: times, times, text: `from ${from} s to ${to} s`});

// A cut that was asked for at 6 s, by request 5, and that the page has heard of at 6.05 s.
function withCut() {
  const asked = [],
    history = new History({append() {}, clientWidth: 100}, seconds => asked.push(seconds));
  history.take(6, 4);
  history.begin('scalpel', 5);
  history.take(6.05, 5);
  history.take(8, 5);
  return {asked, history};
}

test('undo asks for the moment by which the act had begun', () => {
  const {asked, history} = withCut();
  assert.ok(history.undo());
  assert.ok(Math.abs(asked[0] - 1.95) < 1e-9);
});

test('what is undone is forgotten, though the simulation has gone on since', () => {
  const {asked, history} = withCut();
  history.undo();
  history.take(6.4, 5, went(1, 8, 6.02));
  assert.deepEqual([asked.length, history.acts.length, history.wanted], [1, 0, null]);
});

test('so it is where the first time that is heard is later than the last one', () => {
  const {asked, history} = withCut();
  history.undo();
  history.take(8.3, 5, went(1, 8, 6.02));
  assert.deepEqual([asked.length, history.acts.length, history.wanted], [1, 0, null]);
});

test('where it did not go back far enough, it is asked again', () => {
  const {asked, history} = withCut();
  history.undo();
  history.take(6.6, 5, went(1, 8, 6.52));
  assert.ok(Math.abs(asked[1] - 0.65) < 1e-9);
  history.take(6.1, 5, went(2, 6.7, 6.02));
  assert.deepEqual([asked.length, history.acts.length, history.wanted], [2, 0, null]);
});

// Other states may have been kept since the act.
test('where nothing was heard for long an act is undone from before that', () => {
  const asked = [],
    history = new History({append() {}, clientWidth: 100}, seconds => asked.push(seconds));
  history.take(6, 4);
  history.begin('stitch', 5);
  history.take(6.7, 5);
  history.undo();
  assert.ok(Math.abs(asked[0] - 0.7) < 1e-9);
});

test('an act that was not heard of yet is undone from before it was asked for', () => {
  const asked = [],
    history = new History({append() {}, clientWidth: 100}, seconds => asked.push(seconds));
  history.take(6, 4);
  history.begin('grasp', 5);
  history.undo();
  assert.ok(Math.abs(asked[0] - 0.1) < 1e-9);
});
