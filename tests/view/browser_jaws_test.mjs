// The page in a headless Chromium: a hand picks up a lobe that has been cut off and has fallen, and lets it
// fall again.
// Usage: node browser_jaws_test.mjs LOBE_VIEW SCENE MODULES OUT
import {openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1200, height: 720});
check(await until(page, () => window.lobe?.status?.time > 1.8), 'the lobe has fallen');

// The middle of the lobe, which lay beyond x = 0.03 m: in metres, and where it is on the window.
const lobe = () =>
  page.evaluate(() => {
    const {rest} = lobe.organ.topology,
      {x} = lobe.organ,
      middle = lobe.stage.target.clone().set(0, 0, 0),
      point = middle.clone();
    let count = 0;
    for (let i = 0; i < rest.length; i += 3)
      if (rest[i] > 0.03) {
        middle.add(point.fromArray(x, i));
        ++count;
      }
    middle.divideScalar(count);
    return {height: middle.z, ...lobe.stage.project(middle)};
  });
const before = await lobe();
await page.keyboard.press('j');
await page.mouse.move(before.x, before.y);
await page.mouse.down();
check(await until(page, () => lobe.hands.active?.closes), 'jaws come, and close');
check(await until(page, () => lobe.force > 0.5), 'until they feel the lobe');
// They close by 20 mm/s, from 100 mm apart.
check(
  await until(page, () => {
    const {time} = lobe.status,
      opening = [...lobe.instruments.shown.values()].find(item => item.isOpen).was.at(-1);
    if (opening !== window.last?.opening) window.last = {time, opening};
    return opening < 0.09 && time > window.last.time + 0.3;
  }),
  'and rest',
);
const gripped = await lobe();
for (let i = 1; i <= 25; ++i) {
  await page.mouse.move(before.x, before.y - 5 * i);
  await page.waitForTimeout(60);
}
await page.waitForTimeout(1500);
const lifted = await lobe();
await shot('lifted');
check(lifted.height - gripped.height > 0.02, `the lobe is lifted by ${lifted.height - gripped.height} m`);
await page.mouse.up();
await page.waitForTimeout(1500);
const fallen = await lobe();
check(
  fallen.height < lifted.height - 0.02,
  `and falls by ${lifted.height - fallen.height} m when it is let go`,
);
await end();
