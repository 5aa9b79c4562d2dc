// A finer, smoother surface than that of the tetrahedra: Loop's subdivision, whose weights are found once per
// topology. Rims of cuts and sharp edges stay sharp: there both sides have vertices of their own, which
// follow the same curve.

import {splitAtCreases} from './creases.js';

export class SmoothSurface {
  /** @param {{triangles: Uint32Array, rest: Float32Array, region: Uint8Array, cut: Uint8Array,
   *   faded?: Uint8Array}} topology
   *  @param {number} levels how often each triangle becomes four */
  constructor(topology, levels) {
    const start = splitAtCreases(topology);
    this.source = start.source; // per vertex of the start: the server's
    this.levels = [];
    let triangles = start.triangles,
      vertices = start.source.length;
    const groups = skinFirst(topology),
      order = groups.flat();
    triangles = inOrder(triangles, order);
    for (let i = 0; i < levels; ++i) {
      const finer = subdivide(triangles, vertices, start.corners);
      this.levels.push(finer.weights);
      triangles = finer.triangles;
      vertices = finer.vertices;
    }
    this.triangles = triangles;
    this.vertexCount = vertices;
    this.parts = 4 ** levels;
    this.order = order; // per control triangle: the server's
    // Of skin, of what was cut, and of what was charred; after each of them faded.
    this.counts = groups.map(group => group.length);
    this.skinCount = this.counts[0] + this.counts[1];
    this.scratch = [new Float32Array(3 * start.source.length)];
    for (const weights of this.levels) this.scratch.push(new Float32Array(3 * weights.rows));
    this.normals = new Float32Array(3 * vertices);
  }

  /** From values per vertex of the server, `size` numbers each, to values of this surface's vertices. */
  interpolate(values, size, scratch = null) {
    let level = scratch ? scratch[0] : new Float32Array(size * this.source.length);
    for (let v = 0; v < this.source.length; ++v)
      for (let k = 0; k < size; ++k) level[size * v + k] = values[size * this.source[v] + k];
    this.levels.forEach((weights, i) => {
      const next = scratch ? scratch[i + 1] : new Float32Array(size * weights.rows);
      apply(weights, level, next, size);
      level = next;
    });
    return level;
  }

  positions(x) {
    const result = this.interpolate(x, 3, this.scratch);
    findNormals(this.triangles, result, this.normals);
    return result;
  }

  /** From colours per triangle of the server to colours per vertex: means around each. */
  spread(colourOf) {
    const sum = new Float32Array(3 * this.vertexCount),
      count = new Float32Array(this.vertexCount);
    for (let t = 0; t < this.order.length; ++t) {
      const colour = colourOf(this.order[t]);
      for (let i = 3 * t * this.parts; i < 3 * (t + 1) * this.parts; ++i) {
        const v = this.triangles[i];
        for (let k = 0; k < 3; ++k) sum[3 * v + k] += colour[k];
        count[v] += 1;
      }
    }
    for (let v = 0; v < count.length; ++v) for (let k = 0; k < 3; ++k) sum[3 * v + k] /= count[v] || 1;
    return sum;
  }
}

function skinFirst({cut, faded}) {
  const groups = [[], [], [], [], [], []];
  for (let t = 0; t < cut.length; ++t) groups[2 * cut[t] + (faded?.[t] ?? 0)].push(t);
  return groups;
}

function inOrder(triangles, order) {
  const result = new Uint32Array(triangles.length);
  order.forEach((t, i) => result.set(triangles.subarray(3 * t, 3 * t + 3), 3 * i));
  return result;
}

function findNormals(triangles, x, normals) {
  normals.fill(0);
  for (let i = 0; i < triangles.length; i += 3) {
    const a = 3 * triangles[i],
      b = 3 * triangles[i + 1],
      c = 3 * triangles[i + 2];
    const ux = x[b] - x[a],
      uy = x[b + 1] - x[a + 1],
      uz = x[b + 2] - x[a + 2];
    const vx = x[c] - x[a],
      vy = x[c + 1] - x[a + 1],
      vz = x[c + 2] - x[a + 2];
    const nx = uy * vz - uz * vy,
      ny = uz * vx - ux * vz,
      nz = ux * vy - uy * vx;
    normals[a] += nx;
    normals[a + 1] += ny;
    normals[a + 2] += nz;
    normals[b] += nx;
    normals[b + 1] += ny;
    normals[b + 2] += nz;
    normals[c] += nx;
    normals[c + 1] += ny;
    normals[c + 2] += nz;
  }
  for (let i = 0; i < normals.length; i += 3) {
    const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    normals[i] /= length;
    normals[i + 1] /= length;
    normals[i + 2] /= length;
  }
}

// One level: old vertices move to a mean of their neighbours, each edge gets a vertex, each triangle becomes
// four.
function subdivide(triangles, vertices, corners) {
  const edges = new Map(),
    list = [];
  for (let i = 0; i < triangles.length; ++i) {
    const f = 3 * Math.floor(i / 3),
      a = triangles[i],
      b = triangles[f + ((i + 1) % 3)],
      c = triangles[f + ((i + 2) % 3)];
    const key = Math.min(a, b) * vertices + Math.max(a, b);
    let edge = edges.get(key);
    if (!edge) {
      edge = {a, b, opposite: [], number: vertices + list.length};
      edges.set(key, edge);
      list.push(edge);
    }
    edge.opposite.push(c);
  }
  const around = Array.from({length: vertices}, () => []),
    rim = Array.from({length: vertices}, () => []);
  for (const {a, b, opposite} of list) {
    around[a].push(b);
    around[b].push(a);
    if (opposite.length !== 2) {
      rim[a].push(b);
      rim[b].push(a);
    }
  }
  const weights = weightList(vertices + list.length);
  for (let v = 0; v < vertices; ++v) addOldVertex(weights, v, around[v], rim[v], corners[v]);
  for (const {a, b, opposite} of list) {
    if (opposite.length === 2) weights.add([a, b, ...opposite], [3 / 8, 3 / 8, 1 / 8, 1 / 8]);
    else weights.add([a, b], [1 / 2, 1 / 2]);
  }
  const result = new Uint32Array(4 * triangles.length);
  const middle = (a, b) => edges.get(Math.min(a, b) * vertices + Math.max(a, b)).number;
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = triangles.subarray(i, i + 3),
      ab = middle(a, b),
      bc = middle(b, c),
      ca = middle(c, a);
    result.set([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], 4 * i);
  }
  return {triangles: result, vertices: vertices + list.length, weights: weights.done()};
}

function addOldVertex(weights, v, around, rim, isCorner) {
  if (isCorner) {
    weights.add([v], [1]);
  } else if (rim.length === 0) {
    const n = around.length,
      share = n === 3 ? 3 / 16 : 3 / (8 * n);
    weights.add([v, ...around], [1 - n * share, ...around.map(() => share)]);
  } else if (rim.length === 2) {
    weights.add([v, ...rim], [3 / 4, 1 / 8, 1 / 8]);
  } else {
    weights.add([v], [1]);
  }
}

function weightList(rows) {
  const begin = [0],
    columns = [],
    values = [];
  return {
    add(indices, shares) {
      columns.push(...indices);
      values.push(...shares);
      begin.push(columns.length);
    },
    done: () => ({
      rows,
      begin: Uint32Array.from(begin),
      columns: Uint32Array.from(columns),
      values: Float32Array.from(values),
    }),
  };
}

function apply({rows, begin, columns, values}, from, to, size) {
  if (size === 3) return applyToPoints(rows, begin, columns, values, from, to);
  for (let row = 0; row < rows; ++row)
    for (let k = 0; k < size; ++k) {
      let sum = 0;
      for (let i = begin[row]; i < begin[row + 1]; ++i) sum += values[i] * from[size * columns[i] + k];
      to[size * row + k] = sum;
    }
}

function applyToPoints(rows, begin, columns, values, from, to) {
  for (let row = 0; row < rows; ++row) {
    let x = 0,
      y = 0,
      z = 0;
    for (let i = begin[row]; i < begin[row + 1]; ++i) {
      const w = values[i],
        c = 3 * columns[i];
      x += w * from[c];
      y += w * from[c + 1];
      z += w * from[c + 2];
    }
    to[3 * row] = x;
    to[3 * row + 1] = y;
    to[3 * row + 2] = z;
  }
}
