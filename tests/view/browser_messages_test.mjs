// Messages of the page in a headless Chromium: counted, few, and beside the organ.
// Usage: node browser_messages_test.mjs LOBE_VIEW SCENE MODULES OUT
import {openPage, until} from './page_support.mjs';

const {page, check, shot, end} = await openPage({width: 1280, height: 720});
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');

// Tissue that is crushed, as a session tells it for 60 frames: one tetrahedron, its figure changes.
const tell = (from, to, tets) =>
  page.evaluate(
    ([from, to, tets]) => {
      const list = [];
      for (let times = from; times <= to; ++times) {
        list.length = 0;
        for (const tet of tets)
          list.push({
            number: 1000 + tet,
            name: 'near_inversion',
            about: `tetrahedron ${tet}`,
            text:
              `tetrahedron ${tet} is at -${(0.02 + 1e-5 * times).toFixed(5)} of its volume, inverted: ` +
              'guard_below, a larger volume_penalty, a smaller load or a slower tool may help',
            times,
          });
        lobe.messages.take(list);
      }
    },
    [from, to, tets],
  );
const cards = () =>
  page.evaluate(() =>
    [...document.querySelectorAll('.message')].map(card => ({
      text: card.querySelector('span').textContent,
      title: card.title,
      count: card.querySelector('b').textContent,
    })),
  );
const settle = () => page.waitForTimeout(400);

// The page's own list is left out meanwhile.
await page.evaluate(() => {
  const {take} = lobe.messages;
  lobe.messages.take = list => (list[0]?.number >= 1000 ? take.call(lobe.messages, list) : undefined);
  lobe.messages.known = new Map();
});
await tell(1, 60, [2898]);
await settle();
let shown = await cards();
check(shown.length === 1, `one tetrahedron, told 60 times with other figures, is one card: ${shown.length}`);
check(
  shown[0].count === '60 ×' && /crushed/.test(shown[0].text) && /0.02060/.test(shown[0].title),
  `in plain words, with its count; the last figure is in its title: ${shown[0].count} ${shown[0].text}`,
);
await page.evaluate(() => document.body.classList.add('details'));
await tell(61, 61, [2898]);
await settle();
check(/0.02061/.test((await cards())[0].text), 'with details, the figure is on it');
await page.evaluate(() => document.body.classList.remove('details'));
await tell(62, 70, [2898, 17, 4, 2000, 311]);
await settle();
shown = await cards();
check(shown.length === 3, `five tetrahedra are three cards: ${shown.length}`);
await page.evaluate(() => lobe.messages.add('/to: "my liver": a name of letters is expected', 'bad'));
await page.evaluate(() => lobe.messages.add('first note'));
await page.evaluate(() => lobe.messages.add('second note'));
await page.evaluate(() => lobe.messages.add('third note'));
shown = await cards();
check(
  shown.length === 3 && shown.some(({text}) => /my liver/.test(text)),
  `a serious one is not pushed out by three notes: ${shown.map(({text}) => text).join(' | ')}`,
);

// ---- Beside the organ, in windows of any size

const longest = 'what cannot be done is said at length, with place, figures and remedy; '.repeat(3);
for (const [width, height] of [
  [1920, 1080],
  [1280, 720],
  [960, 640],
  [1024, 600],
  [800, 600],
  [640, 480],
  [390, 844],
]) {
  await page.setViewportSize({width, height});
  await page.evaluate(text => {
    for (const n of [1, 2, 3]) lobe.messages.add(`${n}: ${text}`, 'bad');
    lobe.home();
  }, longest);
  await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
  const {over, outside, count} = await page.evaluate(() => {
    const point = lobe.stage.target.clone(),
      {array} = lobe.organ.position,
      boxes = [...document.querySelectorAll('.message')].map(card => card.getBoundingClientRect());
    const dock = document.getElementById('dock').getBoundingClientRect();
    let over = 0;
    for (let i = 0; i < array.length; i += 3) {
      const {x, y} = lobe.stage.project(point.fromArray(array, i));
      over += boxes.some(box => x > box.left && x < box.right && y > box.top && y < box.bottom);
    }
    const outside = boxes.filter(
      ({left, right, top, bottom}) =>
        left < 0 || right > innerWidth || top < 0 || bottom > dock.top || bottom - top < 20,
    ).length;
    return {over, outside, count: boxes.length};
  });
  check(
    over === 0 && outside === 0 && count === 3,
    `${width} × ${height}: three cards, none over the organ (${over} points under one) or the ` +
      `buttons (${outside})`,
  );
  await shot(`messages_${width}_${height}`);
}
await end();
