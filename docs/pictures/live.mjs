// Records docs/pictures/live.webp: the liver in the page is pulled, cut, opened, and coloured by regions and
// by stress. Usage: node live.mjs LOBE_VIEW SCENE MODULES OUT.webp, or ./dev film. MODULES is a folder in
// which npm has installed playwright-core; ffmpeg writes the picture. The simulation pauses, and is asked for
// eight frames of 1/120 s per picture: so the film is in real time however long the drawing takes.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {findBrowser, grip, Server, until} from '../../tests/view/page_support.mjs';

const [program, scene, modules, out] = process.argv.slice(2).map(p => path.resolve(p));
const folder = mkdtempSync(path.join(tmpdir(), 'lobe-film-'));
const perSecond = 15,
  framesPerPicture = 8,
  width = 960,
  height = 600;

const server = new Server(program, '--save-to', folder);
const browser = await findBrowser(modules).launch();
const page = await browser.newPage({viewport: {width, height}});

// What draws here is not a graphics card, but has as much time.
await page.addInitScript(() => {
  const {getParameter} = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.getParameter = function (name) {
    const value = getParameter.call(this, name);
    return typeof value === 'string' && /swiftshader|llvmpipe/i.test(value) ? 'a patient one' : value;
  };
});
await page.goto(await server.start(scene));
await until(page, () => window.lobe?.frames > 2 && lobe.organ.x);
await page.evaluate(async () => {
  const {stage} = lobe;
  stage.hold({...stage.best, pixels: 1});
  lobe.ask({do: 'pause', on: true});
  lobe.ask({do: 'restart'});
  // which says that it is paused between two pictures
  document.getElementById('factor').style.display = 'none';
  stage.draw = () => {
    stage.isOld = false; // only when a picture is taken
  };
});
await until(page, () => !lobe.status.running && lobe.status.time < 0.01);

let pictures = 0;
async function picture(frames = framesPerPicture) {
  await page.waitForTimeout(20); // until what the hand did is sent
  await page.evaluate(async count => {
    for (let i = 0; i < count; ++i) {
      const before = lobe.status.time;
      lobe.ask({do: 'step'});
      while (!(lobe.status.time > before)) await new Promise(then => setTimeout(then, 2));
    }
    await new Promise(then => requestAnimationFrame(() => then(lobe.stage.renderer.render(lobe.stage.scene, lobe.stage.camera))));
  }, frames);
  await page.screenshot({path: path.join(folder, `${String(pictures++).padStart(4, '0')}.png`)});
}
const ease = t => t * t * (3 - 2 * t);
async function lead(from, to, count) {
  for (let i = 1; i <= count; ++i) {
    const t = ease(i / count);
    await page.mouse.move(from.x + t * (to.x - from.x), from.y + t * (to.y - from.y));
    await picture();
  }
}
async function rest(count) {
  for (let i = 0; i < count; ++i) await picture();
}
async function stroke(from, ...rest_) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (const [dx, dy, count] of rest_) {
    const to = {x: from.x + dx, y: from.y + dy};
    await lead(from, to, count);
    from = to;
  }
}

const at = await grip(page);
// Pulled, and let go.
await rest(4);
await stroke(at, [45, -70, 16], [15, 40, 12]);
await rest(3);
await page.mouse.up();
await rest(10);
// Cut, across the left lobe.
await page.keyboard.press('x');
await stroke({x: at.x - 110, y: at.y - 48}, [8, 100, 28]);
await page.mouse.up();
await page.keyboard.press('g');
await rest(3);
// Opened.
await stroke({x: at.x - 20, y: at.y}, [60, -25, 20], [20, -10, 8]);
for (const quantity of ['region', 'von_mises']) {
  await page.selectOption('#colour', quantity);
  await page.waitForTimeout(400); // until it has been found
  await rest(4);
  await page.waitForTimeout(400);
  await rest(12);
}
await page.mouse.up();
await rest(14);
await browser.close();
await server.kill();

const encoded = spawnSync(
  'ffmpeg',
  ['-y', '-loglevel', 'error', '-framerate', String(perSecond), '-i', path.join(folder, '%04d.png')].concat(
    ['-vf', 'scale=800:-1:flags=lanczos', '-c:v', 'libwebp_anim', '-q:v', '62', '-compression_level', '6'],
    ['-loop', '0', out],
  ),
  {encoding: 'utf8'},
);
if (encoded.status !== 0) throw new Error(`ffmpeg: ${encoded.error?.message ?? encoded.stderr}`);
if (process.argv.includes('--keep')) console.log(folder);
else rmSync(folder, {recursive: true});
console.log(`${pictures} pictures, ${(statSync(out).size / 1e6).toFixed(2)} MB: ${out}`);
