// What colours mean: the models of regions, as in the pictures of lobe-picture, and a ramp for numbers.

export const models = [
  // by their number in the protocol
  {
    key: 'tensor-mass',
    name: 'Moves little',
    note: 'fast; can be cut',
    technical: 'linear, tensor-mass',
    colour: [0.29, 0.52, 0.75],
  },
  {
    key: 'precomputed',
    name: 'Moves little, is not cut',
    note: 'fastest; takes a while to prepare',
    technical: 'linear, pre-computed',
    colour: [0.4, 0.62, 0.5],
  },
  {
    key: 'nonlinear',
    name: 'Moves freely',
    note: 'right everywhere; slowest',
    technical: 'non-linear',
    colour: [0.66, 0.23, 0.18],
  },
  {
    key: 'reduced',
    name: 'Bends smoothly',
    note: 'faster where the mesh is fine',
    technical: 'reduced',
    colour: [0.8, 0.55, 0.3],
  },
  {
    key: 'corotational',
    name: 'Turns, stretches little',
    note: 'may turn; wrong where it is stretched',
    technical: 'corotational',
    colour: [0.55, 0.42, 0.68],
  },
];
/** Of materials, by their number. */
export const materialColours = [
  [0.72, 0.45, 0.36],
  [0.35, 0.56, 0.72],
  [0.55, 0.66, 0.35],
  [0.76, 0.62, 0.3],
  [0.58, 0.42, 0.68],
  [0.3, 0.62, 0.58],
  [0.75, 0.4, 0.55],
  [0.5, 0.5, 0.5],
];
/** Living tissue, a little different for each body: of its skin, and of what was cut open. */
const tissues = [
  {skin: [0.5, 0.185, 0.15], opened: [0.42, 0.085, 0.075]},
  {skin: [0.47, 0.2, 0.23], opened: [0.4, 0.1, 0.12]},
  {skin: [0.32, 0.33, 0.16], opened: [0.26, 0.25, 0.09]},
  {skin: [0.62, 0.42, 0.27], opened: [0.55, 0.32, 0.18]},
  {skin: [0.58, 0.31, 0.29], opened: [0.5, 0.2, 0.18]},
  {skin: [0.36, 0.17, 0.27], opened: [0.29, 0.09, 0.17]},
];
export const tissueOf = body => tissues[body % tissues.length];
/** Of what a cautery has burnt: its faces, and the skin beside them. */
export const charColours = {face: [0.14, 0.1, 0.085], rim: [0.17, 0.1, 0.08]};
export const heldColour = [0.93, 0.78, 0.35];

const viridis = [
  [0.267, 0.005, 0.329],
  [0.279, 0.175, 0.483],
  [0.23, 0.322, 0.546],
  [0.173, 0.449, 0.558],
  [0.128, 0.567, 0.551],
  [0.158, 0.684, 0.502],
  [0.369, 0.789, 0.383],
  [0.678, 0.864, 0.19],
  [0.993, 0.906, 0.144],
];

export const css = colour => `rgb(${colour.map(c => Math.round(255 * c)).join(' ')})`;
const linear = c => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
/** What a shader wants: light, not what is written in a picture. */
export const light = colour => colour.map(linear);

const table = new Float32Array(3 * 256);
for (let i = 0; i < 256; ++i) {
  const at = (i / 255) * 8,
    k = Math.min(7, Math.floor(at)),
    share = at - k;
  for (let c = 0; c < 3; ++c)
    table[3 * i + c] = linear((1 - share) * viridis[k][c] + share * viridis[k + 1][c]);
}

/** Colours of numbers between low and high, into `out`. */
export function rampColours(values, low, high, out) {
  const scale = high > low ? 255 / (high - low) : 0;
  for (let v = 0; v < values.length; ++v) {
    const i = 3 * Math.max(0, Math.min(255, Math.round((values[v] - low) * scale)));
    out[3 * v] = table[i];
    out[3 * v + 1] = table[i + 1];
    out[3 * v + 2] = table[i + 2];
  }
}

export const quantities = {
  tissue: {name: 'Tissue'},
  region: {name: 'Region'},
  displacement: {name: 'Displacement', unit: 'mm', factor: 1e3, least: 0, span: 0.005},
  von_mises: {name: 'Von Mises stress', unit: 'kPa', factor: 1e-3, least: 0, span: 500},
  volume_ratio: {name: 'Volume ratio', unit: '', factor: 1, span: 0.02},
  linear_error:
      {name: 'Error of linear and reduced regions', unit: 'mm', factor: 1e3, least: 0, span: 0.0005},
};

/** @param {number} [linearError] estimated, of the largest displacement */
export function showLegend(element, quantity, range, shares, linearError) {
  if (quantity === 'tissue' || quantity === 'material') return element.replaceChildren();
  if (quantity === 'region') {
    element.innerHTML =
      '<div class="swatches">' +
      models
        .map(({colour, name, technical}, i) =>
          shares[i] > 0 ? `<div title="${technical}"><i style="background:${css(colour)}"></i>${name}</div>` : '',
        )
        .join('') +
      '</div>';
    return;
  }
  const {unit, factor} = quantities[quantity],
    digits = value => (value * factor).toPrecision(3);
  element.innerHTML =
    `<div class="ramp" style="background:linear-gradient(90deg, ${viridis.map(css).join(', ')})"></div>` +
    `<div class="ticks"><span>${digits(range[0])}</span><span>${unit}</span>` +
    `<span>${digits(range[1])}</span></div>`;
  if (quantity === 'linear_error') element.append(linearErrorInWords(shares, linearError));
}

function linearErrorInWords(shares, error) {
  const words = document.createElement('p');
  if (shares[0] + shares[1] + shares[3] === 0)
    words.textContent = 'No region is linear or reduced: there is no such error.';
  else if (error === undefined) words.textContent = 'Estimated as soon as the organ moves.';
  else words.textContent = `Estimated: ${(100 * error).toPrecision(2)} % of the displacement.`;
  return words;
}
