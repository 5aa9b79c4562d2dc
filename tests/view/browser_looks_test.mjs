// The light window and the details of the page, in a headless Chromium.
// Usage: node browser_looks_test.mjs LOBE_VIEW SCENE MODULES OUT
import {comesTo, openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1280, height: 720});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');

// Reflections take seconds where a graphics card is only imitated: a page that does not need them has none.
check(
  await page.evaluate(() => lobe.stage.look === 'quick' && lobe.stage.scene.environment === null),
  'and has not made what only the fine look reflects',
);

// An organ that sags, is torn in two, and falls: what the camera looks at, and from how far.
const looksAt = await page.evaluate(() => {
  const {stage, organ} = lobe,
    whole = Array.from(organ.x),
    half = whole.length / 6;
  stage.home(whole);
  const at = (from, drop) => {
    stage.follow(whole.map((c, i) => (i % 3 === 2 && i >= 3 * Math.floor(from) ? c - drop * stage.size : c)));
    return [(stage.target.z - stage.middle.z) / stage.size, stage.distance / stage.size];
  };
  return {sagged: at(0, 0.5), torn: at(half, 40), fallen: at(0, 40)};
});
const {sagged, torn, fallen} = looksAt;
check(
  sagged[0] < -0.3 && torn[0] > -0.3 && torn[1] < 1.5 * sagged[1] && fallen.join() === torn.join(),
  `the camera follows what sags and lets go what falls ${JSON.stringify(looksAt)}`,
);

const shown = () =>
  page.evaluate(() =>
    ['possible', 'step', 'tets', 'energy-plot'].filter(id => document.getElementById(id).offsetParent).join(),
  );
check((await shown()) === '', 'at first there are no figures about the simulation');
await page.click('#details');
check((await shown()) === 'possible,step,tets,energy-plot', 'with details there are');

// How light a corner of the picture, and the panel, are.
const light = () =>
  page.evaluate(() => {
    const panel = getComputedStyle(document.getElementById('panel')).backgroundColor.match(/\d+/g);
    return [drawn()[0], Number(panel[0])];
  });
await page.evaluate(() => lobe.home());
const [darkPicture, darkPanel] = await light();
await page.click('#light');
const [lightPicture, lightPanel] = await comesTo(light, seen => Math.min(...seen) > 180);
check(
  darkPicture < 80 && darkPanel < 80 && lightPicture > 180 && lightPanel > 180,
  `a light window: picture ${darkPicture} to ${lightPicture}, panel ${darkPanel} to ${lightPanel} of 255`,
);
const written = await page.evaluate(() =>
  ['.title b', '#tool-cautery', '#colour', '#sim-time'].filter(
    selector => Number(getComputedStyle(document.querySelector(selector)).color.match(/\d+/g)[0]) > 100,
  ),
);
check(written.length === 0, `and dark letters in it ${written}`);
await shot('light');
await page.reload();
await until(page, () => window.lobe?.frames > 2 && lobe.organ.x);
check(
  (await page.isChecked('#light')) && (await page.isChecked('#details')) && (await light())[0] > 180,
  'opened again, the page is as it was chosen',
);
await end();
