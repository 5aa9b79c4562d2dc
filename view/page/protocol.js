// Frames as blocks [tag u32][size u32][bytes], little-endian (docs/live_protocol.md). Unknown tags are
// skipped.

const text = new TextDecoder();

/** @returns {{topology?: object, positions?: object, scalar?: object, tools?: object[], status?: object,
 *   held?: object, materials?: object, fibres?: object, bodies?: object, threads?: object[], skin?: object,
 *   skinPositions?: object, choices?: object, obstacles?: object[]}} */
export function readFrame(/** @type {ArrayBuffer} */ buffer) {
  const view = new DataView(buffer);
  const frame = {};
  for (let at = 0; at + 8 <= buffer.byteLength;) {
    const tag = text.decode(new Uint8Array(buffer, at, 4));
    const size = view.getUint32(at + 4, true);
    at += 8;
    if (at + size > buffer.byteLength) throw new Error(`block ${tag} is longer than its frame`);
    if (readers[tag]) readers[tag](frame, buffer, at, size, view);
    at += (size + 3) & ~3;
  }
  return frame;
}

const readJson = (buffer, at, size) => JSON.parse(text.decode(new Uint8Array(buffer, at, size)));

const readers = {
  TOPO(frame, buffer, at, size, view) {
    const revision = view.getUint32(at, true),
      vertices = view.getUint32(at + 4, true),
      triangles = view.getUint32(at + 8, true);
    const corners = at + 12,
      rest = corners + 12 * triangles,
      region = rest + 12 * vertices,
      cut = region + triangles;
    frame.topology = {
      revision,
      triangles: new Uint32Array(buffer, corners, 3 * triangles),
      rest: new Float32Array(buffer, rest, 3 * vertices),
      region: new Uint8Array(buffer, region, triangles),
      cut: new Uint8Array(buffer, cut, triangles),
    };
  },
  POSN(frame, buffer, at, size, view) {
    frame.positions = {
      revision: view.getUint32(at, true),
      x: new Float32Array(buffer, at + 4, (size - 4) / 4),
    };
  },
  SKIN(frame, buffer, at, size, view) {
    const vertices = view.getUint32(at + 4, true),
      triangles = view.getUint32(at + 8, true);
    frame.skin = {
      revision: view.getUint32(at, true),
      triangles: new Uint32Array(buffer, at + 12, 3 * triangles),
      rest: new Float32Array(buffer, at + 12 + 12 * triangles, 3 * vertices),
    };
  },
  SKNP(frame, buffer, at, size, view) {
    frame.skinPositions = {
      revision: view.getUint32(at, true),
      x: new Float32Array(buffer, at + 4, (size - 4) / 4),
    };
  },
  SCAL(frame, buffer, at, size, view) {
    frame.scalar = {
      name: text.decode(new Uint8Array(buffer, at, 16)).replace(/\0+$/, ''),
      low: view.getFloat32(at + 16, true),
      high: view.getFloat32(at + 20, true),
      steps: new Uint16Array(buffer, at + 24, (size - 24) / 2),
    };
  },
  PNTS(frame, buffer, at, size) {
    frame.held = new Uint8Array(buffer, at, size);
  },
  FIBR(frame, buffer, at, size) {
    frame.fibres = new Float32Array(buffer, at, size / 4);
  },
  BODS(frame, buffer, at, size) {
    frame.bodies = new Uint8Array(buffer, at, size);
  },
  THRD(frame, buffer, at, size, view) {
    const lines = view.getUint32(at, true);
    let begin = at + 4 + 4 * lines;
    frame.threads = Array.from({length: lines}, (_, i) => {
      const points = new Float32Array(buffer, begin, 3 * view.getUint32(at + 4 + 4 * i, true));
      begin += points.byteLength;
      return {points};
    });
    for (const line of frame.threads) {
      line.tensions = new Float32Array(buffer, begin, Math.max(0, line.points.length / 3 - 1));
      begin += line.tensions.byteLength;
    }
  },
  MATS(frame, buffer, at, size) {
    frame.materials = new Uint8Array(buffer, at, size);
  },
  CHOI(frame, buffer, at, size) {
    frame.choices = readJson(buffer, at, size);
  },
  OBST(frame, buffer, at, size) {
    frame.obstacles = readJson(buffer, at, size);
  },
  TOOL(frame, buffer, at, size) {
    frame.tools = readJson(buffer, at, size);
  },
  STAT(frame, buffer, at, size) {
    frame.status = readJson(buffer, at, size);
  },
};
