// Another organ: a file that is sent to the program, or one that comes with lobe; and what was chosen for the
// one that is open.
import {error, speed, tetrahedra} from './estimates.js';

const element = id => document.getElementById(id);
const option = (value, textContent) => Object.assign(document.createElement('option'), {value, textContent});
const steps = 24, // of the slider to each side of the edge that is there
  perStep = 1.05;
const sides = {
  'x-': 'where x is least',
  'x+': 'where x is greatest',
  'y-': 'where y is least',
  'y+': 'where y is greatest',
  'z-': 'at its bottom',
  'z+': 'at its top',
};
const units = [
  [1, 'metres'],
  [0.01, 'centimetres'],
  [0.001, 'millimetres'],
];

export class Opener {
  /** @param {(request: object) => void} ask @param {(text: string) => void} tell what is wrong */
  constructor(ask, tell) {
    this.ask = ask;
    this.tell = tell;
    this.choices = {shipped: [], tissues: [], extensions: [], largest_file: Infinity, chosen: null};
    this.now = {possible: 0, tets: 0}; // of the organ that is simulated
    this.may = false; // this page controls
    element('open-file').onclick = () => element('open-input').click();
    element('open-input').onchange = ({target}) => {
      this.send([...target.files]);
      target.value = '';
    };
    element('shipped').onchange = ({target}) => {
      if (target.value) this.ask({do: 'open_shipped', what: target.value});
      target.value = '';
    };
    element('edge').oninput = () => this.showChoices();
    for (const id of ['tissue', 'hold', 'units']) element(id).onchange = () => this.showChoices();
    element('remake').onclick = () => this.remake();
    element('open-cancel').onclick = () => this.ask({do: 'cancel'});
    element('scene-save-name').oninput = ({target}) => {
      target.value = target.value.replace(/[^A-Za-z0-9_-]/g, '_');
    };
    element('scene-save').onclick = () => this.ask({do: 'save_scene', to: element('scene-save-name').value});
    this.listenToDrops();
  }

  listenToDrops() {
    const show = on => document.body.classList.toggle('dropping', on);
    addEventListener('dragover', event => {
      if (![...event.dataTransfer.types].includes('Files')) return;
      event.preventDefault();
      show(true);
    });
    addEventListener('dragleave', event => event.relatedTarget === null && show(false));
    addEventListener('drop', event => {
      event.preventDefault();
      show(false);
      this.send([...event.dataTransfer.files]);
    });
  }

  toggle(on = element('opener').hidden) {
    element('opener').hidden = !on;
    element('open-button').ariaExpanded = String(on);
    element('open-button').classList.toggle('on', on);
  }

  /** Files one after the other, then asks to open them. What is wrong is said before anything is sent. */
  async send(/** @type {File[]} */ files) {
    if (files.length === 0) return;
    if (!this.may) return this.tell('Another page holds the instruments: ask for them first.');
    const wrong = files.map(file => this.fault(file)).filter(Boolean);
    if (wrong.length > 0) return this.tell(wrong.join(' '));
    const names = [];
    for (const file of files) {
      let name = file.name.replace(/[^A-Za-z0-9_.-]/g, '_').replace(/^[.-]+/, '');
      while (names.includes(name)) name = `_${name}`;
      this.show(`Sending ${file.name} …`);
      try {
        const query = `token=${new URLSearchParams(location.search).get('token') ?? ''}&name=${name}`;
        const answer = await fetch(`file?${query}`, {method: 'POST', body: file});
        if (!answer.ok) throw new Error(await answer.text());
      } catch (fault) {
        this.show('');
        return this.tell(`${file.name} was not sent: ${fault.message}`);
      }
      names.push(name);
    }
    this.show('');
    this.ask({do: 'open', files: names, tissue: '', hold: '', edge: 0, scale: 0});
  }

  fault(file) {
    const {extensions, largest_file: most} = this.choices,
      name = file.name.toLowerCase();
    if (!extensions.some(end => name.endsWith(end)))
      return `${file.name} is of no kind that lobe reads (${extensions.join(' ')}).`;
    if (file.size === 0) return `${file.name} is empty.`;
    if (file.size > most) return `${file.name} is too large: at most ${Math.round(most / 2 ** 20)} MiB.`;
    return '';
  }

  /** What a page may choose, and what was chosen for the scene that is open now. */
  take(choices) {
    this.choices = choices;
    const scenes = Object.assign(document.createElement('optgroup'), {label: 'Scenes'}),
      organs = Object.assign(document.createElement('optgroup'), {label: 'Organs alone'});
    for (const {name, title} of choices.shipped)
      (name.startsWith('scenes/') ? scenes : organs).append(option(name, title));
    element('shipped').replaceChildren(option('', 'Choose …'), scenes, organs);
    const {chosen} = choices;
    element('chosen').hidden = !chosen;
    if (!chosen) return;
    element('chosen-files').textContent = chosen.files.join(', ');
    element('chosen-size').textContent =
      chosen.size.map(side => (1e3 * side).toPrecision(3)).map(Number).join(' × ') + ' mm';
    const kilopascals = young => Number((young / 1e3).toPrecision(2));
    element('tissue').replaceChildren(
      ...choices.tissues.map(({name, young}) => option(name, `${name}, ${kilopascals(young)} kPa`)),
    );
    if (!chosen.tissue) element('tissue').prepend(option('', 'several'));
    element('tissue').value = chosen.tissue;
    element('hold').replaceChildren(...Object.entries(sides).map(([side, words]) => option(side, words)));
    if (!chosen.hold) element('hold').prepend(option('', 'as painted'));
    element('hold').value = chosen.hold;
    const known = units.map(([scale, words]) => option(scale, words)),
      {scale} = chosen;
    if (scale > 0 && !units.some(([unit]) => unit === scale)) known.push(option(scale, `${scale} m`));
    element('units').replaceChildren(option('0', 'as found'), ...known);
    element('units').value = String(scale);
    Object.assign(element('edge'), {min: -steps, max: steps, value: 0});
    element('edge').parentElement.hidden = chosen.has_own_mesh;
    const stem = chosen.files[0].replace(/\..*$/, '');
    element('scene-save-name').value = stem.replace(/[^A-Za-z0-9_-]/g, '_');
    this.showChoices();
  }

  /** The edge that the slider says [m]. */
  edge() {
    return this.choices.chosen.edge * perStep ** element('edge').value;
  }

  /** What is chosen and not made yet; an empty object if nothing is. */
  changes() {
    const {chosen} = this.choices,
      changes = {};
    if (!chosen) return changes;
    for (const id of ['tissue', 'hold'])
      if (element(id).value !== chosen[id]) changes[id] = element(id).value;
    if (Number(element('edge').value) !== 0) changes.edge = this.edge();
    const scale = Number(element('units').value);
    if (scale === chosen.scale) return changes;
    delete changes.edge; // it is that of the body in other units
    return {...changes, scale: scale || -1}; // below 0: as lobe finds it
  }

  showChoices() {
    const {chosen} = this.choices;
    if (!chosen) return;
    const edge = this.edge(),
      tets = edge === chosen.edge ? chosen.tets : tetrahedra(chosen.volume, edge);
    element('edge-length').textContent = `${(1e3 * edge).toPrecision(2)} mm`;
    const figures = [`${Math.round(Number(tets.toPrecision(3))).toLocaleString('en')} tetrahedra`];
    if (this.now.possible > 0) figures.push(`${speed(this.now, tets).toPrecision(2)} × real time`);
    figures.push(`error about ${Math.round(100 * error(tets))} %`);
    element('edge-figures').textContent = figures.join(', ');
    const isUnknown = ['tissue', 'hold'].some(id => element(id).value === '');
    element('remake').disabled = isUnknown || Object.keys(this.changes()).length === 0;
    const notes = [];
    if (isUnknown) notes.push('Choose a tissue and a held side: those of this scene are of no such kind.');
    if (this.choices.is_painted) notes.push('What was painted will be lost.');
    element('remake-note').textContent = notes.join(' ');
  }

  remake() {
    const {tissue, hold} = this.choices.chosen;
    this.ask({do: 'remake', tissue, hold, edge: 0, scale: 0, ...this.changes()});
  }

  /** @param {{possible: number, tets: number, running: boolean, opening?: {title: string}}} status */
  update(status) {
    if (status.opening?.title !== this.title) {
      this.title = status.opening?.title;
      this.since = performance.now();
      if (!this.title) this.show('');
    }
    if (this.title) {
      const seconds = Math.floor((performance.now() - this.since) / 1e3);
      this.show(`${this.title} …${seconds > 1 ? ` ${seconds} s` : ''}`, true);
    }
    if (!status.running || !(status.possible > 0)) return;
    const isNews = this.now.possible === 0;
    this.now = {possible: status.possible, tets: status.tets};
    if (isNews) this.showChoices();
  }

  show(text, mayCancel = false) {
    element('opening').hidden = !text;
    element('opening-text').textContent = text;
    element('open-cancel').hidden = !mayCancel;
  }
}
