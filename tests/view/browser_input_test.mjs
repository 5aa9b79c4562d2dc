// Keys, fingers and the camera of the page in a headless Chromium.
// Usage: node browser_input_test.mjs LOBE_VIEW SCENE MODULES OUT
import {comesTo, grip, openPage, settles, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1280, height: 720}, {hasTouch: true});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');

// ---- The whole organ, as it is now, is between the panels

// How far its points are beyond the panels [pixels], and what share of the open height or width it takes.
const framed = () =>
  page.evaluate(() => {
    const box = id => document.getElementById(id).getBoundingClientRect(),
      panel = box('panel'),
      open = {left: 0, right: panel.width > 0 ? panel.left : innerWidth, top: 52, bottom: box('dock').top},
      point = lobe.stage.target.clone(),
      {array} = lobe.organ.position,
      seen = {left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity};
    for (let i = 0; i < array.length; i += 3) {
      const {x, y} = lobe.stage.project(point.fromArray(array, i));
      seen.left = Math.min(seen.left, x);
      seen.right = Math.max(seen.right, x);
      seen.top = Math.min(seen.top, y);
      seen.bottom = Math.max(seen.bottom, y);
    }
    return {
      beyond: Math.max(
        open.left - seen.left,
        seen.right - open.right,
        open.top - seen.top,
        seen.bottom - open.bottom,
      ),
      share: Math.max(
        (seen.right - seen.left) / (open.right - open.left),
        (seen.bottom - seen.top) / (open.bottom - open.top),
      ),
    };
  });
const isFramed = async what => {
  const {beyond, share} = await comesTo(framed, ({beyond, share}) => beyond <= 0 && share > 0.6);
  check(
    beyond <= 0 && share > 0.6,
    `${what}: all of it is between the panels and fills ${Math.round(100 * share)} %, ` +
      `${beyond.toFixed(0)} pixels beyond`,
  );
};
for (const [width, height] of [
  [1280, 720],
  [1920, 900],
  [960, 640],
  [800, 600],
]) {
  await page.setViewportSize({width, height});
  await isFramed(`${width} × ${height}`);
}
await page.setViewportSize({width: 1280, height: 720});

// Pulled down and held there: Home frames what is there now.
await page.evaluate(() => {
  lobe.stage.turn(1, 0);
  const {x} = lobe.organ,
    point = lobe.stage.target.clone();
  let right = 0;
  for (let i = 3; i < x.length; i += 3) if (x[i] > x[right]) right = i;
  point.fromArray(x, right);
  lobe.ask({do: 'take', hand: 0, from: [point.x, point.y, point.z + 0.3], along: [0, 0, -1], radius: 0.02});
  lobe.ask({do: 'lead', hand: 0, to: [point.x + 0.05, point.y, point.z - 0.06]});
});
await settles(page, 0.05);
await page.focus('#stage');
await page.keyboard.press('Home');
await isFramed('pulled aside, Home');
await shot('home');
await page.evaluate(() => lobe.ask({do: 'let_go', hand: 0}));

// ---- Keys

await page.focus('#tool-probe');
await page.keyboard.press(' ');
check(
  await page.evaluate(
    () =>
      document.getElementById('tool-probe').getAttribute('aria-checked') === 'true' && lobe.status.running,
  ),
  'the space bar presses the button that has the focus, and does not pause',
);
await page.click('#tool-grasp');
await page.keyboard.press(' ');
check(
  await until(page, () => !lobe.status.running),
  'after a click of the mouse the space bar pauses, whatever was clicked',
);
await page.keyboard.press(' ');
await until(page, () => lobe.status.running);
await page.focus('#colour');
await page.keyboard.press('s');
await page.waitForTimeout(200);
check(
  await page.evaluate(
    () =>
      document.getElementById('colour').value.startsWith('vo') &&
      !document.getElementById('slow').classList.contains('on'),
  ),
  'a letter chooses in the list of colours, and does nothing else',
);
await page.focus('#stage');
const camera = () =>
  page.evaluate(() => {
    const {azimuth, elevation, distance, target} = lobe.stage;
    return [azimuth, elevation, distance, target.x];
  });
const moved = async (key, part) => {
  const before = await camera();
  await page.keyboard.press(key);
  return (await camera())[part] - before[part];
};
check((await moved('ArrowLeft', 0)) < 0 && (await moved('ArrowRight', 0)) > 0, 'arrows turn the camera');
check((await moved('ArrowUp', 1)) > 0 && (await moved('ArrowDown', 1)) < 0, 'up and down as well');
check((await moved('+', 2)) < 0 && (await moved('-', 2)) > 0, 'plus and minus zoom');
check((await moved('Shift+ArrowLeft', 3)) !== 0, 'with shift arrows shift it');
await page.keyboard.press('Home');

// A hand by keys, from the middle of the organ.
await page.keyboard.press('y');
await page.keyboard.press('Enter');
for (let i = 0; i < 4; ++i) await page.keyboard.press('Shift+ArrowUp');
check(await until(page, () => lobe.force > 0.05), 'Enter takes hold, and arrows pull');
const azimuth = await camera();
await page.keyboard.press('PageDown');
await page.keyboard.press('ArrowLeft');
check((await camera()).every((value, i) => value === azimuth[i]), 'while they do not move the camera');
await page.keyboard.press('Enter');
check(await until(page, () => lobe.force === 0), 'Enter lets go');
await page.keyboard.press('Escape');
check((await moved('ArrowLeft', 0)) < 0 && !(await page.isVisible('#key-hand')), 'and Esc gives the arrows back');
await page.keyboard.press('Home');

// ---- Fingers

const fingers = await page.context().newCDPSession(page);
const touch = (type, ...touchPoints) =>
  fingers.send('Input.dispatchTouchEvent', {
    type,
    touchPoints: touchPoints.map(([x, y], id) => ({x, y, id})),
  });
const [, , far] = await camera();
await touch('touchStart', [60, 120]);
await touch('touchStart', [60, 120], [160, 120]);
for (let i = 1; i <= 5; ++i) await touch('touchMove', [60 - 5 * i, 120], [160 + 15 * i, 120]);
await touch('touchEnd');
const [, , near] = await camera();
check(
  near < 0.7 * far && near > 0.3 * far,
  `two fingers that part zoom in: ${far.toFixed(3)} to ${near.toFixed(3)} m`,
);
await page.focus('#stage');
await page.keyboard.press('Home');
await page.waitForTimeout(300);
const at = await grip(page);
await touch('touchStart', [at.x, at.y]);
await touch('touchMove', [at.x + 10, at.y - 25]);
check(await until(page, () => lobe.force > 0.05 && lobe.instruments.shown.size === 1), 'a finger pulls');
await touch('touchStart', [at.x + 10, at.y - 25], [at.x - 110, at.y]);
await touch('touchMove', [at.x + 10, at.y - 25], [at.x - 120, at.y - 20]);
check(await until(page, () => lobe.instruments.shown.size === 2), 'a second one takes hold, too');
await page.waitForTimeout(1500);
check(
  await page.evaluate(() => lobe.instruments.shown.size === 2 && lobe.forces.length === 2),
  'and the first one goes on pulling',
);
await shot('two_fingers');
await touch('touchEnd');
check(await until(page, () => lobe.instruments.shown.size === 0), 'both let go');
await end();
