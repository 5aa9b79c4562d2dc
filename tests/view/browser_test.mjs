// The page in a headless Chromium, as a user would use it: pull, burn, watch, paint, lose the server.
// Usage: node browser_test.mjs LOBE_VIEW SCENE MODULES OUT
import {readFileSync} from 'node:fs';
import path from 'node:path';
import {begin, drag, giveDrawn, grip, until} from './page_support.mjs';

// ---- What is checked

const {scene, out, check, finish, server, address, browser} = await begin();
const faults = [];
async function open(url) {
  const page = await browser.newPage({viewport: {width: 960, height: 640}});
  page.setDefaultTimeout(60000);
  page.setDefaultNavigationTimeout(180000);
  page.on('pageerror', error => faults.push(error.message));
  await giveDrawn(page);
  await page.goto(url);
  return page;
}
const shot = (page, name) => page.screenshot({path: path.join(out, `${name}.png`)});

// The share of pixels that show tissue: redder than they are green or blue.
const redShare = page =>
  page.evaluate(() => {
    const data = drawn();
    let red = 0;
    for (let i = 0; i < data.length; i += 4)
      red += data[i] > 1.3 * data[i + 1] && data[i] > 1.3 * data[i + 2] && data[i] > 25;
    return red / (data.length / 4);
  });

const largestMove = page =>
  page.evaluate(() => {
    const {
      x,
      topology: {rest},
    } = lobe.organ;
    let most = 0;
    for (let i = 0; i < rest.length; i += 3)
      most = Math.max(most, Math.hypot(x[i] - rest[i], x[i + 1] - rest[i + 1], x[i + 2] - rest[i + 2]));
    return most;
  });
// ---- It opens

const page = await open(address);
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens and shows frames');
const share = await redShare(page);
check(share > 0.1, `the organ covers more than a tenth of the pixels: ${(100 * share).toFixed(1)} %`);
check(await page.evaluate(() => lobe.status.controls), 'the first page controls');
await shot(page, 'opened');

// ---- Pull

const at = await grip(page);
await drag(page, at, 20, -30);
check(await until(page, () => lobe.force > 0.05), 'a drag shows a force');
check(
  await until(page, () => /[1-9]/.test(document.getElementById('force').textContent)),
  'the panel shows newtons',
);
const moved = await largestMove(page);
check(moved > 1e-3, `and moves the organ, by ${(1e3 * moved).toFixed(1)} mm`);
await shot(page, 'pulled');
await page.mouse.up();
check(await until(page, () => lobe.force === 0), 'it lets go');

// ---- Burn

await page.keyboard.press('c');
await drag(page, {x: at.x - 60, y: at.y + 10}, -30, 20);
check(await until(page, () => lobe.organ.cutCount > 0), 'the cautery leaves cut faces');
check(await page.evaluate(() => lobe.organ.surface.cut.includes(2)), 'which are charred');
await shot(page, 'burning');
await page.mouse.up();

// ---- Cut

// What the organ's surface encloses at rest: all grains of all tetrahedra, which a scalpel only parts.
const sizes = () =>
  page.evaluate(() => {
    const {triangles, rest} = lobe.organ.surface;
    let volume = 0;
    for (let i = 0; i < triangles.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map(k => rest.subarray(3 * triangles[i + k], 3 * triangles[i + k] + 3));
      volume += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]);
      volume += a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return {tets: lobe.status.tets, cutFaces: lobe.organ.cutCount, volume: volume / 6};
  });
const burnt = await page.evaluate(() => lobe.frames);
check(await until(page, n => lobe.frames > n + 5, burnt), 'the cautery is off');
const whole = await sizes();
await page.keyboard.press('x');
await drag(page, {x: at.x - 20, y: at.y - 40}, 10, 90);
check(
  await until(page, s => lobe.status.tets > s.tets && lobe.organ.cutCount > s.cutFaces, whole),
  'the scalpel parts tetrahedra and opens faces',
);
check(await page.evaluate(() => lobe.organ.surface.cut.includes(1)), 'which are not charred');
await shot(page, 'cutting');
await page.mouse.up();
const parted = await sizes();
const lost = 1 - parted.volume / whole.volume; // a tetrahedron is some 5e-4
check(
  Math.abs(lost) < 1e-5,
  `and takes none away: ${parted.tets - whole.tets} copies, ${lost.toExponential(1)} of the volume lost`,
);

// ---- A spectator, and hand-over

const other = await open(address);
check(await until(other, () => window.lobe?.frames > 1 && lobe.organ.x), 'a second page watches');
check(
  await other.evaluate(() => !lobe.status.controls && lobe.organ.cutCount > 0),
  'it sees what was burnt, and does not control',
);
await drag(other, at, 10, -10);
await other.mouse.up();
const [time, picture] = await page.evaluate(() => [lobe.status.time, lobe.frames]);
await other.evaluate(() => lobe.ask({do: 'restart'}));
check(
  await until(other, () => /another page/.test(document.getElementById('messages').textContent)),
  'a spectator that asks for something is told why not',
);
check(
  (await until(page, n => lobe.frames > n, picture)) &&
    (await page.evaluate(t => lobe.status.time >= t && lobe.organ.cutCount > 0, time)),
  'and nothing is done',
);
await other.click('#banner button');
// It is pressed at once: after 10 s without an answer the other page gets them by itself.
const isAsked = await until(page, () => {
  const yes = [...document.querySelectorAll('#banner button')].find(button => button.textContent === 'Hand over');
  yes?.click();
  return Boolean(yes);
});
check(isAsked, 'the page that controls is asked');
check(
  (await until(other, () => lobe.status.controls)) && (await until(page, () => !lobe.status.controls)),
  'and hands over',
);
await drag(other, at, 15, -15);
check(
  await until(page, () => lobe.instruments.shown.size === 1),
  'the first page sees the instrument of the other',
);
await other.close();
check(
  await until(page, () => lobe.instruments.shown.size === 0 && lobe.force === 0),
  'a page that dies in the middle of a drag lets go',
);
check(await until(page, () => lobe.status.clients === 1), 'the server notices that a page is gone');
check(
  await until(page, () => lobe.status.controls && document.getElementById('banner').hidden),
  'and the instruments go back to the page that is left',
);

// ---- Restart

await page.keyboard.press('r');
check(await until(page, () => lobe.organ.cutCount === 0), 'restart: whole again');

// ---- Painting

await page.keyboard.press('e');
check(await until(page, () => lobe.mode === 'edit' && lobe.status.edit), 'painting begins');
await page.click('.brush[data-key=tensor-mass]');
const [before, linearBefore] = await page.evaluate(() => [lobe.status.edit.shares[0], lobe.organ.shares[0]]);
await drag(page, at, -30, 10);
await page.mouse.up();
check(
  await until(page, b => lobe.status.edit.shares[0] > b, before),
  'a stroke changes the model of tetrahedra',
);
await shot(page, 'painted');
await page.fill('#save-name', 'painted_by_test');
await page.click('#save');
check(
  await until(page, () => /Saved/.test(document.getElementById('editor-note').textContent)),
  'the scene is saved',
);
await page.click('#apply');
check(
  await until(page, b => lobe.mode === 'live' && lobe.organ.shares[0] > b, linearBefore),
  'what was painted is simulated',
);

// ---- The server is killed, and comes back

await server.kill();
check(
  await until(page, () => /lost/.test(document.getElementById('banner').textContent)),
  'the page says that the server is gone',
);
const frames = await page.evaluate(() => lobe.frames);
await server.start(scene, new URL(address).port);
check(await until(page, n => lobe.frames > n && lobe.status.controls, frames), 'and goes on when it is back');
check(
  await until(page, () => /begins anew/.test(document.getElementById('messages').textContent)),
  'saying that the organ begins anew',
);

// ---- Without WebGL, without the token

const blind = await browser.newContext();
await blind.addInitScript(() => {
  HTMLCanvasElement.prototype.getContext = () => null;
});
const blindPage = await blind.newPage();
await blindPage.goto(address);
check(
  /enable-unsafe-swiftshader/.test(await blindPage.textContent('#overlay')),
  'without WebGL the page says what to do',
);
const stranger = await open(address.replace('secret', 'guess'));
check(
  await stranger.waitForSelector('text=lacks the key', {timeout: 60000}).then(
    () => true,
    () => false,
  ),
  'without the token the page says what is missing',
);

check(faults.length === 0, `no script has failed ${faults.join('; ')}`);
await browser.close();
await server.kill();
const saved = JSON.parse(readFileSync(path.join(out, 'painted_by_test.json')));
check(
  saved.regions.some(region => region.model === 'tensor-mass'),
  'the saved scene has the painted region',
);
finish();
