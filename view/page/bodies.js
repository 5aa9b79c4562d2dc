// The bodies of a scene that has several: their names, which of them are drawn, and which one is under the
// pointer. One that is faded or hidden is not taken hold of: what lies behind it is.
import {css, tissueOf} from './colours.js';

const looks = ['shown', 'faded', 'hidden'];

export class Bodies {
  /** @param {HTMLElement} list @param {HTMLElement} labels what lies over the picture */
  constructor(list, labels) {
    this.list = list;
    this.names = [];
    this.looks = []; // of each: one of `looks`
    this.rows = [];
    this.onChange = () => {}; // of how they are drawn
    this.label = Object.assign(document.createElement('span'), {className: 'body-name', hidden: true});
    labels.append(this.label);
  }

  /** Those of another scene begin as they are. */
  take(/** @type {string[]} */ names) {
    if (names.length === this.names.length && names.every((name, i) => name === this.names[i])) return;
    this.names = names;
    this.looks = names.map(() => 'shown');
    this.rows = names.map((name, i) => this.row(name, i));
    this.list.replaceChildren(...this.rows);
    this.list.hidden = names.length === 0;
    this.label.hidden = true;
    this.onChange();
  }

  row(name, i) {
    const row = document.createElement('div'),
      swatch = document.createElement('i'),
      title = Object.assign(document.createElement('span'), {textContent: name});
    swatch.style.background = css(tissueOf(i).skin);
    const choice = look => {
      const button = Object.assign(document.createElement('button'), {
        className: 'plain',
        textContent: {faded: 'Fade', hidden: 'Hide'}[look],
        title: {faded: `See through ${name}`, hidden: `Do not draw ${name}`}[look],
        onclick: () => this.set(i, this.looks[i] === look ? 'shown' : look),
      });
      button.dataset.look = look;
      button.setAttribute('aria-pressed', 'false');
      return button;
    };
    row.append(swatch, title, choice('faded'), choice('hidden'));
    return row;
  }

  /** @param {'shown'|'faded'|'hidden'} look */
  set(i, look) {
    this.looks[i] = look;
    for (const button of this.rows[i].querySelectorAll('button'))
      button.setAttribute('aria-pressed', String(button.dataset.look === look));
    this.rows[i].className = look;
    this.onChange();
  }

  is(i, /** @type {'shown'|'faded'|'hidden'} */ look) {
    return (this.looks[i] ?? 'shown') === look;
  }
  areAll(/** @type {'shown'|'faded'|'hidden'} */ look) {
    return this.looks.every(other => other === look);
  }

  /** The pointer is over this one, there in the window; undefined: over none. */
  point(i, x, y) {
    const name = this.names[i];
    this.label.hidden = name === undefined;
    this.rows.forEach((row, k) => row.classList.toggle('under', k === i));
    if (name === undefined) return;
    this.label.textContent = name;
    this.label.style.transform = `translate(${Math.round(x + 18)}px, ${Math.round(y - 34)}px)`;
  }
}
