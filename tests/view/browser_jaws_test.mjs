// The page in a headless Chromium: a hand picks up a lobe that has been cut off and has fallen, and lets it
// fall again.
// Usage: node browser_jaws_test.mjs LOBE_VIEW SCENE MODULES OUT
import {openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1200, height: 720});
check(await until(page, () => window.lobe?.status?.time > 1.8), 'the lobe has fallen');

// The middle of the lobe, which lay beyond x = 0.03 m [m].
await page.evaluate(() => {
  window.middleOfLobe = () => {
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
    return middle.divideScalar(count);
  };
});
const heightOfLobe = () => page.evaluate(() => middleOfLobe().z);

// Until so much time has been simulated, however long that takes.
const simulated = async seconds => {
  const time = await page.evaluate(() => lobe.status.time);
  check(await until(page, end => lobe.status.time >= end, time + seconds), `${seconds} s are simulated`);
};

// ---- It is picked up

const before = await page.evaluate(() => lobe.stage.project(middleOfLobe()));
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
const gripped = await heightOfLobe();
for (let i = 1; i <= 25; ++i) {
  await page.mouse.move(before.x, before.y - 5 * i);
  await until(page, time => lobe.status.time > time + 0.06, await page.evaluate(() => lobe.status.time));
}
await simulated(1.5);
const lifted = await heightOfLobe();
await shot('lifted');
check(lifted - gripped > 0.02, `the lobe is lifted by ${lifted - gripped} m`);

// ---- And let go

await page.mouse.up();
await simulated(1.5);
const fallen = await heightOfLobe();
check(fallen < lifted - 0.02, `and falls by ${lifted - fallen} m when it is let go`);
await end();
