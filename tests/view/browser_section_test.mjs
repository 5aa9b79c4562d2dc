// A section through the organ in the page, in a headless Chromium.
// Usage: node browser_section_test.mjs LOBE_VIEW SCENE MODULES OUT
import {openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1280, height: 720});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');
await page.waitForTimeout(1000);

// Colours of pixels of a row through the middle of the organ, and how many there are.
const row = () =>
  page.evaluate(() => {
    const data = drawn(),
      {width, height} = lobe.stage.canvas,
      {x, y} = lobe.stage.project(lobe.stage.target),
      scale = width / innerWidth,
      colours = [];
    for (let dx = -180; dx <= 20; dx += 10) {
      const at = 4 * (Math.round(y * (height / innerHeight)) * width + Math.round((x + dx) * scale));
      colours.push([...data.subarray(at, at + 3)].join());
    }
    return {kinds: new Set(colours).size, middle: colours[10]};
  });
const whole = await row();
check(whole.kinds > 5, `the skin has many colours: ${whole.kinds} of 21 pixels`);
await page.focus('#stage');
await page.keyboard.press('o');
await page.waitForTimeout(500);
const half = await row();
check(half.kinds === 1, `where the plane meets the organ is one face of one colour: ${half.middle}`);
await shot('half');

// From the side, too. What is not drawn is not taken hold of: what a ray hits lies behind the plane.
const hits = await page.evaluate(() => {
  lobe.stage.turn(130, 0);
  const found = [];
  for (let x = 100; x < 1000; x += 20)
    for (let y = 80; y < 620; y += 20) {
      const hit = lobe.organ.hit(lobe.stage.ray(x, y));
      if (hit) found.push(lobe.section.plane.distanceToPoint(hit.point));
    }
  return found;
});
check(hits.length > 20 && Math.min(...hits) >= 0, `${hits.length} rays hit what is drawn, and nothing else`);

await page.waitForTimeout(500);
await shot('side');
await page.keyboard.press('Home');
await page.locator('#section-depth input').fill('90');
await page.waitForTimeout(300);
const deep = await row();
check(deep.middle !== half.middle, 'deeper, there is no organ in the middle');
await shot('deep');
await page.keyboard.press('o');
await page.waitForTimeout(300);
check((await row()).kinds > 5, 'and without it the skin again');
await shot('without');
await end();
