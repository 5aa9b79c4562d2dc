// What covers the page: help, and why there is nothing to see.

const overlay = document.getElementById('overlay');

function show(html) {
  overlay.innerHTML = `<div class="card">${html}</div>`;
  overlay.hidden = false;
}

export const hideOverlay = () => {
  overlay.hidden = true;
};
export const overlayIsShown = () => !overlay.hidden;

export function showHelp() {
  const rows = [
    ['Left drag on the organ', 'pull it; with the cautery, burn along; with the scalpel, cut; with the probe, press; with the jaws, grip; with the hook, lift; with the clip, close it on what is narrow; with the brush, paint'],
    ['Wheel while pulling, cutting or pressing', 'nearer and farther, deeper'],
    ['Jaws', 'one above the other, as you look: close where they come to rest, grip until you let go'],
    ['Hook', 'begin beside an edge: what lies on its wire is lifted; D, or the right button too, burns while it is pressed'],
    ['Clip', 'closes when you let go, and stays; Esc takes the applier away before that'],
    [
      'Stitch',
      'click in and click out, as often as you like; drag, or turn the wheel then, to draw the thread up; ' +
        'double click ties the first place to the last; Shift and a click cuts a thread',
    ],
    ['Shift while letting go, or H', 'this instrument stays where it is: take a second one; drag it later'],
    ['Two fingers', 'on the organ: two instruments; beside it: zoom and shift the camera'],
    ['Double click, or Esc', 'all instruments let go; with needle and thread only Esc does'],
    ['Right drag · wheel · middle drag', 'turn · zoom · shift the camera'],
    ['Arrows · + − · Shift with arrows', 'the same by keys; Home: from the front, all of the organ'],
    [
      'G · C · X · P · J · U · A · N · E',
      'grasp · cautery · scalpel · probe · jaws · hook · clip · stitch · parts of the organ',
    ],
    ['T, then left drag', 'measure a distance; Esc takes the tape away'],
    ['Y', 'a hand by keys: arrows move it (with Shift faster), Enter takes hold and lets go, Page up and down are the wheel'],
    ['[ · ]', 'smaller · larger instrument; for the scalpel: the depth at which it begins'],
    ['Space · . · S', 'pause · one frame · slow motion'],
    ['Ctrl Z · B · R', 'undo: back to before the last act · back by a second · restart'],
    ['Marks at the bottom', 'what was done so far: click to go back to before it'],
    ['M · K · F · O', 'mesh · skin · fibres · a section across the view, which opens the organ'],
    ['L, or drop a file', 'another organ: a surface, a label image, a mesh or a scene; what was chosen for this one'],
    ['I · V', 'image · video'],
  ];
  show(
    '<h1>Hands on the organ</h1><dl>' +
      rows.map(([key, what]) => `<dt><b>${key}</b></dt><dd>${what}</dd>`).join('') +
      '</dl>',
  );
}
overlay.addEventListener('click', event => {
  if (event.target === overlay && overlay.dataset.lasting !== '1') hideOverlay();
});

export function showNoGraphics() {
  overlay.dataset.lasting = '1';
  show(`<h1>This browser draws no 3D (WebGL 2)</h1>
    <p>The simulation runs; only its picture is missing. One of these helps:</p>
    <p><b>On a machine with a graphics card:</b> switch on “Use graphics acceleration when available” in the
    browser's settings, and start it again.</p>
    <p><b>On a machine without one</b> (a virtual machine, say): Chrome and Chromium from version 139 on draw
    without a graphics card only if asked:</p>
    <p><code>chromium --enable-unsafe-swiftshader</code></p>
    <p>Firefox does so by itself. Or open this page from your own machine:<br>
    <code>ssh -L ${location.port || 80}:localhost:${location.port || 80} this-machine</code></p>`);
}

export function showRefused() {
  show(`<h1>Waiting for the simulation</h1>
    <p>It may have ended: <code>lobe view SCENE.json</code> starts it again, and this page goes on by
    itself.</p>
    <p>If it runs, this address lacks the key to it: open the whole address that it has printed, with
    <code>?token=…</code>.</p>`);
}
