// The ladder of quality without a browser: machines of several speeds draw pictures, each step of which costs
// what it costs there. Usage: node quality_test.mjs
import {firstQuick, ladder, Quality} from '../../view/page/quality.js';
import {Checks} from './page_support.mjs';

const {check, finish} = new Checks();
const steps = ladder(2);

// Deterministic noise from 0 to 1.
function noise(seed) {
  let state = seed;
  return () => {
    state = (1664525 * state + 1013904223) % 2 ** 32;
    return state / 2 ** 32;
  };
}

// Draws pictures for some seconds, at most 60 a second; returns how often the step was changed.
function draw(quality, clock, seconds, costOf, random = noise(1)) {
  let changes = 0;
  for (const end = clock.now + 1e3 * seconds; clock.now < end; ) {
    const took = costOf(quality.at) * (0.85 + 0.3 * random()) + (random() < 0.02 ? 60 : 0);
    clock.now += Math.max(16, took);
    changes += quality.drew(took, clock.now);
    clock.at[quality.at] = (clock.at[quality.at] ?? 0) + 1;
  }
  return changes;
}
const clock = () => ({now: 1000, at: []}); // and how many pictures were drawn at each step

{
  const quality = new Quality(steps, 0);
  check(draw(quality, clock(), 60, () => 3) === 0 && quality.at === 0, 'a fast machine stays at the best');
}
{
  const quality = new Quality(steps, 0),
    time = clock();
  draw(quality, time, 6, () => 200);
  check(quality.at === steps.length - 1, 'one that is far too slow is at the bottom within six seconds');
  check(draw(quality, time, 60, () => 200) === 0, 'and stays there');
}
{
  const quality = new Quality(steps, firstQuick(steps)),
    time = clock();
  draw(quality, time, 120, () => 2);
  check(quality.at === 0, 'one that begins too low climbs to the top');
}
{
  // Each step takes two thirds of the one above: 60, 40, 27, 18 …
  const quality = new Quality(steps, 0),
    time = clock();
  draw(quality, time, 5, at => 60 * 0.667 ** at);
  check(quality.at === 3, `it goes down as far as it must: ${quality.at}`);
  check(draw(quality, time, 300, at => 60 * 0.667 ** at) === 0, 'between the limits nothing changes');
}
{
  // A step takes 30 ms and the next one 8: neither is right.
  const quality = new Quality(steps, 0),
    time = clock();
  draw(quality, time, 30, at => (at < 2 ? 30 : 8));
  const changes = draw(quality, time, 600, at => (at < 2 ? 30 : 8));
  check(changes <= 20, `where neither step is right, it tries less and less often: ${changes} changes in ten minutes`);
  check(time.at[2] > 50 * time.at[1], 'and is nearly always at the one that keeps up');
}
{
  const quality = new Quality(steps, 0),
    time = clock();
  draw(quality, time, 10, () => 50);
  const low = quality.at;
  draw(quality, time, 90, () => 4);
  check(low > 3 && quality.at === 0, 'when something else stops using the machine, it gets better again');
}
{
  const quality = new Quality(steps, 0);
  let now = 0,
    changes = 0;
  for (let i = 0; i < 500; ++i) changes += quality.drew(i % 9 === 0 ? 400 : 5, (now += 16));
  check(changes === 0, 'single pictures that take long change nothing');
}
{
  const cost = ({look, shadow, every, pixels, levels, hasShadow}) =>
    pixels ** 2 * (look === 'fine' ? 8 : 1) + shadow ** 2 / every / 1e6 + 4 ** levels / 100 + hasShadow / 100;
  for (const most of [0.75, 1, 1.5, 2, 3]) {
    const all = ladder(most),
      falls = all.every((step, i) => i === 0 || cost(step) < cost(all[i - 1]));
    check(
      falls && all[0].pixels === most && !all[0].words,
      `with ${most} pixels per pixel each step is cheaper than the one above`,
    );
    check(all.slice(1).every(step => step.words), 'and each but the first says what it saves');
  }
}
finish();
