// The page in a headless Chromium: a probe that the mouse leads presses on a pre-computed region.
// Usage: node browser_precomputed_test.mjs LOBE_VIEW SCENE MODULES OUT
import {above, openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1000, height: 700});
check(await until(page, () => window.lobe?.status?.time > 0), 'the scene plays');

// The models of the surface's triangles that have a corner within 12 mm of a place of the window.
const modelsAround = ({x, y}) =>
  page.evaluate(
    ([x, y]) => {
      const {triangles, region} = lobe.organ.topology,
        {point} = lobe.organ.hit(lobe.stage.ray(x, y)),
        corner = point.clone(),
        isNear = v => corner.fromArray(lobe.organ.x, 3 * v).distanceTo(point) < 0.012,
        near = [...region].filter((_, t) => [0, 1, 2].some(c => isNear(triangles[3 * t + c])));
      return [...new Set(near)];
    },
    [x, y],
  );

const place = await above(page, -0.06, -0.01);
const models = await modelsAround(place);
check(models.length === 1 && models[0] === 1, `the surface is pre-computed there: ${models}`);
check((await page.evaluate(() => lobe.force)) === 0, 'nothing presses yet');
await page.keyboard.press('p');
await page.mouse.move(place.x, place.y);
await page.mouse.down();
check(await until(page, () => lobe.force > 0.2), 'a probe that is pressed in there feels a force');
await shot('pressed');
const force = await page.evaluate(() => lobe.force);
check(
  await until(
    page,
    () => Math.abs(parseFloat(document.getElementById('force').textContent) - lobe.force) < 0.02,
  ),
  `the panel says it: ${force} N`,
);
await page.mouse.up();
check(await until(page, () => lobe.force === 0), 'and nothing when it is let go');
await end();
