// The page in a headless Chromium whose server is killed, again and again: it must say so within a second,
// and draw nothing any more that came before. LOBE_KILLS sets how often; 20 if it is not set.
// Usage: node browser_loss_test.mjs LOBE_VIEW SCENE MODULES OUT
import {openPage, until} from './page_support.mjs';

const kills = Number(process.env.LOBE_KILLS ?? 20);
const {page, check, shot, end, server, scene, address} = await openPage({width: 960, height: 640});
const {port} = new URL(address);
check(await until(page, () => window.lobe?.frames > 2 && lobe.organ.x), 'the page opens');

// What the page shows, and when: at each change of it, and of the number of frames that were drawn.
await page.evaluate(() => {
  const banner = document.getElementById('banner');
  window.watch = () => {
    window.lost = null;
    new MutationObserver((_, observer) => {
      if (banner.hidden || !/lost/.test(banner.textContent)) return;
      observer.disconnect();
      window.lost = {at: Date.now(), frames: lobe.frames};
    }).observe(banner, {attributes: true, childList: true, characterData: true, subtree: true});
  };
});

const saysAnew = () =>
  page.evaluate(() => /begins anew/.test(document.getElementById('messages').textContent));
let said = 0,
  stayed = 0,
  anew = 0,
  longest = 0;
for (let i = 0; i < kills; ++i) {
  await page.evaluate(() => watch());
  // In any phase of a frame.
  await page.waitForTimeout(37 * (i % 11));
  const killed = Date.now();
  await server.kill();
  await page.waitForFunction(() => window.lost, null, {timeout: 1500, polling: 20}).catch(() => {});
  // Three times until the page has tried several times to connect; then as long as a late picture could come.
  await page.waitForTimeout(i < 3 ? 1500 : 400);
  const {lost, banner, factor, frames} = await page.evaluate(() => ({
    lost: window.lost,
    banner: document.getElementById('banner').textContent,
    factor: document.getElementById('factor').textContent,
    frames: lobe.frames,
  }));
  const after = lost ? lost.at - killed : Infinity;
  longest = Math.max(longest, after);
  said += after <= 1000;
  // And it goes on saying so: no picture of before replaces it.
  stayed += Boolean(lost) && /lost/.test(banner) && factor === 'no connection' && frames === lost.frames;
  if (i === 0) await shot('lost');
  await page.evaluate(() => [...lobe.messages.cards.values()].forEach(card => lobe.messages.remove(card)));
  await server.start(scene, port);
  const isBack = await until(page, n => lobe.frames > n + 2 && lobe.status.controls, frames);
  anew += isBack && (await saysAnew());
  if (i === 0) await shot('anew');
}
check(said === kills, `said within 1 s: ${said} of ${kills}; after ${longest} ms at most`);
check(stayed === kills, `and until the server is back: ${stayed} of ${kills}`);
check(anew === kills, `then the page says that the organ begins anew: ${anew} of ${kills}`);

// ---- The connection alone is lost: the organ does not begin anew

await page.evaluate(() => [...lobe.messages.cards.values()].forEach(card => lobe.messages.remove(card)));
const [frames, time] = await page.evaluate(() => [lobe.frames, lobe.status.time]);
await page.evaluate(() => lobe.connection.socket.close());
check(
  (await until(page, n => lobe.frames > n + 2 && lobe.status.controls, frames)) &&
    (await page.evaluate(
      t => lobe.status.time > t && !/begins anew/.test(document.getElementById('messages').textContent),
      time,
    )),
  'after a connection that is lost the same organ goes on, and the page does not say otherwise',
);

// ---- A server that hangs

await page.evaluate(() => lobe.stage.wake());
process.kill(server.process.pid, 'SIGSTOP');
check(
  await until(page, () => /has sent nothing/.test(document.getElementById('banner').textContent)),
  'a server that hangs is said',
);
process.kill(server.process.pid, 'SIGCONT');
check(await until(page, () => document.getElementById('banner').hidden), 'and that it goes on');
await end();
