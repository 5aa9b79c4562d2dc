// The light of the stage: what lamps there are, and what they make of a sphere. No drawing here: to have a
// graphics card that is only imitated light a sphere takes it ten seconds, and this a tenth of one.

/** Panels that wet tissue reflects: colour, radiance, width and height, and where they are; they face the
 *  origin. */
export const lamps = [
  {colour: 0xfff4e8, strength: 14, width: 2.2, height: 2.2, at: [1.5, -1.5, 4]},
  {colour: 0xffffff, strength: 6, width: 1.2, height: 3.5, at: [-4, -1, 1.8]},
  {colour: 0xdfeefa, strength: 3, width: 4, height: 1.2, at: [2, 4, 1.5]},
  {colour: 0x5f7f82, strength: 1.6, width: 12, height: 12, at: [0, 0, -4]},
];
export const walls = {colour: 0x0b0f11, strength: 1},
  reflected = 0.6; // share of the light of lamps and walls

/** Light from far away: colour, irradiance, and where it comes from. */
export const key = {colour: 0xfff1e2, strength: 2.1, from: [0.9, -0.8, 2.4]},
  fill = {colour: 0xbcd8e6, strength: 0.5, from: [-1, 0.6, 0.5]},
  /** From one side, and from the other. */
  sky = {colour: 0xdfeaf0, ground: 0x6a7f82, strength: 1.15, from: [0, 1, 0]};

const scaled = (a, s) => a.map(x => s * x),
  dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
  cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
  unit = a => scaled(a, 1 / Math.hypot(...a));

/** Red, green and blue of a colour of the screen, in proportion to the light. */
const linear = hex =>
  [hex >> 16, (hex >> 8) & 255, hex & 255].map(byte => {
    const c = byte / 255;
    return c < 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  });

const frameOf = ({at}) => {
  const facing = unit(scaled(at, -1)),
    across = unit(cross([0, 1, 0], facing));
  return {facing, across, up: cross(facing, across)};
};

const points = 4; // that a lamp is for what is matt, along each side

function pointsOf(lamp) {
  const {colour, strength, width, height, at} = lamp,
    {facing, across, up} = frameOf(lamp),
    area = (width * height) / points ** 2;
  return Array.from({length: points ** 2}, (_, i) => {
    const u = (((i % points) + 0.5) / points - 0.5) * width,
      v = ((Math.floor(i / points) + 0.5) / points - 0.5) * height,
      place = at.map((x, k) => x + u * across[k] + v * up[k]);
    const solid = (area * -dot(unit(place), facing)) / dot(place, place);
    return {to: unit(place), light: scaled(linear(colour), reflected * strength * solid)};
  });
}

const film = {roughness: 0.22, blur: 0.2}; // `blur`: of what it mirrors [radian]

const fresnel = cosine => 0.04 + 0.96 * (1 - cosine) ** 5;

// The radiance, in green, of what a smooth film mirrors into a direction.
function mirrored(lampsSeen, [x, y, z]) {
  let sum = reflected * walls.strength * linear(walls.colour)[1];
  for (const {at, across, up, width, height, green} of lampsSeen) {
    const towards = x * at[0] + y * at[1] + z * at[2];
    if (towards <= 0) continue;
    const far = dot(at, at) / towards;
    const within = (side, half) => {
      const inside = half - Math.abs(far * (x * side[0] + y * side[1] + z * side[2]));
      return Math.max(0, Math.min(1, 0.5 + inside / (film.blur * far)));
    };
    sum += green * within(across, width / 2) * within(up, height / 2);
  }
  return sum;
}

// What falls on a thing that is looked at from a direction: numbers in rows of ten, the direction to it, that
// in the middle between it and the viewer, the irradiance of what faces it, and Fresnel's share of it.
function rowsOf(sources, toViewer) {
  const rows = sources.map(({to, light}) => {
    const half = unit(to.map((x, k) => x + toViewer[k]));
    return [...to, ...half, ...light, fresnel(dot(half, toViewer))];
  });
  return new Float64Array(rows.flat());
}

// Of a rough surface (GGX): the share of the light that is reflected to the viewer, but for Fresnel's.
function gloss(roughness, toHalf, toLight, toViewer) {
  const a2 = roughness ** 4,
    narrow = toHalf * toHalf * (a2 - 1) + 1;
  const hidden =
    toLight * Math.sqrt(a2 + (1 - a2) * toViewer * toViewer) +
    toViewer * Math.sqrt(a2 + (1 - a2) * toLight * toLight);
  return (0.5 * a2) / (Math.PI * narrow * narrow * hidden);
}

/**
 * How light a white matt sphere is, and the wet film on it, as they are seen from far away.
 * @param {number} across pixels
 * @param {{right: number[], above: number[], back: number[]}} view unit vectors, `back` to the viewer
 * @param {{roughness: number, reflects: number, wet: number}} tissue `reflects`: how much of lamps and walls
 * @returns {Float32Array} red, green, blue and the light of the film of each pixel; rows from below
 */
export function litSphere(across, {right, above, back}, {roughness, reflects, wet}) {
  const far = ({colour, strength, from}) => ({to: unit(from), light: scaled(linear(colour), strength)});
  const shining = [key, fill].map(far),
    dull = rowsOf(
      [...shining, ...lamps.flatMap(lamp => pointsOf({...lamp, strength: reflects * lamp.strength}))],
      back,
    ),
    distant = 10 * shining.length; // rows of these, in front
  const seen = lamps.map(lamp => ({
    ...lamp,
    ...frameOf(lamp),
    green: reflected * lamp.strength * linear(lamp.colour)[1],
  }));
  const [high, low] = [sky.colour, sky.ground].map(colour => scaled(linear(colour), sky.strength / Math.PI)),
    dark = scaled(linear(walls.colour), reflects * reflected * walls.strength);
  const pixels = new Float32Array(4 * across * across);
  for (let row = 0, at = 0; row < across; ++row)
    for (let column = 0; column < across; ++column, at += 4) {
      let [x, y] = [(2 * column + 1) / across - 1, (2 * row + 1) / across - 1];
      const out = Math.hypot(x, y);
      if (out > 1.05) continue;
      if (out > 0.999) [x, y] = [(0.999 * x) / out, (0.999 * y) / out]; // beside it, as at its edge
      const z = Math.sqrt(1 - x * x - y * y),
        n = [0, 1, 2].map(k => x * right[k] + y * above[k] + z * back[k]),
        [nx, ny, nz] = n;
      const side = 0.5 + 0.5 * dot(n, sky.from);
      for (let k = 0; k < 3; ++k) pixels[at + k] = low[k] + (high[k] - low[k]) * side + dark[k];
      for (let i = 0; i < dull.length; i += 10) {
        const toLight = nx * dull[i] + ny * dull[i + 1] + nz * dull[i + 2];
        if (toLight <= 0) continue;
        const toHalf = nx * dull[i + 3] + ny * dull[i + 4] + nz * dull[i + 5],
          glossy = toLight * dull[i + 9] * gloss(roughness, toHalf, toLight, z);
        for (let k = 0; k < 3; ++k) pixels[at + k] += (toLight / Math.PI + glossy) * dull[i + 6 + k];
        const wetter = i < distant ? toLight * dull[i + 9] * gloss(film.roughness, toHalf, toLight, z) : 0;
        pixels[at + 3] += wet * dull[i + 7] * (wetter + glossy);
      }
      if (wet > 0)
        pixels[at + 3] += wet * fresnel(z) * mirrored(seen, n.map((c, k) => 2 * z * c - back[k]));
    }
  return pixels;
}
