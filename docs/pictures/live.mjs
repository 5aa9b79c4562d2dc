// Records docs/pictures/live.webp in three acts, each of a scene of its own: a liver is pulled, cut, opened,
// and coloured by regions and by stress; a hook peels a gallbladder off its bed; three stitches close a cut.
// Usage: node live.mjs LOBE_VIEW SCENES MODULES OUT.webp, or ./dev film. SCENES is the folder of the scenes,
// MODULES one in which npm has installed playwright-core; ffmpeg writes the picture. The simulation pauses,
// and is asked for its frames: so the speed of the film does not depend on how long the drawing takes.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync, statSync} from 'node:fs';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {findBrowser, grip, Server, until} from '../../tests/view/page_support.mjs';

const [program, scenes, modules, out] = process.argv.slice(2).map(p => path.resolve(p));
const folder = mkdtempSync(path.join(tmpdir(), 'lobe-film-'));
const perSecond = 15,
  width = 960,
  height = 600;
const browser = await findBrowser(modules).launch();
let page, pictures = 0;

/** Plays an act in the page of its scene. */
async function film(scene, act) {
  const server = new Server(program, '--save-to', folder);
  page = await browser.newPage({viewport: {width, height}});
  // What draws here is not a graphics card, but has as much time.
  await page.addInitScript(() => {
    const {getParameter} = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.getParameter = function (name) {
      const value = getParameter.call(this, name);
      return typeof value === 'string' && /swiftshader|llvmpipe/i.test(value) ? 'a patient one' : value;
    };
  });
  await page.goto(await server.start(path.join(scenes, scene)));
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
  await until(page, () => !lobe.status.running && lobe.status.time < 0.05);
  await act();
  await page.close();
  await server.kill();
}

/** Lets the organ move until a time of the simulation [s]. */
const moveOn = until =>
  page.evaluate(async until => {
    while (lobe.status.time < until - 1e-9) {
      const before = lobe.status.time;
      lobe.ask({do: 'step'});
      while (!(lobe.status.time > before)) await new Promise(then => setTimeout(then, 2));
    }
  }, until);

/** A picture after so much time of the simulation [s]. */
async function picture(after = 1 / perSecond) {
  await page.waitForTimeout(20); // until what the hand did is sent
  await moveOn((await page.evaluate(() => lobe.status.time)) + after);
  await page.evaluate(() =>
    new Promise(then =>
      requestAnimationFrame(() => then(lobe.stage.renderer.render(lobe.stage.scene, lobe.stage.camera))),
    ),
  );
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

async function pullAndCut() {
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
}

/** Pictures from a time of the simulation to another [s], `faster` times as fast as it is. */
async function play(from, to, faster) {
  await moveOn(from);
  for (let time = from; time < to - 1e-9; time += faster / perSecond) await picture(faster / perSecond);
}

await film('liver_hands.json', pullAndCut);
await film('cholecystectomy.json', () => play(6, 22, 4));
await film('incision_closed.json', () => play(0.6, 3.6, 1));
await browser.close();

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
