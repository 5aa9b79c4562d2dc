// The scalpel of the page in a headless Chromium: what is drawn over the organ opens its surface, at any
// depth.
// Usage: node browser_scalpel_test.mjs LOBE_VIEW SCENE MODULES OUT
import {comesTo, drag, openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1280, height: 720});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');

// Cut faces; the length of the rim at which they meet the skin [m], at rest; and the same from the viewer's
// side of the body's middle only.
const cut = () =>
  page.evaluate(() => {
    const {triangles, rest, cut} = lobe.organ.topology,
      key = v => [0, 1, 2].map(k => rest[3 * v + k].toFixed(7)).join(),
      edges = new Set();
    let faces = 0,
      rim = 0;
    for (let t = 0; t < cut.length; ++t)
      for (let k = 0; k < 3 && !cut[t]; ++k) {
        const [a, b] = [key(triangles[3 * t + k]), key(triangles[3 * t + ((k + 1) % 3)])];
        edges.add(a < b ? `${a} ${b}` : `${b} ${a}`);
      }
    for (let t = 0; t < cut.length; ++t) {
      if (!cut[t]) continue;
      ++faces;
      for (let k = 0; k < 3; ++k) {
        const [v, w] = [triangles[3 * t + k], triangles[3 * t + ((k + 1) % 3)]],
          [a, b] = [key(v), key(w)];
        if (edges.has(a < b ? `${a} ${b}` : `${b} ${a}`))
          rim += Math.hypot(...[0, 1, 2].map(i => rest[3 * v + i] - rest[3 * w + i]));
      }
    }
    return {faces, rim};
  });

// How far the lips of the cut are apart [m]: the same place at rest, twice on the skin.
const gap = () =>
  page.evaluate(() => {
    const {triangles, rest, cut} = lobe.organ.topology,
      {x} = lobe.organ,
      places = new Map();
    let widest = 0;
    triangles.forEach((v, i) => {
      if (cut[Math.floor(i / 3)]) return;
      const key = [0, 1, 2].map(k => rest[3 * v + k].toFixed(7)).join(),
        other = places.get(key) ?? v;
      places.set(key, other);
      widest = Math.max(widest, Math.hypot(...[0, 1, 2].map(k => x[3 * v + k] - x[3 * other + k])));
    });
    return widest;
  });

// Where on the window the organ is, as a box.
const box = () =>
  page.evaluate(() => {
    const point = lobe.stage.target.clone(),
      {array} = lobe.organ.position,
      seen = {left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity};
    for (let i = 0; i < array.length; i += 3) {
      const {x, y} = lobe.stage.project(point.fromArray(array, i));
      seen.left = Math.min(seen.left, x);
      seen.right = Math.max(seen.right, x);
      seen.top = Math.min(seen.top, y);
      seen.bottom = Math.max(seen.bottom, y);
    }
    return seen;
  });

// Until the blade has cut and, for 0.2 s of the simulation, no more faces.
async function cutEnds() {
  await page.evaluate(() => (window.last = null));
  await until(page, () => {
    const {time} = lobe.status,
      faces = lobe.organ.cutCount;
    if (window.last?.faces !== faces) window.last = {time, faces};
    return faces > 0 && time > window.last.time + 0.2;
  });
}

async function stroke(from, to, notches) {
  await page.keyboard.press('r');
  await until(page, () => lobe.organ.cutCount === 0 && lobe.status.time < 3);
  await page.keyboard.press('x');
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 0; i < notches; ++i) await page.mouse.wheel(0, -100);
  const hint = await page.textContent('#hint'),
    gauge = await page.textContent('#depth');
  if (notches === 4) await shot('gauge');
  for (let i = 1; i <= 12; ++i) {
    await page.mouse.move(from.x + ((to.x - from.x) * i) / 12, from.y + ((to.y - from.y) * i) / 12);
    await page.waitForTimeout(40);
  }
  await cutEnds();
  await page.mouse.up();
  return {hint, gauge};
}

// Down over the front, where the organ comes nearer to the viewer: the middle of its right half.
await page.evaluate(() => lobe.ask({do: 'speed', factor: 1}));
const {left, right, top, bottom} = await box();
const x = left + 0.62 * (right - left),
  first = await page.evaluate(
    ([x, top, bottom]) => {
      for (let y = top; y < bottom; y += 4) if (lobe.organ.hit(lobe.stage.ray(x, y))) return y;
      return null;
    },
    [x, top, bottom],
  );
for (const [name, from, length] of [
  ['over the front', {x, y: first + 0.35 * (bottom - top)}, 0.25],
  ['from the silhouette over the front', {x, y: first + 6}, 0.45],
])
  for (const notches of [0, 4, 8]) {
    const {hint, gauge} = await stroke(from, {x: from.x, y: from.y + length * (bottom - top)}, notches);
    const {faces, rim} = await cut();
    const depth = `${20 + 4 * notches} mm`;
    check(
      hint.startsWith(depth) && gauge.trim().startsWith(depth),
      `${name}, ${notches} notches: the page says "${hint}", and beside the pointer "${gauge.trim()}"`,
    );
    check(
      faces > 20 && rim > 0.03,
      `and the cut opens the surface: ${faces} cut faces, with a rim of ${(1e3 * rim).toFixed(0)} mm`,
    );
    await shot(`${name.replaceAll(' ', '_')}_${notches}`);
    const closed = await gap();
    await page.keyboard.press('g');
    await drag(page, {x: x + 40, y: from.y + 0.12 * (bottom - top)}, 90, 0);
    const open = await comesTo(gap, widest => widest > closed + 2e-3);
    check(
      open > closed + 2e-3,
      `pulled beside it, it gapes: from ${(1e3 * closed).toFixed(1)} to ${(1e3 * open).toFixed(1)} mm`,
    );
    await shot(`${name.replaceAll(' ', '_')}_${notches}_pulled`);
    await page.mouse.up();
  }

// Before it cuts, the page shows how deep it would; keys and the slider change that.
const place = {x, y: first + 0.4 * (bottom - top)};
await page.keyboard.press('r');
await until(page, () => lobe.organ.cutCount === 0 && lobe.status.time < 3);
await page.keyboard.press('x');
await page.mouse.move(place.x + 30, place.y);
const depthBefore = await page.textContent('#depth');
for (let i = 0; i < 8; ++i) await page.keyboard.press(']');
await page.mouse.move(place.x, place.y);
const depthAfter = await page.textContent('#depth');
check(
  /^20 mm\s+of \d+ mm$/.test(depthBefore.trim()) && /^40 mm/.test(depthAfter.trim()),
  `over the organ it says "${depthBefore.trim()}", with eight presses of ] "${depthAfter.trim()}"`,
);
const ghost = await page.evaluate(([x, y]) => {
  const {body} = lobe.hands.ghost,
    {point} = lobe.organ.hit(lobe.stage.ray(x, y));
  return {isSeen: body.visible, depth: body.position.clone().sub(point).dot(lobe.stage.forward())};
}, [place.x, place.y]);
check(
  ghost.isSeen && Math.abs(ghost.depth - 0.04) < 2e-3,
  `and its ghost is there, ${(1e3 * ghost.depth).toFixed(1)} mm below the surface`,
);
await page.mouse.move(left - 60, top - 40);
check(
  !(await page.evaluate(() => lobe.hands.ghost.body.visible)),
  'beside the organ there is none',
);
await page.locator('#tool-size input').fill('16');
await page.mouse.move(place.x + 30, place.y);
check(
  /^8\d mm\s+cuts through$/.test((await page.textContent('#depth')).trim()),
  'and where it is deeper than the organ is thick, that it cuts through',
);
await shot('through');
await end();
