// Walks through the live page as a new user would, and keeps a picture of each step, as
// docs/guide/live_page.md shows them. Usage: node walk.mjs LOBE_VIEW SCENE MODULES FOLDER, or ./dev walk.
// MODULES is a folder in which npm has installed playwright-core; ffmpeg writes the pictures.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {findBrowser, grip, Server, until} from '../../tests/view/page_support.mjs';

const [program, scene, modules, out] = process.argv.slice(2).map(p => path.resolve(p));
const folder = mkdtempSync(path.join(tmpdir(), 'lobe-walk-'));
const server = new Server(program, '--save-to', folder);
const browser = await findBrowser(modules).launch();
const page = await browser.newPage({viewport: {width: 1280, height: 720}});

// What draws here is not a graphics card, but has as much time.
await page.addInitScript(() => {
  const {getParameter} = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.getParameter = function (name) {
    const value = getParameter.call(this, name);
    return typeof value === 'string' && /swiftshader|llvmpipe/i.test(value) ? 'a patient one' : value;
  };
});

const began = Date.now();
const say = what => console.log(`${((Date.now() - began) / 1e3).toFixed(0).padStart(4)} s  ${what}`);
async function need(what, condition, argument) {
  if (!(await until(page, condition, argument))) throw new Error(`never: ${what}`);
  say(what);
}
let steps = 0;
async function picture(name) {
  const png = path.join(folder, `${name}.png`),
    file = path.join(out, `walk_${++steps}_${name}.webp`);
  await page.screenshot({path: png});
  const encoded = spawnSync('ffmpeg', ['-y', '-loglevel', 'error', '-i', png, '-q:v', '72', file], {encoding: 'utf8'});
  if (encoded.status !== 0) throw new Error(`ffmpeg: ${encoded.error?.message ?? encoded.stderr}`);
}
async function drag(from, ...ways) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  let {x, y} = from;
  for (const [dx, dy, count] of ways) {
    for (let i = 1; i <= count; ++i) {
      await page.mouse.move(x + (dx * i) / count, y + (dy * i) / count);
      await page.waitForTimeout(60);
    }
    x += dx;
    y += dy;
  }
}

await page.goto(await server.start(scene));
await need('the page opens', () => window.lobe?.frames > 2 && lobe.organ.x);
await page.evaluate(() => {
  const {stage} = lobe;
  stage.hold({...stage.best, pixels: 1});
});
await picture('opened');
const at = await grip(page);

await drag(at, [40, -70, 14]);
await need('pulled', () => lobe.force > 2);
await page.waitForTimeout(500);
await picture('pulled');
await page.mouse.up();

await page.click('#tool-paint');
await need('painting begins', () => lobe.mode === 'edit' && lobe.status.edit);
const left = await page.evaluate(() => {
  const {stage, organ} = lobe;
  let end = {x: 1e9, y: 0};
  const {array} = organ.position;
  for (let i = 0; i < array.length; i += 3) {
    const place = stage.project(stage.target.clone().fromArray(array, i));
    if (place && place.x < end.x) end = place;
  }
  return end;
});
await page.click('.brush[data-key=tensor-mass]');
for (const y of [-60, -20, 20, 60]) {
  await drag({x: left.x + 40, y: left.y + y}, [130, -10, 10]);
  await page.mouse.up();
}
await need('a region is painted', () => lobe.status.edit.shares[0] > 0.05);
await picture('painted');

await page.click('#propose');
await need('lobe has chosen regions', () => /as fast/.test(document.getElementById('proposal').textContent));
await picture('chosen');
await page.fill('#save-name', 'my_liver');
await page.click('#save');
await need('the scene is saved', () => /Saved/.test(document.getElementById('editor-note').textContent));
await picture('saved');
await page.click('#apply');
await need('what was chosen is simulated', () => lobe.mode === 'live' && lobe.organ.shares[0] + lobe.organ.shares[1] > 0.05);

const again = await grip(page);
await page.selectOption('#colour', 'linear_error');
await drag(again, [40, -60, 14]);
await need('pulled again', () => lobe.force > 2);
await need('what the hybrid costs is estimated', () => /Estimated: .*%/.test(document.getElementById('legend').textContent));
await need('and how fast it could be', () => /could be/.test(document.getElementById('possible').textContent));
await page.waitForTimeout(500);
await picture('gain_and_cost');
await page.mouse.up();
await page.selectOption('#colour', 'tissue');

await page.click('#tool-scalpel');
const tets = await page.evaluate(() => lobe.status.tets);
await drag({x: again.x - 100, y: again.y - 60}, [8, 70, 16]);
await picture('cutting');
await drag({x: again.x - 92, y: again.y + 10}, [0, 40, 8]);
await page.mouse.up();
await need('cut', n => lobe.status.tets > n, tets);
await page.click('#tool-grasp');
await drag({x: again.x - 10, y: again.y}, [50, -30, 14]);
await need('pulled open', () => lobe.force > 1);
await page.waitForTimeout(500);
await picture('opened_cut');
await page.mouse.up();

await page.click('#export');
await need('what the hands did is saved', () => /lobe run/.test(document.getElementById('messages').textContent));
await picture('hands_saved');
const saved = /lobe run (\S+\.json)/.exec(await page.textContent('#messages'))[1];
await browser.close();
say(`ends with ${await server.kill('SIGTERM')}`);

const lobe = path.join(path.dirname(program), 'lobe');
for (const [file, name] of [
  [path.join(folder, 'my_liver.json'), 'painted'],
  [saved, 'hands'],
]) {
  const run = spawnSync(lobe, ['run', file, '-o', path.join(folder, name)], {encoding: 'utf8'});
  say(`lobe run ${path.basename(file)}: ${run.status}`);
  console.log(run.stdout + run.stderr);
  if (run.status !== 0) process.exit(1);
}
if (process.argv.includes('--keep')) console.log(folder);
else rmSync(folder, {recursive: true});
