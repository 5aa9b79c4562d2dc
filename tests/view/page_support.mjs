// The page in a headless Chromium, for its tests and measurements. Status 77: there is no Chromium, or no
// playwright-core, which npm installs into the folder `modules`.
import {spawn} from 'node:child_process';
import {createRequire} from 'node:module';
import {existsSync, mkdirSync, rmSync} from 'node:fs';
import path from 'node:path';

export function findBrowser(modules) {
  const places = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  const executablePath = places.find(existsSync);
  let playwright;
  try {
    playwright = createRequire(path.join(modules, 'node_modules', 'x.js'))('playwright-core');
  } catch {
    /* said below */
  }
  if (!executablePath || !playwright) {
    console.log('skipped: needs Chromium and playwright-core; ./dev test installs them');
    process.exit(77);
  }
  const software = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'];
  return {launch: (args = software) => playwright.chromium.launch({executablePath, args})};
}

/** lobe-view, which ends with the test. */
export class Server {
  constructor(program, ...options) {
    this.program = program;
    this.options = options;
    process.on('exit', () => this.process?.kill('SIGKILL'));
  }

  /** @returns {Promise<string>} the address of its page */
  start(scene, port = 0) {
    const fixed = ['--port', String(port), '--token', 'secret', '--no-open'];
    this.process = spawn(this.program, [scene, ...fixed, ...this.options]);
    return new Promise((resolve, reject) => {
      this.process.stdout.on('data', data => {
        const found = /http:\/\/\S+/.exec(String(data));
        if (found) resolve(found[0]);
      });
      this.process.stderr.on('data', data => process.stderr.write(data));
      this.process.on('exit', code => reject(new Error(`lobe-view ended with ${code}`)));
    });
  }

  kill(signal = 'SIGKILL') {
    return new Promise(resolve => {
      this.process.removeAllListeners('exit');
      this.process.on('exit', resolve);
      this.process.kill(signal);
    });
  }
}

export const until = (page, condition, argument) =>
  page.waitForFunction(condition, argument, {timeout: 60000, polling: 50}).then(
    () => true,
    () => false,
  );

/** Looks until what it sees is right, for three seconds at most; returns what it saw last. */
export async function comesTo(look, isRight) {
  const begun = Date.now();
  for (;;) {
    const seen = await look();
    if (isRight(seen) || Date.now() > begun + 3000) return seen;
    await new Promise(done => setTimeout(done, 40));
  }
}

/** Until the force above so much [N] has changed by less than 10 mN for 0.3 s of the simulation. */
export const settles = async (page, above) => {
  await page.evaluate(() => (window.last = null));
  return until(
    page,
    above => {
      const {time} = lobe.status;
      if (!window.last || Math.abs(lobe.force - window.last.force) > 0.01)
        window.last = {time, force: lobe.force};
      return lobe.force > above && time > window.last.time + 0.3;
    },
    above,
  );
};

/** `drawn()` in the page: red, green, blue and opacity of each pixel of the organ's picture. */
export const giveDrawn = page =>
  page.addInitScript(() => {
    window.drawn = () => {
      lobe.stage.draw();
      const from = lobe.stage.canvas,
        canvas = new OffscreenCanvas(from.width, from.height),
        context = canvas.getContext('2d');
      context.drawImage(from, 0, 0);
      return context.getImageData(0, 0, canvas.width, canvas.height).data;
    };
  });

/**
 * Plays the scene of the command line, LOBE_VIEW SCENE MODULES OUT, with these options of lobe-view, and
 * starts a browser.
 */
export async function begin(...options) {
  const [program, scene, modules, out] = process.argv.slice(2).map(p => path.resolve(p));
  const browserToLaunch = findBrowser(modules);
  rmSync(out, {recursive: true, force: true});
  mkdirSync(out, {recursive: true});
  const {check, finish} = new Checks();
  const server = new Server(program, '--save-to', out, ...options);
  const address = await server.start(scene);
  const browser = await browserToLaunch.launch();
  return {program, scene, out, check, finish, server, address, browser};
}

/** The same, and opens its page. */
export async function openPage(viewport, options = {}) {
  const {scene, out, check, finish, server, address, browser} = await begin();
  const page = await browser.newPage({viewport, ...options});
  const faults = [];
  page.setDefaultTimeout(60000);
  page.setDefaultNavigationTimeout(180000);
  page.on('pageerror', error => faults.push(error.message));
  await giveDrawn(page);
  await page.goto(address);
  const shot = name => page.screenshot({path: path.join(out, `${name}.png`)});
  const end = async () => {
    check(faults.length === 0, `no script has failed ${faults.join('; ')}`);
    await browser.close();
    await server.kill('SIGTERM');
    finish();
  };
  return {page, check, shot, end, server, scene, address, out};
}

// Where on the window a point of the organ's surface is that is free and faces the viewer: 50 pixels from its
// right end.
export const grip = page =>
  page.evaluate(() => {
    const {stage, organ} = lobe,
      {array} = organ.position,
      point = stage.target.clone();
    let end = {x: -1, y: 0};
    for (let i = 0; i < array.length; i += 3) {
      const place = stage.project(point.fromArray(array, i));
      if (place && place.x > end.x) end = place;
    }
    for (let dy = 0; dy < 60; dy += 4)
      for (const y of [end.y + dy, end.y - dy])
        if (organ.hit(stage.ray(end.x - 50, y))) return {x: Math.round(end.x - 50), y: Math.round(y)};
    return null;
  });

// Where on the window the surface is above a place (x, y) [m].
export const above = (page, x, y) =>
  page.evaluate(
    ([x, y]) => {
      const {array} = lobe.organ.position,
        point = lobe.stage.target.clone(),
        top = point.clone().set(0, 0, -1);
      for (let i = 0; i < array.length; i += 3) {
        point.fromArray(array, i);
        if (Math.hypot(point.x - x, point.y - y) < 0.008 && point.z > top.z) top.copy(point);
      }
      return lobe.stage.project(top);
    },
    [x, y],
  );

export async function drag(page, from, dx, dy) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 1; i <= 8; ++i) await page.mouse.move(from.x + (dx * i) / 8, from.y + (dy * i) / 8);
}

export class Checks {
  failures = 0;
  started = Date.now();
  seconds = () => ((Date.now() - this.started) / 1e3).toFixed(1);

  check = (condition, what) => {
    console.log(`${condition ? 'ok    ' : 'FAILED'} ${what} (${this.seconds()} s)`);
    if (!condition) ++this.failures;
  };

  finish = () => {
    console.log(`${this.failures} failures, ${this.seconds()} s`);
    process.exit(this.failures ? 1 : 0);
  };
}
