// The fibres of a body in the page: lines in its surface that move with it, through cuts and painting.
// Usage: node browser_fibres_test.mjs LOBE_VIEW SCENE MODULES OUT
import {drag, grip, openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 960, height: 640});

// Pixels of the lines' colour.
const yellow = () =>
  page.evaluate(() => {
    const data = drawn();
    let count = 0;
    for (let i = 0; i < data.length; i += 4)
      count += data[i] > 220 && data[i + 1] > 200 && data[i + 2] > 120 && data[i + 2] < 190;
    return count;
  });

// How far the middles of the lines are from those of their triangles, at most, in parts of the organ's size.
const farthest = () =>
  page.evaluate(() => {
    const {fibres, x, topology} = lobe.organ,
      ends = fibres.position.array;
    let most = 0;
    fibres.marked.forEach(([at], line) => {
      const off = [0, 1, 2].map(k => {
        const corners = [0, 1, 2].map(c => x[3 * topology.triangles[at + c] + k]);
        return (ends[6 * line + k] + ends[6 * line + 3 + k]) / 2 - corners.reduce((s, c) => s + c, 0) / 3;
      });
      most = Math.max(most, Math.hypot(...off));
    });
    return most / lobe.stage.size;
  });

// In one look: cuts go on between two.
const allHaveLines = () =>
  page.evaluate(() => lobe.organ.fibres.marked.length === lobe.organ.topology.region.length);
const isShown = on => until(page, wanted => lobe.organ.fibres.lines.visible === wanted, on);

// ---- They are asked for

check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens and shows frames');
check(await page.isVisible('#fibres'), 'a body with fibres has a box for them');
check(await allHaveLines(), 'each triangle has a line');
await page.evaluate(() => lobe.ask({do: 'pause', on: true}));
const before = await yellow();
await page.keyboard.press('f');
check(await isShown(true), 'F shows them');
const after = await yellow();
check(before < 50 && after > 1000, `as lines on the organ: ${before} pixels, then ${after}`);
await shot('shown');

// Unit vectors that lie in the surface of the ventricle: the line is 0.8 of the root of twice the area.
const lengths = await page.evaluate(() => {
  const {fibres, topology} = lobe.organ,
    {rest} = topology;
  const saved = lobe.organ.x;
  fibres.move(rest);
  const ends = fibres.position.array,
    corner = i => [0, 1, 2].map(k => rest[3 * topology.triangles[i] + k]),
    found = [];
  fibres.marked.forEach(([at], line) => {
    const [a, b, c] = [0, 1, 2].map(k => corner(at + k)),
      u = b.map((value, k) => value - a[k]),
      v = c.map((value, k) => value - a[k]);
    const area = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    const along = [0, 1, 2].map(k => ends[6 * line + 3 + k] - ends[6 * line + k]);
    found.push(Math.hypot(...along) / (0.8 * Math.sqrt(area)));
  });
  fibres.move(saved);
  return found.sort((a, b) => a - b);
});
const median = lengths[lengths.length >> 1];
check(lengths.at(-1) < 1.001 && median > 0.95, `most lie in the surface: median ${median.toFixed(3)}`);

// ---- They move with it

await page.evaluate(() => lobe.ask({do: 'pause', on: false}));
const at = await grip(page);
await drag(page, at, 25, -25);
check(await until(page, () => lobe.force > 0.05), 'a drag pulls the organ');
await page.evaluate(() => lobe.ask({do: 'pause', on: true}));
check(await until(page, () => !lobe.status.running), 'it pauses');
await page.evaluate(() => {
  lobe.organ.drawn = null;
  lobe.organ.move(lobe.organ.x);
});
check((await farthest()) < 1e-5, 'the lines are in the middle of the displaced triangles');
await shot('pulled');
await page.evaluate(() => lobe.ask({do: 'pause', on: false}));
await page.mouse.up();
await page.keyboard.press('c');
await drag(page, {x: at.x - 40, y: at.y}, -30, 10);
check(await until(page, () => lobe.organ.cutCount > 0), 'the cautery leaves cut faces');
await page.mouse.up();
check(await allHaveLines(), 'which have lines, too');
await shot('burnt');

// ---- Painting, and away again

await page.keyboard.press('e');
check(await until(page, () => lobe.mode === 'edit'), 'painting begins');
const painted = (await isShown(true)) && (await yellow());
await page.keyboard.press('f');
// The colours of regions are near the lines' where the light is bright: these pixels are counted first.
const bare = (await isShown(false)) && (await yellow());
check(painted - bare > 1000, `and shows them: ${painted} pixels, ${bare} without them`);
await page.keyboard.press('f');
const again = (await isShown(true)) && (await yellow());
check(again - bare > 1000, `F shows them again: ${again} pixels`);
await page.keyboard.press('f');
const left = (await isShown(false)) && (await yellow());
check(Math.abs(left - bare) < 50, `F hides them: ${left} pixels, ${bare} before`);
await end();
