// How the page reads frames.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {readFrame} from '../../view/page/protocol.js';

// Blocks of [tag, bytes], each filled up to a multiple of four.
function frame(...blocks) {
  const parts = blocks.map(([tag, bytes]) => {
    const block = Buffer.alloc(8 + ((bytes.length + 3) & ~3));
    block.write(tag, 0, 'latin1');
    block.writeUInt32LE(bytes.length, 4);
    Buffer.from(bytes).copy(block, 8);
    return block;
  });
  const all = Buffer.concat(parts);
  return all.buffer.slice(all.byteOffset, all.byteOffset + all.length);
}
const bytesOf = array => Buffer.from(array.buffer);
const name = text => Buffer.concat([Buffer.from(text)], 16);

test('bodies of triangles, beside a block of a tag that nobody knows', () => {
  const read = readFrame(frame(['NEW!', [1, 2, 3]], ['BODS', [0, 1, 1]]));
  assert.deepEqual([...read.bodies], [0, 1, 1]);
});

test('lines of threads and attachments', () => {
  const lines = Buffer.concat([
    bytesOf(Uint32Array.of(2)),
    name('threads'),
    bytesOf(Uint32Array.of(1)),
    name('attachments'),
    bytesOf(Uint32Array.of(2)),
    bytesOf(Float32Array.from({length: 18}, (_, i) => i)),
    bytesOf(Float32Array.of(10, 20, 30)),
    bytesOf(Float32Array.of(0, 0.25, 0.5)),
  ]);
  const [thread, attachment] = readFrame(frame(['LINE', lines])).lines;
  assert.equal(thread.term, 'threads');
  assert.deepEqual([...thread.ends], [0, 1, 2, 3, 4, 5]);
  assert.deepEqual([...thread.tensions], [10]);
  assert.deepEqual([...thread.damages], [0]);
  assert.equal(attachment.term, 'attachments');
  assert.deepEqual([...attachment.ends].slice(-1), [17]);
  assert.deepEqual([...attachment.tensions], [20, 30]);
  assert.deepEqual([...attachment.damages], [0.25, 0.5]);
});

test('a block that is longer than its frame is named', () => {
  const whole = frame(['BODS', [0, 1, 1, 0]]);
  assert.throws(() => readFrame(whole.slice(0, -1)), /BODS is longer/);
});
