// The scalpel of the page in a headless Chromium: what is drawn over the organ opens its surface, at any
// depth.
// Usage: node browser_scalpel_test.mjs LOBE_VIEW SCENE MODULES OUT
import {openPage, until} from './page_support.mjs';

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

async function stroke(from, to, notches) {
  await page.keyboard.press('r');
  await until(page, () => lobe.organ.cutCount === 0 && lobe.status.time < 3);
  await page.keyboard.press('x');
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 0; i < notches; ++i) await page.mouse.wheel(0, -100);
  const hint = await page.textContent('#hint');
  for (let i = 1; i <= 12; ++i) {
    await page.mouse.move(from.x + ((to.x - from.x) * i) / 12, from.y + ((to.y - from.y) * i) / 12);
    await page.waitForTimeout(60);
  }
  await page.waitForTimeout(700);
  await page.mouse.up();
  await page.waitForTimeout(400);
  return hint;
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
    const hint = await stroke(from, {x: from.x, y: from.y + length * (bottom - top)}, notches);
    const {faces, rim} = await cut();
    check(hint.startsWith(`${20 + 4 * notches} mm`), `${name}, ${notches} notches: the page says "${hint}"`);
    check(
      faces > 20 && rim > 0.03,
      `and the cut opens the surface: ${faces} cut faces, with a rim of ${(1e3 * rim).toFixed(0)} mm`,
    );
    await shot(`${name.replaceAll(' ', '_')}_${notches}`);
  }

// Pulled beside it, the cut gapes.
await page.keyboard.press('g');
await page.mouse.move(x + 40, first + 0.3 * (bottom - top));
await page.mouse.down();
for (let i = 1; i <= 8; ++i) {
  await page.mouse.move(x + 40 + 10 * i, first + 0.3 * (bottom - top));
  await page.waitForTimeout(60);
}
await page.waitForTimeout(1500);
await shot('gaping');
await page.mouse.up();
await end();
