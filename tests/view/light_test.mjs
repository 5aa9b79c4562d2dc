// The light of the stage on a sphere.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {fill, key, lamps, litSphere, sky} from '../../view/page/light.js';

const across = 33,
  view = {right: [1, 0, 0], above: [0, 0, 1], back: [0, -1, 0]}; // from the front
const tissue = {roughness: 0.5, reflects: 0, wet: 0};
const pixel = (pixels, x, y) => {
  const at = [x, y].map(c => Math.floor(((c + 1) / 2) * across));
  return pixels.subarray(4 * (at[1] * across + at[0]), 4 * (at[1] * across + at[0]) + 4);
};
const linear = byte => ((byte / 255 + 0.055) / 1.055) ** 2.4;

test('matt tissue has the light of Lambert, where nothing shines', () => {
  // In the middle, to the viewer: the light of the sky from behind, of the lamp in front that of its angle.
  const n = [0, -1, 0],
    shares = [key, fill].map(({strength, from}) => {
      const cosine = from.reduce((sum, c, k) => sum + c * n[k], 0) / Math.hypot(...from);
      return (Math.max(0, cosine) * strength) / Math.PI;
    });
  const green = ({colour}) => linear((colour >> 8) & 255),
    expected =
      shares[0] * green(key) +
      shares[1] * green(fill) +
      (sky.strength / Math.PI) * linear((sky.ground >> 8) & 255);
  const [, found] = pixel(litSphere(across, view, {...tissue, roughness: 1}), 0, 0);
  // With what is reflected of 4 % of the light at least.
  assert.ok(found > 0.97 * expected && found < 1.1 * expected, `${found}, expected ${expected}`);
});

test('it is lighter above than below, and dry without a film', () => {
  const lit = litSphere(across, view, {...tissue, reflects: 1});
  const [red, green, blue, film] = pixel(lit, 0, 0.6);
  assert.ok(red > 3 * pixel(lit, 0, -0.6)[0]);
  assert.ok(red > green && green > blue && film === 0);
  assert.ok(lit.every(value => Number.isFinite(value) && value >= 0 && value < 20));
});

test('a film mirrors a lamp where a mirror would', () => {
  const wet = litSphere(across, view, {...tissue, wet: 1}),
    dry = litSphere(across, view, tissue);
  // The normal in the middle between the lamp and the viewer.
  const [lamp] = lamps,
    to = lamp.at.map(c => c / Math.hypot(...lamp.at)),
    half = to.map((c, k) => c + view.back[k]),
    length = Math.hypot(...half);
  const there = pixel(wet, half[0] / length, half[2] / length)[3],
    beside = pixel(wet, half[0] / length + 0.3, half[2] / length)[3];
  assert.ok(there > 0.2 && there > 5 * beside, `${there}, beside it ${beside}`);
  for (let i = 0; i < wet.length; ++i) if (i % 4 < 3) assert.equal(wet[i], dry[i]);
});
