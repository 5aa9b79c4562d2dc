// What the page finds out about a surface before it is sent.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {sizeOfBody, sizeOfSurface} from '../../view/page/surface_size.js';

// A box of 2 × 3 × 4, far from 0; `turned`: its faces look inside.
const corner = k => [100 + 2 * (k & 1), -50 + 3 * ((k >> 1) & 1), 7 + 4 * (k >> 2)];
const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
const triangles = turned =>
  quads
    .flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]])
    .map(([a, b, c]) => (turned ? [a, c, b] : [a, b, c]).map(corner));
const bytes = text => new TextEncoder().encode(text).buffer;

function binaryStl(list) {
  const data = new DataView(new ArrayBuffer(84 + 50 * list.length));
  data.setUint32(80, list.length, true);
  list.forEach((t, n) => t.flat().forEach((x, i) => data.setFloat32(84 + 50 * n + 12 + 4 * i, x, true)));
  return data.buffer;
}
const textStl = list =>
  bytes(`solid box\n${list.map(t => `facet normal 0 0 0\nouter loop\n${t.map(p => `vertex ${p.join(' ')}\n`).join('')}
endloop\nendfacet\n`).join('')}endsolid\n`);
const points = [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
const obj = first =>
  bytes(`# box\n${points.map(p => `v ${p.join(' ')}\n`).join('')}${quads
    .map(q => `f ${q.map(v => `${first === 1 ? v + 1 : v - 8}//1`).join(' ')}\n`)
    .join('')}`);
const off = bytes(`OFF # box\n8 6 0\n${points.map(p => p.join(' ')).join('\n')}\n${quads
  .map(q => `4 ${q.join(' ')}`)
  .join('\n')}\n`);

function checkBox(size) {
  assert.deepEqual(size.size, [2, 3, 4]);
  assert.ok(Math.abs(size.diagonal - Math.sqrt(29)) < 1e-12);
  assert.ok(Math.abs(size.area - 52) < 1e-9);
  assert.ok(Math.abs(size.volume - 24) < 1e-9);
}

test('a box in each format that is read, and one whose faces look inside', () => {
  checkBox(sizeOfSurface('a.STL', binaryStl(triangles(false))));
  checkBox(sizeOfSurface('a.stl', binaryStl(triangles(true))));
  checkBox(sizeOfSurface('a.stl', textStl(triangles(false))));
  checkBox(sizeOfSurface('a.obj', obj(1)));
  checkBox(sizeOfSurface('a.obj', obj(-1)));
  checkBox(sizeOfSurface('a.off', off));
});

test('other files and garbled ones have no size', () => {
  assert.equal(sizeOfSurface('a.nrrd', bytes('NRRD0004')), undefined);
  assert.equal(sizeOfSurface('a.stl', bytes('no surface at all')), undefined);
  assert.equal(sizeOfSurface('a.stl', bytes('')), undefined);
  assert.equal(sizeOfSurface('a.obj', bytes('v 0 0 0\nv 1 0 0\nf 1 2 9\n')), undefined);
  assert.equal(sizeOfSurface('a.obj', bytes('v 0 0 zero\nv 1 0 0\nv 0 1 0\nf 1 2 3\n')), undefined);
  assert.equal(sizeOfSurface('a.off', bytes('OFF\n99999999999 1 0\n0 0 0\n')), undefined);
});

test('of several surfaces the largest is the body; where one is unknown, the body is', async () => {
  const file = (name, buffer) => new File([buffer], name);
  const large = file('organ.stl', binaryStl(triangles(false))),
    small = file('tumour.stl', binaryStl(triangles(false).map(t => t.map(p => p.map(x => x / 2)))));
  checkBox(await sizeOfBody([small, large]));
  assert.equal(await sizeOfBody([large, file('scene.json', bytes('{}'))]), undefined);
});
