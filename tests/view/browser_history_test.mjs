// Undo and the bar of what was done, in a headless Chromium.
// Usage: node browser_history_test.mjs LOBE_VIEW SCENE MODULES OUT
import {drag, grip, openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1280, height: 720});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');
const marks = () => page.locator('#history button').count();
check(
  (await marks()) === 0 && (await page.isDisabled('#undo-act')),
  'nothing was done: there is no mark, and nothing to undo',
);

// A pull, then two cuts, each with some time after it. Between which times each began: on a busy machine the
// simulation hears of it some seconds later.
const at = await grip(page);
const act = async (key, x, dy) => {
  await page.keyboard.press(key);
  const before = await page.evaluate(() => lobe.status.time);
  await drag(page, {x, y: at.y}, 0, dy);
  await page.waitForTimeout(500);
  await page.mouse.up();
  const ended = await page.evaluate(() => lobe.status.time);
  await until(page, time => lobe.status.time > time + 1.2 && lobe.instruments.shown.size === 0, ended);
  return {from: before, to: await page.evaluate(() => lobe.history.acts.at(-1).time)};
};
const pulled = await act('g', at.x, -40);
const first = await act('x', at.x - 220, 60);
const faces = await page.evaluate(() => lobe.organ.cutCount);
const second = await act('x', at.x - 120, 60);
const facesOfBoth = await page.evaluate(() => lobe.organ.cutCount);
check(faces > 10 && facesOfBoth > faces, `two cuts have ${faces} and then ${facesOfBoth} faces`);
check((await marks()) === 3, 'each act has a mark on the bar');
await shot('marks');

// Slowly, so that the page sees a time soon after it, however busy the machine is.
await page.evaluate(() => lobe.ask({do: 'speed', factor: 0.1}));
const wentBackBefore = async ({from, to}, words) => {
  const isBack = await until(page, to => lobe.status.time < to + 0.6 && lobe.history.wanted === null, to);
  const found = await page.evaluate(() => [lobe.status.time, lobe.organ.cutCount]);
  check(
    isBack && found[0] >= from,
    `${words}: at ${found[0].toFixed(2)} s it is where it was between ${from.toFixed(2)} and ${to.toFixed(2)} s`,
  );
  return found[1];
};
await page.keyboard.press('Control+z');
check((await wentBackBefore(second, 'Ctrl Z')) === faces, 'the first cut is still there');
check((await marks()) === 2, 'and the mark of the second is gone');
await page.locator('#history button.grasp').click();
check((await wentBackBefore(pulled, 'a click on the mark of the pull')) === 0, 'nothing is cut');
check((await marks()) === 0, 'no mark is left');
check(await until(page, () => document.getElementById('undo-act').disabled), 'there is nothing to undo');

await page.evaluate(() => lobe.ask({do: 'speed', factor: 1}));

// While a hand holds something: it lets go, and no later pose of the pointer is refused.
await page.keyboard.press('g');
await drag(page, at, 0, -30);
await until(page, () => lobe.force > 0.1);
await page.keyboard.press('Control+z');
check(await until(page, () => lobe.instruments.shown.size === 0), 'undone during a pull, the hand lets go');
await page.mouse.move(at.x + 10, at.y);
await page.mouse.up();
await page.waitForTimeout(300);
check((await page.textContent('#messages')) === '', 'and nothing is wrong about that');

// A place of the bar that is no mark.
const {width, height, x, y} = await page.locator('#history').boundingBox();
const wanted = (await page.evaluate(() => lobe.status.time)) / 2;
await page.evaluate(() => lobe.ask({do: 'speed', factor: 0.1}));
await page.mouse.click(x + width / 2, y + height / 2);
check(
  await until(page, wanted => Math.abs(lobe.status.time - wanted) < 1.2, wanted),
  'a click on the bar goes back to that time',
);
await end();
