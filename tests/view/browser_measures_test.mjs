// Measuring in the page, in a headless Chromium.
// Usage: node browser_measures_test.mjs LOBE_VIEW SCENE MODULES OUT
import {drag, grip, openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1280, height: 720});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');
await page.waitForTimeout(1000);
const at = await grip(page);
const text = id => page.textContent(`#${id}`);

// ---- A distance

await page.keyboard.press('t');
await drag(page, {x: at.x - 40, y: at.y}, -240, 0);
await page.mouse.up();
await shot('tape');
const expected = await page.evaluate(
  ([x, y]) => {
    const [a, b] = [x, x - 240].map(x => lobe.organ.hit(lobe.stage.ray(x, y))?.point);
    return a && b ? 1e3 * a.distanceTo(b) : NaN;
  },
  [at.x - 40, at.y],
);
await until(
  page,
  expected => Math.abs(parseFloat(document.getElementById('distance').textContent) - expected) < 1.5,
  expected,
);
const distance = parseFloat(await text('distance'));
check(Math.abs(distance - expected) < 1.5, `it says ${distance} mm; between its ends are ${expected.toFixed(2)} mm`);
await shot('distance');

// It follows the tissue when that is pulled.
await page.keyboard.press('g');
await drag(page, {x: at.x - 20, y: at.y}, 60, 20);
check(
  await until(page, distance => parseFloat(document.getElementById('distance').textContent) > distance + 2, distance),
  'pulled at one end it gets longer',
);
await shot('pulled');
await page.mouse.up();

// ---- A cut, then a hole

// What was pulled swings for a while. A stroke through it then is longer than what is drawn.
const released = await page.evaluate(() => lobe.status.time);
await until(page, released => lobe.status.time > released + 3, released);
const place = {x: at.x - 160, y: at.y - 50};
const drawn = await page.evaluate(({x, y}) => {
  const points = [...Array(16).keys()].map(i => lobe.organ.hit(lobe.stage.ray(x, y + 10 * i)).point);
  return 1e3 * points.slice(1).reduce((sum, point, i) => sum + point.distanceTo(points[i]), 0);
}, place);
await page.keyboard.press('x');
await drag(page, place, 0, 150);
await page.waitForTimeout(3000);
await page.mouse.up();
await until(page, () => document.getElementById('cut-length').textContent !== '');
await page.waitForTimeout(800);
const cut = parseFloat(await text('cut-length')),
  edge = 13; // [mm] of a tetrahedron: at its end a stroke opens only those that it has crossed
check(
  cut > drawn - edge && cut < 1.5 * drawn,
  `a stroke over ${drawn.toFixed(0)} mm of the organ cuts ${cut} mm`,
);
check((await text('removed')) === '', 'and removes nothing');
check(parseFloat(await text('distance')) > 0, 'the tape is still there');
await page.keyboard.press('c');
const tets = await page.evaluate(() => lobe.status.tets);
await drag(page, {x: at.x - 330, y: at.y}, 30, 20);
await until(page, tets => lobe.status.tets < tets - 5, tets);
await page.mouse.up();
check(await until(page, () => /ml$/.test(document.getElementById('removed').textContent)), 'a burn removes');
await page.waitForTimeout(800);
const [gone, all, volume] = await page.evaluate(tets => [tets - lobe.status.tets, tets, lobe.volume], tets);
const removed = parseFloat(await text('removed')),
  mean = (1e6 * volume * gone) / all;
check(removed > mean / 4 && removed < 4 * mean, `${removed} ml; ${gone} mean tetrahedra have ${mean.toFixed(2)} ml`);
await shot('hole');
await page.keyboard.press('Escape');
check(await until(page, () => document.getElementById('distance').textContent === ''), 'Esc takes the tape away');
await end();
