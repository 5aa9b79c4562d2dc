// The page in a headless Chromium: two instruments, colours, files that the browser saves, a session that is
// saved and played from the command line, materials, what is held nowhere, and bad luck.
// Usage: node browser_hands_test.mjs LOBE_VIEW SCENE MODULES OUT
import {spawnSync} from 'node:child_process';
import {readFileSync, statSync} from 'node:fs';
import path from 'node:path';
import {begin, drag, grip, until} from './page_support.mjs';

const {program, scene, out, check, finish, server, address, browser} = await begin();
const page = await browser.newPage({viewport: {width: 960, height: 640}, acceptDownloads: true});
const faults = [];
page.setDefaultTimeout(60000);
page.on('pageerror', error => faults.push(error.message));
await page.goto(address);
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');
const at = await grip(page);

// ---- Two instruments

await page.keyboard.down('Shift');
await drag(page, at, 16, -36);
check(await until(page, () => lobe.instruments.shown.size === 1), 'one instrument takes hold');
await page.mouse.up();
await page.keyboard.up('Shift');
await drag(page, {x: at.x - 90, y: at.y}, -10, -20);
check(await until(page, () => lobe.instruments.shown.size === 2), 'it stays, and a second one takes hold');
const [arrows, figures] = await page.evaluate(() => [
  [...lobe.instruments.shown.values()].map(({arrow}) => arrow.userData.material.color.getHexString()),
  lobe.newtons.figures().map(({colour}) => colour.slice(1)),
]);
check(
  new Set(arrows).size === 2 && figures.every(colour => arrows.includes(colour)),
  `their arrows have the colours of their figures in the panel: ${arrows} and ${figures}`,
);
await page.mouse.up();
check(await until(page, () => lobe.instruments.shown.size === 1 && lobe.force > 0), 'which alone is let go');

// ---- A probe

await page.keyboard.press('p');
await drag(page, {x: at.x - 60, y: at.y}, -20, 5);
check(
  await until(page, () =>
    [...lobe.instruments.shown.values()].some(item => item.type === 'probe' && item.force.length() > 0.02),
  ),
  'a probe is pressed on the organ, and feels it',
);
await page.screenshot({path: path.join(out, 'probe.png')});
await page.mouse.up();
await page.keyboard.press('g');
check(await until(page, () => lobe.instruments.shown.size === 1), 'and is taken away');

// ---- Jaws: they straddle the organ's end, close there, and hold it until they are let go

await page.keyboard.press('j');
await drag(page, {x: at.x - 60, y: at.y}, 0, 0);
check(
  await until(page, () => [...lobe.instruments.shown.values()].some(item => item.isOpen)),
  'jaws come',
);
check(
  await until(page, () =>
    [...lobe.instruments.shown.values()].some(item => item.isOpen && item.force.length() > 0.05),
  ),
  'they close on the organ, and feel it',
);
await page.screenshot({path: path.join(out, 'jaws.png')});
await page.keyboard.press('h');
await page.mouse.up();
check(await until(page, () => lobe.hands.held.size === 2), 'they stay where they are');
await drag(page, {x: at.x - 60, y: at.y + 4}, 0, 10);
check(
  await until(page, () => lobe.hands.held.size === 1 && lobe.hands.active?.kind === 'jaws'),
  'are taken up again',
);
await page.mouse.up();
await page.keyboard.press('g');
check(await until(page, () => lobe.instruments.shown.size === 1), 'and open when they are let go');

// ---- Colours

for (const [quantity, word] of [
  ['displacement', /mm/],
  ['von_mises', /kPa/],
  ['volume_ratio', /\d/],
  ['linear_error', /Estimated: .*%/],
]) {
  await page.selectOption('#colour', quantity);
  const isShown = await until(
    page,
    pattern => new RegExp(pattern).test(document.getElementById('legend').textContent),
    word.source,
  );
  const isColoured = await until(page, () => {
    const colours = lobe.organ.colour.array;
    return colours.some((c, i) => Math.abs(c - colours[i % 3]) > 0.05);
  });
  check(isShown && isColoured, `${quantity}: a legend, and more than one colour`);
}
await page.selectOption('#colour', 'tissue');

// ---- The scene's skin

const surfaceTriangles = await page.evaluate(() => lobe.organ.topology.region.length);
await page.keyboard.press('k');
check(
  await until(page, n => lobe.organ.showsSkin() && lobe.organ.topology.region.length > 2 * n, surfaceTriangles),
  'the finer skin of the scene is drawn',
);
await page.screenshot({path: path.join(out, 'skin.png')});
await page.keyboard.press('k');
check(
  await until(page, n => !lobe.organ.showsSkin() && lobe.organ.topology.region.length === n, surfaceTriangles),
  'and the surface of the tetrahedra again',
);

// ---- What the browser saves

const saved = async act => {
  const [download] = await Promise.all([page.waitForEvent('download'), act()]);
  const file = path.join(out, download.suggestedFilename());
  await download.saveAs(file);
  return {file, size: statSync(file).size};
};
const picture = await saved(() => page.keyboard.press('i'));
const png = readFileSync(picture.file);
check(picture.file.endsWith('.png') && png.readUInt32BE(0) === 0x89504e47, 'a picture is saved');
check(png.readUInt32BE(16) >= 960 && picture.size > 20000, `with all pixels, ${picture.size} bytes`);
await page.click('#video');
await drag(page, {x: at.x - 90, y: at.y}, -40, -30);
await page.waitForTimeout(1500);
await page.mouse.up();
const video = await saved(() => page.click('#video'));
check(/\.(webm|mp4)$/.test(video.file) && video.size > 5000, `a video is saved, ${video.size} bytes`);

// ---- Saved, and played from the command line

await page.keyboard.press('r');
check(await until(page, () => lobe.status.time < 5), 'it restarts');
await drag(page, at, 10, -30);
check(await until(page, () => lobe.force > 0.05), 'is pulled');
await page.mouse.up();
await page.keyboard.press(' ');
check(await until(page, () => !lobe.status.running), 'it pauses');
await page.click('#export');
check(
  await until(page, () => /lobe run/.test(document.getElementById('messages').textContent)),
  'what the hands did is saved, and the page says how to play it',
);
const said = /lobe run (\S+\.json)/.exec(await page.textContent('#messages'))[1];
const lobe = path.join(path.dirname(program), 'lobe');
const arguments_ = ['run', said, '-o', path.join(out, 'played'), '--no-pictures'];
const run = spawnSync(lobe, arguments_, {encoding: 'utf8'});
check(run.status === 0, `lobe run plays it ${run.stderr}`);
const chosen = JSON.parse(readFileSync(said.replace('.json', '_gestures.json')));
check(
  chosen.regions.auto?.gestures.length === 1 && chosen.tools.length === 1,
  'beside it is the same with regions that lobe chooses for the grasp',
);
await page.keyboard.press(' ');
check(
  await until(page, () => /could be [\d.]+ ×/.test(document.getElementById('possible').textContent)),
  'the page says how fast the simulation could be',
);

// ---- Materials, and what is held nowhere

await page.keyboard.press('e');
check(await until(page, () => lobe.mode === 'edit' && lobe.status.edit), 'painting begins');
await page.click('#materials summary');
await page.fill('#material-young', '90');
await page.click('#material-add');
check(await until(page, () => lobe.status.edit.materials.length === 2), 'a material is added');
await page.click('.brush[data-key=material-1]');
await drag(page, {x: at.x - 60, y: at.y}, -30, 10);
await page.mouse.up();
check(await until(page, () => lobe.status.edit.materials[1].share > 0), 'and painted');
await page.click('.brush[data-key=precomputed]');
await drag(page, {x: at.x - 30, y: at.y}, -5, 5);
await page.mouse.up();
check(
  await until(page, () => /held nowhere/.test(document.getElementById('unheld').innerText)),
  'a pre-computed part that nothing holds is explained',
);
check(await page.isDisabled('#apply'), 'and cannot be simulated');
await page.screenshot({path: path.join(out, 'unheld.png')});
await page.click('#mend-turning');
check(await until(page, () => document.getElementById('unheld').hidden), 'it may turn by itself');
await page.click('#apply');
check(await until(page, () => lobe.mode === 'live' && lobe.organ.shares[1] > 0), 'and is simulated then');

// ---- Bad luck

const frames = await page.evaluate(() => lobe.frames);
await page.evaluate(() => lobe.connection.socket.send('a'.repeat(100000)));
check(
  await until(page, n => lobe.frames > n + 2 && lobe.status.controls, frames),
  'a message that is too long costs the connection, no more',
);
const again = [scene, '--port', new URL(address).port, '--no-open'];
const other = spawnSync(program, again, {encoding: 'utf8', timeout: 60000});
check(
  other.status !== 0 && /taken/.test(other.stderr) && /--port/.test(other.stderr),
  'a second program on the same port says what to do',
);
check(faults.length === 0, `no script has failed ${faults.join('; ')}`);
await browser.close();
await server.kill();
finish();
