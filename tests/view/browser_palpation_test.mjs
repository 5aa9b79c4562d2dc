// The page in a headless Chromium: a probe that the mouse leads feels the liver, and a tumour in it.
// Usage: node browser_palpation_test.mjs LOBE_VIEW SCENE MODULES OUT
import {above, openPage, settles, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1200, height: 720});
check(
  await until(page, () => lobe.status?.time > 2.75 && lobe.force === 0),
  'the finger of the scene has pressed, and has left',
);

// Of the second colour: the finger of the scene has the first.
const colour = [159, 214, 92];
const arrowPixels = () =>
  page.evaluate(colour => {
    const data = drawn();
    let count = 0;
    for (let i = 0; i < data.length; i += 4)
      count += colour.every((value, k) => Math.abs(data[i + k] - value) < 30);
    return count;
  }, colour);

// The finger of the scene feels nothing by now.
const shown = () =>
  page.evaluate(() => ({
    probes: lobe.instruments.shown.size - 1, // without the finger
    force: lobe.force,
    plotted: lobe.forcePlot.data.slice(1, 5).reduce((sum, line) => sum + (line.at(-1) ?? 0), 0),
  }));
const turnWheel = async notches => {
  for (let i = 0; i < Math.abs(notches); ++i) await page.mouse.wheel(0, 100 * Math.sign(notches));
};
const isFree = () =>
  until(page, () => lobe.force === 0 && document.getElementById('force').textContent === '0.00 N');

// ---- It presses, comes away, and presses again

check((await arrowPixels()) === 0, 'no arrow is drawn');
await page.keyboard.press('p');
const tumour = await above(page, -0.04, 0);
await page.mouse.move(tumour.x, tumour.y);
await page.mouse.down();
check(await settles(page, 0.1), 'a probe that is pressed in over the tumour feels a force');
const overTumour = await shown();
await shot('tumour');
check((await arrowPixels()) > 100, 'an arrow shows it');
check(Math.abs(overTumour.plotted - overTumour.force) < 0.02, `the plot has it: ${overTumour.plotted} N`);
check(
  await until(
    page,
    () => Math.abs(parseFloat(document.getElementById('force').textContent) - lobe.force) < 0.02,
  ),
  'the panel says it',
);
await turnWheel(8);
check(await isFree(), 'the wheel draws the probe back, and the force is gone');
const away = await shown();
check(away.probes === 1 && away.plotted === 0, 'from the plot as well, while the probe is there');
check((await arrowPixels()) === 0, 'and the arrow');
await shot('away');
await turnWheel(-8);
check(await settles(page, 0.1), 'it presses again');
await page.mouse.up();
check(await isFree(), 'and feels nothing when it is let go');
const gone = await shown();
check(gone.probes === 0 && gone.plotted === 0 && (await arrowPixels()) === 0, 'probe and arrow are gone');

// ---- Beside the tumour, as deep

const beside = await above(page, 0, 0);
await page.mouse.move(beside.x, beside.y);
await page.mouse.down();
check(await settles(page, 0.1), 'beside the tumour it feels a force');
const {force} = await shown();
await shot('beside');
check(
  overTumour.force > 1.3 * force,
  `of ${force.toFixed(2)} N; the tumour is found by its ${overTumour.force.toFixed(2)} N`,
);
await page.mouse.up();
await end();
