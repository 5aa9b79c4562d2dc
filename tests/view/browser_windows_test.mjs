// The page in small windows, in a headless Chromium: everything can be reached, and the organ is seen whole.
// Usage: node browser_windows_test.mjs LOBE_VIEW SCENE MODULES OUT
import {comesTo, openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 800, height: 600}, {hasTouch: true});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');

// Those of these elements in whose middle something else lies, or nothing, since it is outside.
const covered = selector =>
  page.evaluate(
    selector =>
      [...document.querySelectorAll(selector)]
        .filter(element => element.checkVisibility({visibilityProperty: true}))
        .filter(element => {
          element.scrollIntoView({block: 'nearest'});
          const {left, top, width, height} = element.getBoundingClientRect(),
            found = document.elementFromPoint(left + width / 2, top + height / 2);
          return !found || (!element.contains(found) && !found.contains(element));
        })
        .map(element => element.id || element.textContent),
    selector,
  );
// By how many pixels the organ is beyond the window, the status line or the dock.
const beyond = bottom =>
  page.evaluate(bottom => {
    const point = lobe.stage.target.clone(),
      {array} = lobe.organ.position,
      end = document.getElementById(bottom).getBoundingClientRect().top;
    let most = -Infinity;
    for (let i = 0; i < array.length; i += 3) {
      const {x, y} = lobe.stage.project(point.fromArray(array, i));
      most = Math.max(most, -x, x - innerWidth, 40 - y, y - end);
    }
    return most;
  }, bottom);
const isFree = async (selector, what) => {
  const list = await covered(selector);
  check(list.length === 0, `${what} ${list.join(', ')}`);
};

for (const [width, height] of [
  [800, 600],
  [640, 480],
  [390, 844],
  [844, 390],
]) {
  const size = `${width} × ${height}`;
  await page.setViewportSize({width, height});
  const outside = await comesTo(() => beyond('dock'), pixels => pixels <= 0);
  await isFree('#dock button', `${size}: each button of the dock can be pressed`);
  check(outside <= 0, `all of the organ is seen, ${outside.toFixed(0)} pixels beyond`);
  const status = await page.locator('#status').boundingBox();
  check(
    status.x >= 0 && status.x + status.width <= width,
    `the status line ends within the window, at ${(status.x + status.width).toFixed(0)}`,
  );
  await shot(`${width}`);
  await page.click('#panel-button');
  await isFree('#panel :is(select, label, output)', 'the panel opens, and all of it can be reached');
  await shot(`${width}_panel`);
  await page.click('#panel-button');
  check(!(await page.isVisible('#panel')), 'and it closes');
}

await page.setViewportSize({width: 390, height: 844});
await page.click('#tool-paint');
check(await until(page, () => lobe.mode === 'edit'), 'a phone paints');
const above = await comesTo(() => beyond('editor'), pixels => pixels <= 0);
await isFree('#editor :is(button, select)', 'each button of the editor can be pressed');
check(above <= 0, 'and all of the organ is above it');
const [hint, finish] = await Promise.all(
  ['#hint', '#editor .finish'].map(selector => page.locator(selector).boundingBox()),
);
check(
  !(await page.isVisible('#hint')) || hint.y + hint.height <= finish.y || hint.y >= finish.y + finish.height,
  'the hint covers none of its buttons',
);
await shot('paint');
await end();
