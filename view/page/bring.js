// What a press on the organ brings: an instrument, in the JSON of scenes with "at" in place of "path", and
// where it is led to at first.
import * as THREE from './third_party/three-0.187.0/three.module.js';

// Of jaws, in openings: width, thickness and length of each, how far they reach behind the point that was
// clicked, from how far they come, from how near to where they are led they close, and their friction.
const jaws = {size: [0.3, 0.14, 0.5], depth: 0.35, from: 0.5, there: 0.03, friction: 0.6},
  press = 0.6, // how far a probe is pressed in, of its radius
  // Of a hook, in lengths of its wire: how far it burns about itself, its own radius, and how far it is
  // pressed in. A thinner wire would go through the tissue that it lifts.
  hook = {radius: 0.15, core: 0.1, press: 0.25},
  // Of a clip, in distances across what it closes on: how far its legs are apart, before and after.
  clip = {opening: 1.25, gap: 0.35, width: 0.15, longer: 1.25};

/**
 * By the kind of instrument what a press brings, or in words why it brings nothing. `on`: whether it works at
 * once; `point`: where it is led to; `there`: from how near to that jaws close.
 * @type {Record<string, (stage: Stage, hit: {point: THREE.Vector3, isBeside?: boolean}, size: number,
 *   organ: Organ) => {tool: object, on?: boolean, point: THREE.Vector3, there?: number}|string>}
 */
export const bringing = {
  cautery: (stage, {point}, radius) => ({
    tool: {type: 'cautery', radius, at: point.toArray()},
    on: true,
    point: point.clone(),
  }),

  // It comes from the viewer's side, and is pressed in by a little.
  probe(stage, {point}, radius) {
    const before = by => point.clone().addScaledVector(stage.forward(), -by * radius);
    return {
      tool: {type: 'probe', shape: {sphere: {radius}}, at: before(1.5).toArray()},
      point: before(1 - press),
    };
  },

  // They come open from the viewer's side, one above the other, and reach behind the point.
  jaws(stage, hit, opening) {
    const forward = stage.forward(),
      above = stage.above(),
      axes = new THREE.Matrix4().makeBasis(new THREE.Vector3().crossVectors(above, forward), above, forward),
      point = hit.point.clone().addScaledVector(forward, (jaws.depth - jaws.size[2]) * opening),
      from = point.clone().addScaledVector(forward, -jaws.from * opening);
    const tool = {
      type: 'probe',
      shape: {jaws: {size: jaws.size.map(side => side * opening)}},
      friction: jaws.friction,
      at: [...from.toArray(), ...turnTo(axes), opening],
    };
    return {tool, point, there: jaws.there * opening};
  },

  // Its wire leads away from the viewer, so that a drag lifts what lies on it. On the organ its end presses;
  // beside it, it is as deep as the organ is there.
  hook(stage, {point, isBeside}, length) {
    const forward = stage.forward(),
      before = by => point.clone().addScaledVector(forward, -by * length),
      from = before(isBeside ? 0.5 : 1 + 2 * hook.core);
    const tool = {
      type: 'cautery',
      radius: hook.radius * length,
      core: hook.core * length,
      hook: forward.clone().multiplyScalar(length).toArray(),
      at: from.toArray(),
    };
    return {tool, point: isBeside ? from : before(1 - hook.press)};
  },

  // Its legs lie on both sides of what is narrow there, and reach behind it.
  clip(stage, hit, most, organ) {
    const strip = stripAt(stage, organ.around(hit), hit.point, most);
    if (!strip) return 'Here the organ is wider than the clip opens. The key ] makes it larger.';
    const forward = stage.forward(),
      {middle, across, width} = strip,
      seen = stage.project(middle),
      front = organ.hit(stage.ray(seen.x, seen.y))?.point ?? hit.point,
      deep = organ.thickness(front, forward) || width,
      point = front.clone().addScaledVector(forward, deep / 2);
    const axes = new THREE.Matrix4().makeBasis(
      forward,
      new THREE.Vector3().crossVectors(across, forward),
      across,
    );
    const tool = {
      type: 'clip_applier',
      length: clip.longer * deep,
      opening: clip.opening * width,
      gap: clip.gap * width,
      width: clip.width * width,
      at: [...point.toArray(), ...turnTo(axes)],
    };
    return {tool, point};
  },
};

const turnTo = axes => new THREE.Quaternion().setFromRotationMatrix(axes).toArray();

const cells = 48, // of the picture in which a strip is looked for, in each direction
  closer = 3; // of the strip's width, how wide the picture is in which it is looked for again

/**
 * Across which direction the organ is narrowest at a point of its surface, as the viewer sees it, how wide it
 * is there, and the middle between its sides. Null: it is wider than `most`.
 * @param {{triangles: ArrayLike<number>, x: ArrayLike<number>}} surface
 * @returns {{across: THREE.Vector3, width: number, middle: THREE.Vector3}|null}
 */
export function stripAt(stage, surface, point, most) {
  const rough = stripWithin(stage, surface, point, most);
  // Of what is far narrower than the clip opens, a closer look shows the sides.
  if (!rough || rough.width > most / closer) return rough;
  return stripWithin(stage, surface, rough.middle, closer * rough.width) ?? rough;
}

function stripWithin(stage, surface, point, most) {
  const right = stage.right(),
    above = stage.above(),
    mask = pictureOf(surface, point, [right, above, stage.forward()], most),
    steps = cells,
    directions = 16;
  const isThere = (u, v) => mask[Math.floor(v + cells / 2) * cells + Math.floor(u + cells / 2)] === 1;
  const reach = (u, v) => {
    for (let i = 1; i < steps; ++i) {
      const r = (i * cells) / 2 / steps;
      if (!isThere(r * u, r * v)) return ((i - 0.5) * most) / steps;
    }
    return Infinity;
  };
  let best = null;
  for (let i = 0; i < directions; ++i) {
    const angle = (Math.PI * i) / directions,
      [u, v] = [Math.cos(angle), Math.sin(angle)],
      [to, from] = [reach(u, v), reach(-u, -v)],
      width = to + from;
    if (!(width <= most) || width >= (best?.width ?? Infinity)) continue;
    const across = right.clone().multiplyScalar(u).addScaledVector(above, v);
    best = {across, width, middle: point.clone().addScaledVector(across, (to - from) / 2)};
  }
  return best;
}

// Where the organ is, as seen from the viewer: 1 in the cells that a triangle covers, of a square that
// reaches `half` to each side of a point. Axes are those of the view; what is far behind does not count.
function pictureOf({triangles, x}, point, axes, half) {
  const mask = new Uint8Array(cells * cells),
    perCell = (2 * half) / cells,
    at = new THREE.Vector3();
  const seen = v => {
    at.set(x[3 * v], x[3 * v + 1], x[3 * v + 2]).sub(point);
    const [u, w, deep] = axes.map(axis => axis.dot(at));
    return [u / perCell + cells / 2, w / perCell + cells / 2, deep];
  };
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map(k => seen(triangles[t + k]));
    if (Math.min(a[2], b[2], c[2]) > half) continue;
    const low = [0, 1].map(k => Math.max(0, Math.ceil(Math.min(a[k], b[k], c[k]) - 0.5))),
      high = [0, 1].map(k => Math.min(cells - 1, Math.floor(Math.max(a[k], b[k], c[k]) - 0.5)));
    for (let v = low[1]; v <= high[1]; ++v)
      for (let u = low[0]; u <= high[0]; ++u)
        if (isWithin([u + 0.5, v + 0.5], a, b, c)) mask[v * cells + u] = 1;
  }
  return mask;
}

// Whichever way round the triangle is.
function isWithin(p, a, b, c) {
  const side = (from, to) => (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0]),
    [i, j, k] = [side(a, b), side(b, c), side(c, a)];
  return (i >= 0 && j >= 0 && k >= 0) || (i <= 0 && j <= 0 && k <= 0);
}
