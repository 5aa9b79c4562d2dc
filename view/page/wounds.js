// Which opened faces a cautery has charred, and which a blade has cut: by the instrument that was nearest
// when they came. Of what was opened before this page was there, nothing is charred.

const keyOf = (rest, a, b, c) =>
  [0, 1, 2].map(k => Math.round(1e6 * (rest[3 * a + k] + rest[3 * b + k] + rest[3 * c + k]))).join();

const memory = 1000; // of an instrument that has left [ms]

export class Wounds {
  constructor() {
    this.known = new Map(); // key of an opened face → 1: cut, 2: charred
    this.cutters = new Map(); // tool → {cutter, at}, when it was seen last
    this.mayForget = false;
  }

  /** The organ is another one. */
  forget() {
    this.known.clear();
    this.cutters.clear();
  }

  /** The simulation went back: what is not open any more may be opened otherwise. */
  wentBack() {
    this.mayForget = true;
  }

  /** @param {{tool: number, type: string, on: boolean, position: number[], orientation?: number[],
   *   blade?: number[]}[]} tools @param {number} now [ms] */
  see(tools, now = performance.now()) {
    for (const cutter of tools)
      if (cutter.on && (cutter.type === 'cautery' || cutter.type === 'scalpel'))
        this.cutters.set(cutter.tool, {cutter, at: now});
    for (const [tool, {at}] of this.cutters)
      if (now - at > memory && this.cutters.size > 1) this.cutters.delete(tool);
  }

  /** Of each triangle 0: skin, 1: cut, 2: charred.
   *  @param {{triangles: Uint32Array, rest: Float32Array, cut: Uint8Array}} surface
   *  @param {Float32Array} x present positions of its vertices */
  kinds({triangles, rest, cut}, x) {
    const kinds = cut.slice(),
      present = new Map();
    for (let t = 0; t < cut.length; ++t) {
      if (!cut[t]) continue;
      const [a, b, c] = triangles.subarray(3 * t, 3 * t + 3),
        key = keyOf(rest, a, b, c);
      const middle = k => (x[3 * a + k] + x[3 * b + k] + x[3 * c + k]) / 3;
      if (!this.known.has(key)) this.known.set(key, this.kindOf([0, 1, 2].map(middle)));
      kinds[t] = this.known.get(key);
      present.set(key, kinds[t]);
    }
    if (this.mayForget) this.known = present;
    this.mayForget = false;
    return kinds;
  }

  kindOf(point) {
    let nearest = null,
      least = Infinity;
    for (const {cutter} of this.cutters.values()) {
      const distance = distanceTo(cutter, point);
      if (distance < least) [nearest, least] = [cutter, distance];
    }
    return nearest?.type === 'cautery' ? 2 : 1;
  }
}

// From a point to the tip of a cautery, or to the edge of a blade.
function distanceTo({position, blade = [0, 0, 0], orientation = [0, 0, 0, 1]}, point) {
  const edge = turned(blade, orientation),
    from = point.map((c, k) => c - position[k]);
  const length2 = dot(edge, edge),
    along = length2 > 0 ? Math.max(0, Math.min(1, dot(from, edge) / length2)) : 0;
  return Math.hypot(...from.map((c, k) => c - along * edge[k]));
}

const dot = (a, b) => a.reduce((sum, c, k) => sum + c * b[k], 0);
const cross = (a, b) => [0, 1, 2].map(k => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);

function turned(v, [x, y, z, w]) {
  const axis = [x, y, z],
    t = cross(axis, v).map(c => 2 * c),
    u = cross(axis, t);
  return v.map((c, k) => c + w * t[k] + u[k]);
}
