// How large the body of a surface file is, before it is sent: for what is expected of its mesh.

const most = 64 * 2 ** 20; // [bytes] that are looked at

/** Box, area and enclosed volume of triangles, in the units of the file; the volume is positive whichever
 *  way they face. @param {Iterable<number[]>} triangles nine coordinates each; undefined if there are none */
function measured(triangles) {
  const low = [Infinity, Infinity, Infinity],
    high = [-Infinity, -Infinity, -Infinity];
  let volume = 0,
    area = 0,
    origin;
  for (const t of triangles) {
    if (!t.every(Number.isFinite)) return undefined;
    origin ??= t.slice(0, 3); // so that bodies far from 0 keep their digits
    for (let i = 0; i < 9; ++i) {
      low[i % 3] = Math.min(low[i % 3], t[i]);
      high[i % 3] = Math.max(high[i % 3], t[i]);
    }
    const [ax, ay, az, bx, by, bz, cx, cy, cz] = t.map((x, i) => x - origin[i % 3]);
    volume += (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6;
    const [ux, uy, uz, vx, vy, vz] = [bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az];
    area += Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
  }
  if (!origin) return undefined;
  const size = high.map((x, i) => x - low[i]);
  return {size, diagonal: Math.hypot(...size), area, volume: Math.abs(volume)};
}

function* ofBinaryStl(/** @type {DataView} */ data) {
  for (let at = 84; at + 50 <= data.byteLength; at += 50)
    yield Array.from({length: 9}, (_, i) => data.getFloat32(at + 12 + 4 * i, true));
}

function* ofTextStl(/** @type {string} */ text) {
  let corners = [];
  for (const [, x, y, z] of text.matchAll(/vertex\s+(\S+)\s+(\S+)\s+(\S+)/gi)) {
    corners.push(Number(x), Number(y), Number(z));
    if (corners.length < 9) continue;
    yield corners;
    corners = [];
  }
}

/** A fan of each polygon, whose corners count from 0. */
function* ofPolygons(points, polygons) {
  for (const polygon of polygons)
    for (let i = 1; i + 1 < polygon.length; ++i)
      yield [polygon[0], polygon[i], polygon[i + 1]].flatMap(v => points[v] ?? [NaN, NaN, NaN]);
}

function ofObj(/** @type {string} */ text) {
  const points = [],
    polygons = [];
  for (const line of text.replace(/\\\r?\n/g, ' ').split('\n')) {
    const [kind, ...words] = line.trim().split(/\s+/);
    if (kind === 'v') points.push(words.slice(0, 3).map(Number));
    const numbers = () => words.map(word => Number.parseInt(word, 10)); // from 1; below 0 from the end
    if (kind === 'f') polygons.push(numbers().map(v => (v < 0 ? points.length + v : v - 1)));
  }
  return ofPolygons(points, polygons);
}

function ofOff(/** @type {string} */ text) {
  const words = text.replace(/#.*/g, '').trim().split(/\s+/),
    [count, faces] = words.slice(1, 3).map(Number),
    points = [],
    polygons = [];
  let at = 4;
  for (let i = 0; i < count && at < words.length; ++i, at += 3)
    points.push(words.slice(at, at + 3).map(Number));
  for (let i = 0; i < faces && at < words.length; ++i) {
    const corners = Number(words[at]);
    polygons.push(words.slice(at + 1, at + 1 + corners).map(Number));
    at += 1 + corners;
  }
  return ofPolygons(points, polygons);
}

/** Of a surface that is read here (STL, OBJ, OFF); undefined for all other files, and for garbled ones.
 *  @param {string} name @param {ArrayBuffer} bytes */
export function sizeOfSurface(name, bytes) {
  const text = () => new TextDecoder().decode(bytes),
    ending = name.toLowerCase().split('.').pop();
  if (ending === 'obj') return measured(ofObj(text()));
  if (ending === 'off') return measured(ofOff(text()));
  if (ending !== 'stl' || bytes.byteLength < 15) return undefined;
  const data = new DataView(bytes),
    isBinary = bytes.byteLength >= 84 && bytes.byteLength === 84 + 50 * data.getUint32(80, true);
  return measured(isBinary ? ofBinaryStl(data) : ofTextStl(text()));
}

/** @param {File[]} files that become one body; undefined if one of them is not read here */
export async function sizeOfBody(files) {
  let largest; // the others lie within it, or beside it
  for (const file of files) {
    const size = file.size > most ? undefined : sizeOfSurface(file.name, await file.arrayBuffer());
    if (!(size?.volume > 0)) return undefined;
    if (!(largest?.volume > size.volume)) largest = size;
  }
  return largest;
}
