// What a body will be like once it is meshed, before it is: from its size, which the program has found, and
// the edge that is chosen.
import {error, speedOf, tetrahedraOfParts} from './estimates.js';

const element = id => document.getElementById(id);
const steps = 24, // of the slider to each side of the edge that lobe would choose
  perStep = 1.05,
  edgesAlong = 25; // the diagonal of a body, where lobe chooses

export class Waiting {
  /** @param {(names: string[]) => void} open files that were sent */
  constructor(open) {
    this.body = null; // {names, size, scale, parts}, in the coordinates of the files; null: nothing waits
    Object.assign(element('waiting-edge'), {min: -steps, max: steps, value: 0});
    element('waiting-edge').oninput = () => this.show();
    for (const id of ['new-tissue', 'new-units']) element(id).onchange = () => this.show();
    element('open-now').onclick = () => open(this.body.names);
    element('open-not').onclick = () => this.end();
  }

  isOn() {
    return this.body !== null;
  }

  /** @param {string[]} names @param {string[]} titles as the user knows them
   *  @param {{size: number[], scale: number, parts: {volume: number, area: number}[]}} size
   *  @param {{tissues: object[], pace: number}} choices */
  begin(names, titles, size, {tissues, pace}) {
    this.body = {names, ...size};
    this.tissues = tissues;
    this.pace = pace;
    element('waiting-files').textContent = titles.join(', ');
    element('waiting-edge').value = 0;
    this.toggle(true);
    this.show();
  }

  end() {
    this.body = null;
    this.toggle(false);
  }

  toggle(on) {
    element('waiting').hidden = !on;
    element('new-edge-field').hidden = on;
  }

  /** From the files' coordinates to metres. */
  scale() {
    const asked = Number(element('new-units').value);
    return asked > 0 ? asked : this.body.scale;
  }

  /** The edge that the slider says [m]. */
  edge() {
    const diagonal = this.scale() * Math.hypot(...this.body.size);
    return (diagonal / edgesAlong) * perStep ** element('waiting-edge').value;
  }

  /** The same; 0 where it was not moved, so that lobe chooses. */
  edgeAsked() {
    return Number(element('waiting-edge').value) === 0 ? 0 : this.edge();
  }

  /** √(E/ρ) of the tissue that is chosen; 0: unknown. */
  wave() {
    const chosen = element('new-tissue').value || 'liver',
      found = this.tissues.find(({name}) => name === chosen);
    return found ? Math.sqrt(found.young / found.density) : 0;
  }

  show() {
    if (!this.body) return;
    const scale = this.scale(),
      edge = this.edge(),
      wave = this.wave(),
      parts = this.body.parts.map(({volume, area}) => ({
        volume: scale ** 3 * volume,
        area: scale ** 2 * area,
      })),
      volume = parts.reduce((sum, part) => sum + part.volume, 0),
      tets = tetrahedraOfParts(parts, edge),
      figures = [`about ${Math.round(Number(tets.toPrecision(2))).toLocaleString('en')} tetrahedra`];
    element('waiting-size').textContent =
      this.body.size.map(side => Number((1e3 * scale * side).toPrecision(3))).join(' × ') + ' mm';
    element('waiting-length').textContent = `${Number((1e3 * edge).toPrecision(2))} mm`;
    if (this.pace > 0 && wave > 0) {
      const fast = speedOf({tets, volume, edge, wave}, this.pace);
      figures.push(`${Number(fast.toPrecision(2))} × real time`);
    }
    figures.push(`error about ${(100 * error(tets)).toPrecision(2)} %`);
    element('waiting-figures').textContent = figures.join(', ');
  }
}
