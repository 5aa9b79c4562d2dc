// A section through the organ, and other organs in its place, in a headless Chromium.
// Usage: node browser_organs_test.mjs LOBE_VIEW SCENE MODULES OUT
import {existsSync, mkdtempSync, readFileSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import path from 'node:path';
import {openPage, until} from './page_support.mjs';

const {page, check, shot, end, scene, out} = await openPage({width: 1280, height: 720});
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

// ---- Several bodies, and threads: scenes of lobe

const text = id => page.textContent(`#${id}`);
const opens = number => until(page, n => lobe.opened === n && !lobe.status.opening, number);
await page.keyboard.press('l');
await page.selectOption('#shipped', {label: 'A liver sags onto a kidney, which a finger pushes along under it'});
check(await opens(1), 'a scene of lobe is opened in place of the first one');
check(/^liver.*kidney/.test(await text('bodies')), 'the panel names its bodies');
await page.waitForTimeout(1500);
// For each body the places of the window where it is seen.
const seen = () =>
  page.evaluate(() => {
    const places = [[], []];
    for (let x = 290; x < 1000; x += 15)
      for (let y = 80; y < 620; y += 15) {
        const hit = lobe.organ.hit(lobe.stage.ray(x, y));
        if (hit) places[lobe.organ.bodyOf(hit)].push([x, y]);
      }
    return places;
  });
const [liver, kidney] = await seen();
check(liver.length > 50 && kidney.length > 20, `both are seen, at ${liver.length} and ${kidney.length} places`);
// Where most of the kidney is around it: it moves meanwhile.
const around = ([x, y]) => kidney.filter(([u, v]) => Math.abs(u - x) < 50 && Math.abs(v - y) < 50).length;
await page.mouse.move(...kidney.toSorted((a, b) => around(b) - around(a))[0]);
await until(page, () => !document.querySelector('.body-name').hidden);
check((await page.textContent('.body-name')) === 'kidney', 'the name of a body stands beside the pointer over it');
await shot('bodies');
for (const look of ['faded', 'hidden']) {
  await page.click(`#bodies div:first-child [data-look=${look}]`);
  const [hit, free] = await seen();
  check(hit.length === 0 && free.length > kidney.length, `where the liver is ${look}, more of the kidney is reached`);
  await page.waitForTimeout(400);
  await shot(look);
}
await page.selectOption('#shipped', {label: 'A cut in a flank, closed by three stitches'});
check(await opens(2), 'another one is opened');
check(!(await page.isVisible('#bodies')), 'it has no bodies to name');
check(await until(page, () => lobe.lines.tubes.threads.count > 2), 'and its stitches are drawn');
await shot('threads');

// ---- A file: a surface in millimetres, turned inside out

const folder = mkdtempSync(path.join(tmpdir(), 'lobe-'));
const surface = path.join(folder, 'bean one.obj');
writeFileSync(surface, bean());
await page.setInputFiles('#open-input', surface);
check(await until(page, () => !document.getElementById('waiting').hidden), 'before it is meshed it is asked how');
check((await text('waiting-files')) === 'bean one.obj' && /^(59|60)/.test(await text('waiting-size')), 'with its size');
const told = await text('waiting-figures');
check(/[\d.]+ × real time/.test(told), `and its speed: ${told}`);
const before = parseFloat((await text('waiting-figures')).replace(/^about |,/g, ''));
await page.locator('#waiting-edge').fill('-3');
const finer = parseFloat((await text('waiting-figures')).replace(/^about |,/g, ''));
check(finer > 1.4 * before && finer < 1.7 * before, `a shorter edge: ${finer} tetrahedra in place of ${before}`);
check(/error about/.test(await text('waiting-figures')), 'and the error is told');
await page.selectOption('#new-units', {label: 'centimetres'});
check(/^(59|60)\d/.test(await text('waiting-size')), 'in centimetres it is ten times as large');
await page.selectOption('#new-units', {label: 'as found'});
await shot('waiting');
await page.locator('#waiting-edge').fill('0');
await page.click('#open-now');
const says = (id, words) =>
  until(page, ([id, words]) => document.getElementById(id).textContent.includes(words), [id, words]);
check(await says('opening', 'Opening bean_one.obj'), 'it is told what is being opened');
check(await opens(3), 'a surface is opened');
check(/^bean_one.obj(59|60)/.test(await page.textContent('#chosen p')), 'its name and its size are told');
const chosen = await page.evaluate(() => lobe.opener.choices.chosen);
check(Math.abs(chosen.size[0] - 0.06) < 0.002 && !chosen.has_own_mesh, 'it was taken to be in millimetres');
check(Math.abs(chosen.tets / before - 1) < 0.2, `it has ${chosen.tets} tetrahedra, of about ${before} that were told`);
await page.selectOption('#tissue', 'spleen');
await page.locator('#edge').fill('8');
const expected = parseFloat((await text('edge-figures')).replace(/,/g, ''));
check(expected < 0.45 * chosen.tets, `longer edges: ${chosen.tets} tetrahedra would be ${expected}`);
await shot('chosen');
await page.click('#remake');
check(await opens(4), 'it is made anew');
const made = await page.evaluate(() => lobe.opener.choices.chosen);
check(made.tissue === 'spleen' && made.tets < 1.4 * expected && made.tets > 0.7 * expected,
  `of ${made.tissue}, with ${made.tets} tetrahedra`);
await page.click('#scene-save');
check(await says('messages', 'Saved'), 'it is saved');
const saved = JSON.parse(readFileSync(path.join(out, 'bean_one.json')));
check(saved.materials[0].name === 'spleen' && existsSync(path.join(out, saved.mesh)), 'as a scene with its mesh');

// ---- What holds it: springs under its side, and a pin

await page.selectOption('#springs', {label: 'on soft springs'});
await page.click('#pin-set');
const middle = await page.evaluate(() => lobe.stage.project(lobe.stage.target));
await page.mouse.click(middle.x, middle.y);
check(await says('pin-count', '1'), 'a click on the organ sets a pin');
await shot('pin');
await page.click('#remake');
check(await opens(5), 'it is made anew');
const held = await page.evaluate(() => lobe.opener.choices.chosen);
check(held.springs === 5e4 && held.pins.length === 1 && held.tets === made.tets, 'on springs, with the pin, of the same mesh');

// ---- The same as PLY; and what the mesher warns of

const ply = path.join(folder, 'bean.ply');
writeFileSync(ply, asPly(bean()));
await page.setInputFiles('#open-input', ply);
check(await until(page, () => !document.getElementById('waiting').hidden), 'a PLY file has a slider, too');
check(
  parseFloat((await text('waiting-figures')).replace(/^about |,/g, '')) === before,
  'and as many tetrahedra',
);
await page.locator('#waiting-edge').fill('24'); // so long that parts are lost
await page.click('#open-now');
check(await opens(6), 'it is opened');
const warnings = await page.evaluate(() => lobe.opener.choices.chosen.warnings);
check(
  warnings.length > 0 && (await text('chosen-warnings')).includes(warnings[0]),
  `the panel has its warnings: ${warnings[0]}`,
);
check((await page.textContent('#messages')).includes(warnings[0]), 'and so has a card');

// ---- A scene that was saved here, alone; and one that lacks its mesh

await page.setInputFiles('#open-input', path.join(out, 'bean_one.json'));
check(await opens(7), 'a scene that was saved here needs no other file');
const other = path.join(folder, 'other.json');
writeFileSync(other, JSON.stringify({...saved, mesh: '/elsewhere/my mesh.vtu'}));
await page.setInputFiles('#open-input', other);
check(
  await until(page, () => !document.getElementById('needed').hidden),
  'one whose mesh is elsewhere asks for it',
);
check(/my_mesh\.vtu/.test(await text('needed-text')), 'by its name');
await shot('needed');
const mesh = path.join(folder, 'my mesh.vtu');
writeFileSync(mesh, readFileSync(path.join(out, saved.mesh)));
await page.setInputFiles('#open-input', mesh);
check(await opens(8), 'and is opened once that was sent');
check(!(await page.isVisible('#needed')), 'nothing is asked for any more');

// ---- What cannot be opened is said, and the organ stays

const bad = path.join(folder, 'bad.stl');
writeFileSync(bad, 'no surface');
await page.setInputFiles('#open-input', bad);
check(await says('messages', 'bad.stl was not opened'), 'a file that is none is named');
await page.setInputFiles('#open-input', path.resolve(scene, '../../README.md'));
check(await says('messages', 'README.md is of no kind'), 'so is one of another kind');
check(await page.evaluate(() => lobe.opened === 8 && lobe.status.running), 'and what was there goes on');
await end();

// Triangles of an OBJ file as a PLY file.
function asPly(obj) {
  const lines = obj.trim().split('\n').map(line => line.split(' ')),
    points = lines.filter(([kind]) => kind === 'v'),
    faces = lines.filter(([kind]) => kind === 'f');
  return `ply
format ascii 1.0
element vertex ${points.length}
property double x
property double y
property double z
element face ${faces.length}
property list uchar int vertex_indices
end_header
${points.map(([, ...x]) => x.join(' ')).join('\n')}
${faces.map(([, ...v]) => `3 ${v.map(n => n - 1).join(' ')}`).join('\n')}
`;
}

// The surface of an ellipsoid of 60 × 40 × 40 mm that is bent, its triangles turned inside.
function bean() {
  const [rings, sectors] = [10, 16],
    lines = [];
  const point = (theta, phi) => {
    const [x, y, z] = [30 * Math.cos(theta), 20 * Math.sin(theta) * Math.cos(phi), 20 * Math.sin(theta) * Math.sin(phi)];
    lines.push(`v ${x} ${y + 0.01 * x * x} ${z}`);
  };
  point(0, 0);
  for (let i = 1; i < rings; ++i) for (let k = 0; k < sectors; ++k) point((Math.PI * i) / rings, (2 * Math.PI * k) / sectors);
  point(Math.PI, 0);
  const at = (i, k) => 2 + (i - 1) * sectors + (k % sectors),
    last = 2 + (rings - 1) * sectors;
  for (let k = 0; k < sectors; ++k) {
    lines.push(`f 1 ${at(1, k + 1)} ${at(1, k)}`, `f ${last} ${at(rings - 1, k)} ${at(rings - 1, k + 1)}`);
    for (let i = 1; i < rings - 1; ++i)
      lines.push(`f ${at(i, k)} ${at(i, k + 1)} ${at(i + 1, k)}`, `f ${at(i, k + 1)} ${at(i + 1, k + 1)} ${at(i + 1, k)}`);
  }
  return `${lines.join('\n')}\n`;
}
