// A hook and clips of the page in a headless Chromium.
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
await end();
