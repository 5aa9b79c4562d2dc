// A hook, clips, needle and thread of the page, and an artery that is cut, in a headless Chromium.
// Usage: node browser_clips_test.mjs LOBE_VIEW SCENE MODULES OUT
import {drag, grip, openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1280, height: 720});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');
const at = await grip(page);

// ---- A hook lifts what lies on its wire, and burns while D is pressed

// Beside the lower edge of the left lobe.
const below = await page.evaluate(x => {
  const {organ, stage} = lobe;
  for (let y = innerHeight - 80; y > 80; y -= 4) if (organ.hit(stage.ray(x, y))) return {x, y: y + 24};
  return null;
}, at.x - 60);
await page.keyboard.press('u');
check(/D, or the right button/.test(await page.textContent('#hint')), 'the page says how the hook is used');
await drag(page, below, 0, -70);
check(await until(page, () => lobe.force > 0.1), 'a hook that begins beside an edge lifts it');
await shot('lifted');
const whole = await page.evaluate(() => lobe.status.tets);
await page.keyboard.down('d');
check(await until(page, whole => lobe.status.tets < whole, whole), 'with D it burns');
const says = words => until(page, words => document.getElementById('labels').textContent.includes(words), words);
check(await says('burning'), 'which it says');
await page.keyboard.up('d');
check(await says(' N'), 'without D it lifts again');
await page.mouse.up();

// ---- A clip closes on what is narrow when the pointer lets go

await page.keyboard.press('r');
await until(page, whole => lobe.status.tets === whole && lobe.status.time < 3, whole);
await page.keyboard.press('a');
await page.locator('#tool-size input').fill('-16');
await page.mouse.click(at.x, at.y);
check(
  await until(page, () => /wider than the clip/.test(document.getElementById('messages').textContent)),
  'where the organ is wider than a clip opens nothing begins, and the page says why',
);
check(await page.evaluate(() => lobe.history.acts.length === 0), 'which is no act');
await page.locator('#tool-size input').fill('8');
await page.mouse.move(at.x, at.y);
await page.mouse.down();
check(await until(page, () => lobe.instruments.shown.size === 1), 'an applier comes');
await shot('open');
await page.mouse.up();
check(await until(page, () => lobe.lines.tubes.clips.count > 0), 'and closes a clip, which is drawn');
check(await until(page, () => lobe.instruments.shown.size === 0), 'and goes');
await shot('clipped');
await page.keyboard.press('Control+z');
check(await until(page, () => lobe.lines.tubes.clips.count === 0), 'undone, there is none');

// ---- Needle and thread: click in, click out, draw up, tie

await page.keyboard.press('r');
await until(page, () => lobe.status.time < 1 && lobe.history.acts.length === 0);
await page.keyboard.press('n');
check(/Click in, click out/.test(await page.textContent('#hint')), 'the page says how one sews');
const thread = () => page.evaluate(() => lobe.status.threads?.[0]);
const has = condition => until(page, new Function(`const thread = lobe.status.threads?.[0]; return ${condition}`));
const twice = async (x, y) => {
  await page.mouse.click(x, y);
  await page.mouse.click(x, y);
};
await twice(at.x - 60, at.y);
check(
  await until(page, () => /A knot needs two places/.test(document.getElementById('messages').textContent)),
  'one place is no stitch, which the page says',
);
await page.waitForTimeout(500);
await page.mouse.click(at.x - 20, at.y);
check(await has('thread?.bites.length === 2'), 'two clicks are two bites of one thread');
check(await until(page, () => lobe.lines.tubes.threads.count === 1), 'which is drawn');
await page.waitForTimeout(500);
await drag(page, {x: at.x - 40, y: at.y}, 0, -80);
check(await has('thread?.held && thread.pull > 0.02'), 'a drag draws its ends up');
check(await until(page, () => /Drawn up with/.test(document.getElementById('hint').textContent)), 'with a force that is told');
await shot('drawn_up');
await page.mouse.up();
await page.waitForTimeout(500);
check((await thread()).held, 'they stay in the hand');
await twice(at.x - 40, at.y);
check(await has('thread?.knots.length === 1 && !thread.held'), 'a double click ties');
check(await until(page, () => lobe.lines.tubes.threads.count === 2), 'a loop');
await shot('tied');
await page.keyboard.press('Control+z');
check(await has('thread && thread.knots.length === 0 && !thread.held'), 'undone, the thread is free');
await page.waitForTimeout(500);
await twice(at.x - 40, at.y);
check(await has('thread?.knots.length === 1 && thread.bites.length === 3'), 'and goes on, to a third place');

// ---- An artery is cut between two clips, and without them

await page.keyboard.press('l');
const title = 'A gallbladder on its bed, with its duct and artery, in the hands';
await page.selectOption('#shipped', {label: title});
check(await until(page, () => lobe.opened === 1 && !lobe.status.opening), 'another scene is opened');
await page.keyboard.press('l');
await until(page, () => !document.querySelector('#opener:not([hidden])') && lobe.frames > 2);
// From left to right, where it lies over the liver: [x, its upper end, its lower end].
const artery = await page.evaluate(() => {
  const {organ, bodies, stage} = lobe,
    found = [];
  const isArtery = hit => hit && bodies.names[organ.bodyOf(hit)] === 'artery';
  for (let x = 300; x < 700; x += 8) {
    const ys = [];
    for (let y = 90; y < 330; y += 4) if (isArtery(organ.hit(stage.ray(x, y)))) ys.push(y);
    if (ys.length > 0) found.push([x, ys[0], ys.at(-1)]);
  }
  return found;
});
check(artery.length > 8, `the artery is seen over ${8 * artery.length} pixels`);
const along = share => artery[Math.floor(share * artery.length)],
  told = name => page.evaluate(name => lobe.status.messages.some(message => message.name === name), name);
// By a stroke of the scalpel, which ends once this is so.
async function cutArtery(condition, what) {
  await page.keyboard.press('x');
  const [x, top, bottom] = along(0.4);
  await drag(page, {x, y: top - 12}, 0, bottom - top + 24);
  check(await until(page, condition), what);
  await page.mouse.up();
}
await page.keyboard.press('a');
for (const share of [0.25, 0.55]) {
  const [x, top, bottom] = along(share);
  await page.mouse.move(x, (top + bottom) / 2);
  await page.mouse.down();
  await until(page, () => lobe.instruments.shown.size === 1);
  await page.mouse.up();
  await until(page, () => lobe.instruments.shown.size === 0);
}
check(await told('clipped'), 'clips close on it');
const isParted = () => lobe.status.messages.some(({name}) => name === 'pieces');
await cutArtery(isParted, 'a stroke of the scalpel parts it');
await shot('between_clips');
check(!(await told('bleeding')), 'between clips it does not bleed');
await page.keyboard.press('r');
check(await until(page, () => lobe.lines.tubes.clips.count === 0 && lobe.organ.cutCount === 0), 'begun anew');
const bleeds = () => /It bleeds/.test(document.getElementById('messages').textContent);
await cutArtery(bleeds, 'without clips it bleeds, which a card says');
await shot('bleeding');
await end();
