// Where a surface is sharp.
import {firstAtPlaces} from './places.js';

const creaseCosine = Math.cos((50 * Math.PI) / 180),
  foldedCosine = Math.cos((150 * Math.PI) / 180);

// Corners of triangles that meet across smooth edges share a vertex, others do not. Skin is sharp where it is
// bent, an opened face only at its rim and where it folds back: both sides of a cut that has not come apart
// are at the same place, and smooth each for itself. Where other than two sharp edges meet, a corner stays
// where it is, on all sides of them.
export function splitAtCreases({triangles, rest, cut}) {
  const normal = faceNormals(triangles, rest),
    place = firstAtPlaces(rest), // of the skin and of an opened face there are two
    count = rest.length / 3;
  const parent = new Int32Array(triangles.length).map((_, i) => i);
  const root = i => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const edges = new Map();
  for (let i = 0; i < triangles.length; ++i) {
    const next = i % 3 === 2 ? i - 2 : i + 1,
      a = place[triangles[i]],
      b = place[triangles[next]];
    const key = Math.min(a, b) * count + Math.max(a, b);
    if (!edges.has(key)) edges.set(key, []);
    edges.get(key).push([i, next]);
  }
  const sharp = new Uint16Array(count);
  for (const sides of edges.values()) {
    let isSharp = false;
    for (const pair of withSameVertices(sides, triangles, count)) {
      if (pair.length === 2 && isSmooth(pair, normal, cut)) {
        const [[i, iNext], [j, jNext]] = pair,
          turned = triangles[i] === triangles[jNext];
        parent[root(i)] = root(turned ? jNext : j);
        parent[root(iNext)] = root(turned ? j : jNext);
      } else {
        isSharp = true;
      }
    }
    if (isSharp) for (const end of sides[0]) ++sharp[place[triangles[end]]];
  }
  const numbers = new Map(),
    source = [],
    result = new Uint32Array(triangles.length);
  for (let i = 0; i < triangles.length; ++i) {
    const r = root(i);
    if (!numbers.has(r)) {
      numbers.set(r, source.length);
      source.push(triangles[i]);
    }
    result[i] = numbers.get(r);
  }
  const corners = source.map(v => sharp[place[v]] !== 0 && sharp[place[v]] !== 2);
  return {triangles: result, source: Uint32Array.from(source), corners};
}

function withSameVertices(sides, triangles, count) {
  const groups = new Map();
  for (const side of sides) {
    const [a, b] = side.map(corner => triangles[corner]),
      key = Math.min(a, b) * count + Math.max(a, b);
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push(side);
  }
  return groups.values();
}

function isSmooth([[i], [j]], normal, cut) {
  const f = Math.floor(i / 3),
    g = Math.floor(j / 3);
  const cosine =
    normal[3 * f] * normal[3 * g] +
    normal[3 * f + 1] * normal[3 * g + 1] +
    normal[3 * f + 2] * normal[3 * g + 2];
  return cut[f] ? cut[g] === cut[f] && cosine > foldedCosine : cosine >= creaseCosine;
}

function faceNormals(triangles, x) {
  const result = new Float32Array(triangles.length);
  for (let i = 0; i < triangles.length; i += 3) {
    const [nx, ny, nz] = twiceArea(x, triangles[i], triangles[i + 1], triangles[i + 2]);
    const length = Math.hypot(nx, ny, nz) || 1;
    result.set([nx / length, ny / length, nz / length], i);
  }
  return result;
}

function twiceArea(x, a, b, c) {
  a *= 3;
  b *= 3;
  c *= 3;
  const ux = x[b] - x[a],
    uy = x[b + 1] - x[a + 1],
    uz = x[b + 2] - x[a + 2];
  const vx = x[c] - x[a],
    vy = x[c + 1] - x[a + 1],
    vz = x[c + 2] - x[a + 2];
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}
