// How long it takes from the hand to the picture, and what the page costs: a drag of some seconds in a
// headless Chromium without a graphics card. Usage: node page.mjs LOBE_VIEW SCENE MODULES OUT.csv [SECONDS]
// MODULES is a folder in which npm has installed playwright-core.
import {readdirSync, readFileSync, writeFileSync} from 'node:fs';
import path from 'node:path';
import {findBrowser, grip, Server, until} from '../tests/view/page_support.mjs';

const [program, scene, modules, out] = process.argv.slice(2, 6).map(p => path.resolve(p));
const seconds = Number(process.argv[6] ?? 10);
const server = new Server(program, ...process.argv.slice(7));
const browsers = {
  'all by software': ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
  'WebGL by software': ['--enable-unsafe-swiftshader', '--no-sandbox'],
};

// Processor time by process, of the server by thread [ms].
const jiffies = file => {
  const fields = readFileSync(file, 'utf8').split(') ')[1].split(' ');
  return 10 * (Number(fields[11]) + Number(fields[12]));
};
function kind(pid) {
  const command = readFileSync(`/proc/${pid}/cmdline`, 'utf8');
  return /chrom/.test(command) ? /--type=([a-z-]+)/.exec(command)?.[1] ?? 'browser' : null;
}
function processorTime() {
  const spent = {};
  for (const pid of readdirSync('/proc').filter(name => /^\d+$/.test(name))) {
    try {
      const which = kind(pid);
      if (which) spent[which] = (spent[which] ?? 0) + jiffies(`/proc/${pid}/stat`);
    } catch {
      /* it has ended */
    }
  }
  const tasks = `/proc/${server.process.pid}/task`,
    threads = readdirSync(tasks).map(task => jiffies(`${tasks}/${task}/stat`));
  spent.server = threads.reduce((sum, t) => sum + t, 0);
  spent.simulation = Math.max(...threads);
  return spent;
}

const quantile = (values, share) => {
  const sorted = values.toSorted((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? NaN;
};

async function play(page, at) {
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  await page.waitForTimeout(2000); // until it has found how many pixels it can draw
  const start = await page.evaluate(() => {
    lobe.connection.trips.length = 0;
    return {time: lobe.status.time, frames: lobe.frames, pictures: lobe.stage.pictures};
  });
  const before = processorTime(),
    began = performance.now();
  for (let i = 0; performance.now() - began < 1e3 * seconds; ++i) {
    await page.mouse.move(at.x + 40 * Math.sin(i / 12), at.y - 20 + 30 * Math.cos(i / 12));
    await page.waitForTimeout(8);
  }
  const wall = performance.now() - began,
    after = processorTime();
  if (!(await page.evaluate(() => lobe.force > 0))) throw new Error('the hand holds nothing');
  const end = await page.evaluate(() => ({
    trips: lobe.connection.trips,
    time: lobe.status.time,
    frames: lobe.frames,
    pictures: lobe.stage.pictures,
    drawing: lobe.stage.slow,
    pixels: lobe.stage.pixelRatio,
    possible: lobe.status.possible,
  }));
  await page.mouse.up();
  return {start, end, spent: key => (after[key] ?? 0) - (before[key] ?? 0), wall};
}

// Seconds of work per simulated second while the page only looks, and while others send a thousand requests a
// second that are none, and take no frames.
async function workUnderFire(browser, address, page) {
  const work = async () => {
    const found = [];
    for (let i = 0; i < 20; ++i) {
      await page.waitForTimeout(250);
      found.push(await page.evaluate(() => 1 / lobe.status.possible));
    }
    return quantile(found, 0.5);
  };
  const before = await work();
  const hostile = await browser.newPage();
  await hostile.goto(new URL('icon.svg', address).href); // of the same origin, and draws nothing
  await hostile.evaluate(url => {
    const open = () => Object.assign(new WebSocket(url), {onclose: () => setTimeout(open, 100)});
    const deaf = open(),
      loud = open();
    let sent = 0;
    setInterval(() => {
      for (let i = 0; i < 10; ++i, ++sent)
        if (loud.readyState === 1) loud.send(sent % 2 ? '{"do": "restart"}' : '{"do": "nonsense", "number": 1e999');
    }, 10);
    window.kept = [deaf, loud];
  }, `ws://${new URL(address).host}/live${new URL(address).search}`);
  await page.waitForTimeout(1000);
  const during = await work();
  await hostile.close();
  return during / before;
}

function row(name, {start, end, spent, wall}) {
  const pictures = end.pictures - start.pictures,
    simulated = end.time - start.time,
    stage = key => end.trips.map(trip => trip[key]);
  const total = end.trips.map(trip => trip.hand + trip.server + trip.draw);
  const load = Number(readFileSync('/proc/loadavg', 'utf8').split(' ')[0]);
  return {
    browser: name,
    load,
    poses: total.length,
    pictures_per_s: (1e3 * pictures) / wall,
    p50_ms: quantile(total, 0.5),
    p95_ms: quantile(total, 0.95),
    hand_p50_ms: quantile(stage('hand'), 0.5),
    server_p50_ms: quantile(stage('server'), 0.5),
    server_p95_ms: quantile(stage('server'), 0.95),
    draw_p50_ms: quantile(stage('draw'), 0.5),
    draw_p95_ms: quantile(stage('draw'), 0.95),
    pixel_ratio: end.pixels,
    card_cpu_per_picture_ms: spent('gpu-process') / pictures,
    page_cpu_per_picture_ms: spent('renderer') / pictures,
    real_time_factor: (1e3 * simulated) / wall,
    possible_factor: end.possible,
    simulated_per_simulation_cpu: (1e3 * simulated) / spent('simulation'),
    simulated_per_server_cpu: (1e3 * simulated) / spent('server'),
  };
}

const rows = [];
for (const [name, args] of Object.entries(browsers)) {
  const browser = await findBrowser(modules).launch(args);
  const page = await browser.newPage({viewport: {width: 960, height: 640}});
  const address = await server.start(scene);
  await page.goto(address);
  if (!(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x)))
    throw new Error('the page shows nothing');
  rows.push(row(name, await play(page, await grip(page))));
  rows.at(-1).work_under_fire = await workUnderFire(browser, address, page);
  await browser.close();
  await server.kill();
  for (const [key, value] of Object.entries(rows.at(-1)))
    console.log(`${key.padEnd(30)} ${typeof value === 'number' ? value.toPrecision(4) : value}`);
}
const cell = value => (typeof value === 'number' ? String(Number(value.toPrecision(4))) : value);
const lines = [Object.keys(rows[0]).join(','), ...rows.map(r => Object.values(r).map(cell).join(','))];
writeFileSync(out, lines.join('\n') + '\n');
