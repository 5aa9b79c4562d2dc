// Painting: which model each part follows, and what is held.
import {css, heldColour, materialColours, models} from './colours.js';

const brushes = [
  ...models.map((model, i) => ({...model, model: i})),
  {key: 'held', name: 'Held', note: 'the skin that does not move', colour: heldColour},
  {key: 'free', name: 'Let free', note: 'the skin moves again', colour: [0.45, 0.47, 0.48]},
];
const element = id => document.getElementById(id);
const percent = share => `${(100 * share).toFixed(2)} %`;
const note = textContent => Object.assign(document.createElement('div'), {textContent});

export class Editor {
  constructor(ask) {
    this.ask = ask;
    this.brush = 'tensor-mass';
    this.onBrush = () => {}; // told which quantity shows what the brush does
    this.buttons = brushes.map(brush => this.addBrush(brush, 'brushes'));
    this.materials = [];
    const slider = element('brush-radius'),
      output = element('editor').querySelector('.slider output');
    slider.oninput = () => {
      output.textContent = `${slider.value} mm`;
    };
    slider.oninput();
    element('fill').onclick = () => this.fill();
    element('material-add').onclick = () => {
      this.awaited = element('material-name').value; // the brush, as soon as there is one of that name
      this.ask({
        do: 'new_material',
        name: element('material-name').value,
        young: 1e3 * Number(element('material-young').value),
      });
    };
    element('undo').onclick = () => this.ask({do: 'undo'});
    element('mend-tensor').onclick = () => this.ask({do: 'mend', as: 'tensor-mass'});
    element('mend-turning').onclick = () => this.ask({do: 'mend', as: 'turning'});
    element('propose').onclick = () => this.ask({do: 'propose', tolerance: Number(element('tolerance').value)});
    element('apply').onclick = () => {
      this.note('Preparing the simulation …');
      this.ask({do: 'apply'});
    };
    element('save-name').oninput = ({target}) => {
      target.value = target.value.replace(/[^A-Za-z0-9_-]/g, '_');
    };
    element('save').onclick = () => this.ask({do: 'save', to: element('save-name').value});
    this.choose(this.brush);
  }

  radius() {
    return element('brush-radius').value * 1e-3;
  }
  paint(at) {
    if (this.last && Math.hypot(...at.map((c, k) => c - this.last[k])) < this.radius() / 4) return;
    this.last = at;
    const radius = this.radius();
    if (this.material() >= 0) this.ask({do: 'paint_material', at, radius, material: this.material()});
    else this.ask({do: 'paint', at, radius, as: this.brush});
  }
  fill() {
    if (this.material() < 0) return this.ask({do: 'paint_all', as: this.brush});
    this.ask({do: 'paint_material', at: [0, 0, 0], radius: 1, material: this.material()});
    this.ask({do: 'stroke'});
  }
  /** The number of the material that the brush paints; below 0: it paints something else. */
  material() {
    return this.brush.startsWith('material-') ? Number(this.brush.slice('material-'.length)) : -1;
  }
  /** The quantity that shows what it does. */
  shows() {
    return this.material() >= 0 ? 'material' : 'region';
  }
  end() {
    this.last = null;
    this.ask({do: 'stroke'});
  }

  addBrush(brush, place) {
    const button = document.createElement('button');
    button.className = 'brush';
    button.role = 'radio';
    button.dataset.key = brush.key;
    button.innerHTML = '<i></i><b></b><span class="share"></span><small></small>';
    button.querySelector('i').style.background = css(brush.colour);
    button.querySelector('b').textContent = brush.name;
    button.querySelector('small').textContent = brush.note;
    if (brush.technical)
      button
        .querySelector('small')
        .append(Object.assign(document.createElement('span'), {className: 'technical', textContent: ` (${brush.technical})`}));
    button.onclick = () => this.choose(brush.key);
    element(place).append(button);
    return {button, brush};
  }

  choose(key) {
    this.brush = key;
    for (const {button, brush} of [...this.buttons, ...this.materials])
      button.setAttribute('aria-checked', String(brush.key === key));
    this.onBrush(this.shows());
  }

  listMaterials(materials) {
    while (this.materials.length > materials.length) this.materials.pop().button.remove();
    for (let i = this.materials.length; i < materials.length; ++i) {
      const {name, young} = materials[i];
      const brush = {
        key: `material-${i}`,
        name,
        note: `${Number((1e-3 * young).toPrecision(3))} kPa`,
        colour: materialColours[i % materialColours.length],
      };
      this.materials.push(this.addBrush(brush, 'material-brushes'));
      if (name !== this.awaited) continue;
      this.awaited = null;
      this.choose(brush.key);
    }
    this.materials.forEach(({button}, i) => {
      button.querySelector('.share').textContent = `${Math.round(100 * materials[i].share)} %`;
    });
  }

  /** @param {{shares: number[], held: number, materials: {name: string, young: number, share: number}[],
   *   busy: number|null, proposal: object|null}} state what the server says */
  update(state) {
    this.listMaterials(state.materials);
    for (const {button, brush} of this.buttons) {
      const share = button.querySelector('.share');
      if (brush.model !== undefined) share.textContent = `${Math.round(100 * state.shares[brush.model])} %`;
      if (brush.key === 'held') share.textContent = state.held;
    }
    element('propose').disabled = element('apply').disabled = state.busy !== null && state.busy !== undefined;
    this.showUnheld(state.unheld);
    element('undo').disabled = !state.can_undo;
    this.showProposal(state);
  }

  /** A pre-computed part that nothing holds cannot be simulated: why, and what helps. */
  showUnheld(unheld) {
    element('unheld').hidden = !unheld;
    if (!unheld) return;
    element('apply').disabled = true;
    element('unheld').querySelector('p').textContent =
      `A part that “moves little, is not cut”, ${Math.max(1, Math.round(100 * unheld.share))} % of the organ, ` +
      'is held nowhere. It is computed for how it lies now: if it turned, it would grow. Hold some of its skin ' +
      '(the brush Held), or change it:';
    element('mend-turning').hidden = !unheld.can_turn;
  }

  showProposal({busy, proposal}) {
    const place = element('proposal');
    if (typeof busy === 'number') {
      place.innerHTML = `Trying gestures …<progress max="1" value="${busy}"></progress>`;
    } else if (proposal) {
      place.innerHTML =
        `<b>${proposal.speedup.toFixed(2)} ×</b> as fast as if all of it moved freely; ` +
        `${Math.round(100 * proposal.linear)} % moves little` +
        '<table><tr><th>How far off</th><th>tried</th><th>expected</th></tr>' +
        proposal.gestures
          .map(g => `<tr><td></td><td>${percent(g.error)}</td><td>${percent(g.predicted)}</td></tr>`)
          .join('') +
        '</table>';
      place.querySelectorAll('td:first-child').forEach((cell, i) => {
        cell.textContent = proposal.gestures[i].name;
      });
      place.append(note('Simulate this, paint over it, or undo it.'));
      for (const text of proposal.notes) place.append(note(text));
    } else {
      place.textContent = 'It finds what moves little: for what your hands did, and off by no more than that.';
    }
  }

  note(text) {
    element('editor-note').textContent = text;
  }
}
