// Frames as blocks [tag u32][size u32][bytes], little-endian (docs/live_protocol.md). Unknown tags are
// skipped.

const text = new TextDecoder();

/** @returns {{topology?: object, positions?: object, scalar?: object, tools?: object[], status?: object,
 *   held?: object, materials?: object, fibres?: object, bodies?: object, lines?: object[], skin?: object,
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

const nameAt = (buffer, at) => text.decode(new Uint8Array(buffer, at, 16)).replace(/\0+$/, '');

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
      name: nameAt(buffer, at),
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
  LINE(frame, buffer, at, size, view) {
    const groups = view.getUint32(at, true);
    frame.lines = [];
    for (let i = 0, head = at + 4; i < groups; ++i, head += 20)
      frame.lines.push({term: nameAt(buffer, head), segments: view.getUint32(head + 16, true)});
    let begin = at + 4 + 20 * groups;
    for (const [part, each] of [
      ['ends', 6],
      ['tensions', 1],
      ['damages', 1],
    ])
      for (const line of frame.lines) {
        line[part] = new Float32Array(buffer, begin, each * line.segments);
        begin += line[part].byteLength;
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
