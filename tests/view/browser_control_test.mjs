// Two pages, and a third one, in a headless Chromium: who holds the instruments, and who gets them.
// Usage: node browser_control_test.mjs LOBE_VIEW SCENE MODULES OUT
import path from 'node:path';
import {begin, drag, grip, until} from './page_support.mjs';

// Of the server with a page that does not answer [s]: long enough for a page to say that it was asked.
const patience = 3;
const {out, check, finish, server, address, browser} = await begin('--patience', String(patience));
const faults = [];
async function open() {
  const page = await browser.newPage({viewport: {width: 960, height: 640}});
  page.setDefaultTimeout(60000);
  page.setDefaultNavigationTimeout(180000);
  page.on('pageerror', error => faults.push(error.message));
  await page.goto(address);
  await until(page, () => window.lobe?.frames > 1 && lobe.organ.x);
  return page;
}
const says = (page, what) =>
  until(page, text => document.getElementById('banner').textContent.includes(text), what);
const shot = (page, name) => page.screenshot({path: path.join(out, `${name}.png`)});

const teacher = await open(),
  pupil = await open();
check(await says(pupil, 'another page holds the instruments'), 'the second page is told that it watches');
check(
  await pupil.evaluate(() => getComputedStyle(document.getElementById('tool-scalpel')).opacity < 0.5),
  'its instruments are greyed',
);
await shot(pupil, 'watching');

// ---- A hand that holds is robbed by nobody

const at = await grip(teacher);
await drag(teacher, at, 20, -30);
check(await until(teacher, () => lobe.force > 0.05), 'the first page pulls');
await pupil.click('#banner button');
check(await says(teacher, 'Another page asks'), 'the second one asks, and the first one sees it');
check(await says(pupil, 'You have asked'), 'the second one sees that it has asked');
await shot(teacher, 'asked');
await teacher.waitForTimeout(1500 * patience);
check(
  await teacher.evaluate(() => lobe.status.controls && lobe.force > 0.05 && lobe.hands.active !== null),
  `after ${1.5 * patience} s without an answer the first one holds on, as it has something in its hand`,
);

// ---- It refuses

await teacher.evaluate(() => [...document.querySelectorAll('#banner button')].at(-1).click());
check(await says(pupil, 'You are watching'), 'it keeps them, and nobody asks any more');
check(
  await until(pupil, () => /keeps them/.test(document.getElementById('messages').textContent)),
  'the one that asked is told',
);
check(
  await until(teacher, () => document.getElementById('banner').hidden && lobe.force > 0.05),
  'and the pull goes on',
);
await teacher.mouse.up();

// ---- It leaves: the instruments go to the page that is left

await teacher.close();
check(await until(pupil, () => lobe.status.controls), 'when it leaves, the page that is left has them');
check(
  await until(pupil, () => document.getElementById('banner').hidden),
  'and is no longer told that another one has',
);
check(
  await pupil.evaluate(() => getComputedStyle(document.getElementById('tool-scalpel')).opacity > 0.9),
  'its instruments are not greyed',
);
await drag(pupil, await grip(pupil), 20, -30);
check(await until(pupil, () => lobe.force > 0.05), 'and pull');
await pupil.mouse.up();

// ---- One that holds nothing and does not answer loses them

const third = await open();
await until(pupil, () => lobe.force === 0);
await third.click('#banner button');
check(await says(pupil, 'asks'), 'a third page asks one that holds nothing');
check(await until(third, () => lobe.status.controls), 'which does not answer, and loses them');
check(await says(pupil, 'another page holds'), 'and is told so');

// ---- Several may be left that never had them: then nobody has

const said = await pupil.evaluate(() => {
  lobe.status = {...lobe.status, controls: false, controlled: false};
  lobe.showBanner();
  return document.getElementById('banner').innerText;
});
check(/Nobody holds.*Take them/s.test(said), `the page says so, and offers them: ${said.replace('\n', ' ')}`);

check(faults.length === 0, `no script has failed ${faults.join('; ')}`);
await browser.close();
await server.kill();
finish();
