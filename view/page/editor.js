// Painting: which model each part follows, and what is held.
import {css, heldColour, models} from './colours.js';

const brushes = [
  ...[2, 0, 1].map(i => ({...models[i], model: i})),
  {key: 'held', name: 'Held', note: 'the skin that does not move', colour: heldColour},
  {key: 'free', name: 'Let free', note: 'the skin moves again', colour: [0.45, 0.47, 0.48]},
];
const element = id => document.getElementById(id);

export class Editor {
  constructor(ask) {
    this.ask = ask;
    this.brush = 'tensor-mass';
    this.buttons = brushes.map(brush => this.addBrush(brush));
    const slider = element('brush-radius'),
      output = element('editor').querySelector('.slider output');
    slider.oninput = () => {
      output.textContent = `${slider.value} mm`;
    };
    slider.oninput();
    element('fill').onclick = () => this.ask({do: 'paint_all', as: this.brush});
    element('undo').onclick = () => this.ask({do: 'undo'});
    element('propose').onclick = () => this.ask({do: 'propose', tolerance: 0.02});
    element('apply').onclick = () => {
      this.note('Preparing the simulation …');
      this.ask({do: 'apply'});
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
    this.ask({do: 'paint', at, radius: this.radius(), as: this.brush});
  }
  end() {
    this.last = null;
    this.ask({do: 'stroke'});
  }

  addBrush(brush) {
    const button = document.createElement('button');
    button.className = 'brush';
    button.role = 'radio';
    button.dataset.key = brush.key;
    button.innerHTML = `<i style="background:${css(brush.colour)}"></i><b>${brush.name}</b><span class="share"></span><small>${brush.note}</small>`;
    button.onclick = () => this.choose(brush.key);
    element('brushes').append(button);
    return {button, brush};
  }

  choose(key) {
    this.brush = key;
    for (const {button, brush} of this.buttons)
      button.setAttribute('aria-checked', String(brush.key === key));
  }

  /** @param {{shares: number[], held: number, busy: number|null, proposal: object|null}} state what the server says */
  update(state) {
    for (const {button, brush} of this.buttons) {
      const share = button.querySelector('.share');
      if (brush.model !== undefined) share.textContent = `${Math.round(100 * state.shares[brush.model])} %`;
      if (brush.key === 'held') share.textContent = state.held;
    }
    element('propose').disabled = element('apply').disabled = state.busy !== null && state.busy !== undefined;
    element('undo').disabled = !state.can_undo;
    this.showProposal(state);
  }

  showProposal({busy, proposal}) {
    const place = element('proposal');
    if (typeof busy === 'number') {
      place.innerHTML = `Trying gestures …<progress max="1" value="${busy}"></progress>`;
    } else if (proposal) {
      place.innerHTML =
        `<b>${proposal.speedup.toFixed(2)} ×</b> as fast as all non-linear; ${Math.round(100 * proposal.linear)} % linear` +
        '<table>' +
        proposal.gestures.map(g => `<tr><td></td><td>${(100 * g.error).toFixed(2)} %</td></tr>`).join('') +
        '</table>';
      place.querySelectorAll('td:first-child').forEach((cell, i) => {
        cell.textContent = `error, ${proposal.gestures[i].name}`;
      });
      for (const note of proposal.notes)
        place.append(Object.assign(document.createElement('div'), {textContent: note}));
    } else {
      place.textContent = 'It finds what may be linear for an error below 2 %.';
    }
  }

  note(text) {
    element('editor-note').textContent = text;
  }
}
