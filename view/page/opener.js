// Another organ: a file that is sent to the program, or one that comes with lobe; and what was chosen for the
// one that is open.
import {error, speed, speedOf, tetrahedra} from './estimates.js';
import {Waiting} from './waiting.js';

const element = id => document.getElementById(id);
const option = (value, textContent) => Object.assign(document.createElement('option'), {value, textContent});
const steps = 24, // of the slider to each side of the edge that is there
  perStep = 1.05;
// Files that have tetrahedra or are scenes: there is nothing to choose before they are opened.
const isReady = name => /\.(json|msh2?|mesh|node|ele)$/i.test(name);
const sides = {
  'x-': 'where x is least',
  'x+': 'where x is greatest',
  'y-': 'where y is least',
  'y+': 'where y is greatest',
  'z-': 'at its bottom',
  'z+': 'at its top',
};
const none = ['none', 'at its pins alone'];
// How the side lies that is held: stiffness of a bed per area [Pa/m].
const beds = [
  [0, 'fixed'],
  [5e4, 'on soft springs'],
  [2e5, 'on springs'],
  [1e6, 'on firm springs'],
];
const units = [
  [1, 'metres'],
  [0.01, 'centimetres'],
  [0.001, 'millimetres'],
];

const sidesOffered = () => Object.entries(sides).map(([side, words]) => option(side, words));

export class Opener {
  /** @param {(request: object) => void} ask @param {(text: string, kind?: string) => void} tell what is wrong
   *  @param {Pins} pins (pins.js) */
  constructor(ask, tell, pins) {
    this.ask = ask;
    this.tell = tell;
    this.pins = pins;
    this.choices = {shipped: [], tissues: [], extensions: [], largest_file: Infinity, chosen: null};
    this.now = {possible: 0, tets: 0}; // of the organ that is simulated, while it is moved
    this.may = false; // this page controls
    this.looked = null; // files whose size was asked for, and what they are called
    this.asked = []; // names of the files that were to be opened last
    this.needed = []; // names of files that a scene among these lacks
    this.waiting = new Waiting(names => this.open(names));
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
    for (const id of ['tissue', 'hold', 'springs', 'units']) element(id).onchange = () => this.showChoices();
    pins.onChange = () => this.showChoices();
    element('pin-set').onclick = () => this.setPins(!pins.isSetting);
    element('pin-clear').onclick = () => {
      pins.set([]);
      this.showChoices();
    };
    element('judge').onclick = () => this.ask({do: 'judge'});
    element('remake').onclick = () => this.remake();
    element('open-cancel').onclick = () => this.ask({do: 'cancel'});
    element('scene-save-name').oninput = ({target}) => {
      target.value = target.value.replace(/[^A-Za-z0-9_-]/g, '_');
    };
    element('scene-save').onclick = () => this.ask({do: 'save_scene', to: element('scene-save-name').value});
    element('needed-choose').onclick = () => element('open-input').click();
    element('needed-not').onclick = () => this.lack(null);
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
    this.pins.show(on);
    if (!on) this.setPins(false);
  }

  /** Whether clicks on the organ set pins. */
  setPins(on) {
    this.pins.isSetting = on;
    element('pin-set').ariaPressed = String(on);
    element('pin-set').textContent = on ? 'Done' : 'Set';
    this.showChoices();
  }

  /** What is wrong is said before anything is sent. Of what may be a surface or an image it is then asked how
   *  large it is. */
  async send(/** @type {File[]} */ files) {
    if (files.length === 0) return;
    if (!this.may) return this.tell('Another page holds the instruments: ask for them first.');
    const wrong = files.map(file => this.fault(file)).filter(Boolean);
    if (wrong.length > 0) return this.tell(wrong.join(' '));
    const sent = await this.upload(files);
    if (sent.length === 0) return;
    const completes = sent.some(name => this.needed.includes(name)),
      names = completes ? [...new Set([...this.asked, ...sent])] : sent,
      isEditing = !element('editor').hidden; // its panel lies where this one would
    this.waiting.end();
    this.lack(null);
    if (isEditing || names.some(isReady)) return this.open(names);
    this.looked = {names, titles: files.map(({name}) => name)};
    this.ask({do: 'measure', files: names});
  }

  open(names) {
    this.asked = names;
    this.ask({do: 'open', files: names, ...this.wishes()});
    this.waiting.end();
  }

  /** What the program has found of the files; another page may have asked for it. */
  takeSize({files, body}) {
    if (String(files) !== String(this.looked?.names)) return;
    const {names, titles} = this.looked;
    this.looked = null;
    if (!body) return this.open(names);
    this.waiting.begin(names, titles, body, this.choices);
    element('before').open = true;
    this.toggle(true);
    dispatchEvent(new Event('resize')); // the organ lies beside the panel
    element('open-now').focus();
  }

  /** A scene cannot be opened without more files. @param {?{text: string, files: string[]}} what */
  lack(what) {
    this.needed = what?.files ?? [];
    element('needed').hidden = !what;
    if (!what) return;
    element('needed-text').textContent = `${what.text}. Choose them, or drop them here.`;
    this.toggle(true);
    dispatchEvent(new Event('resize'));
    element('needed-choose').focus();
  }

  /** Files one after the other. Returns the names that they have then; none if one was not sent. */
  async upload(/** @type {File[]} */ files) {
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
        this.tell(`${file.name} was not sent: ${fault.message}`);
        return [];
      }
      names.push(name);
    }
    this.show('');
    return names;
  }

  /** What was chosen for a file before it is opened; where nothing was, lobe chooses. */
  wishes() {
    const value = id => element(`new-${id}`).value,
      edge = this.waiting.isOn() ? this.waiting.edgeAsked() : 1e-3 * Number(value('edge'));
    return {
      tissue: value('tissue'),
      hold: value('hold'),
      springs: Number(value('springs')),
      edge: edge > 0 ? edge : 0,
      scale: Number(value('units')),
    };
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
    if (choices.opened !== this.choices.opened) this.now = {possible: 0, tets: 0};
    const isOther = choices.opened !== this.choices.opened;
    this.choices = choices;
    if (choices.measured) this.takeSize(choices.measured);
    const scenes = Object.assign(document.createElement('optgroup'), {label: 'Scenes'}),
      organs = Object.assign(document.createElement('optgroup'), {label: 'Organs alone'});
    for (const {name, title} of choices.shipped)
      (name.startsWith('scenes/') ? scenes : organs).append(option(name, title));
    element('shipped').replaceChildren(option('', 'Choose …'), scenes, organs);
    if (!element('new-tissue').options.length) this.offer();
    this.showErrors(choices.errors);
    const {chosen} = choices;
    element('chosen').hidden = !chosen;
    if (isOther) this.warn(chosen?.warnings ?? []);
    if (!chosen) return;
    element('chosen-files').textContent = chosen.files.join(', ');
    element('chosen-size').textContent =
      chosen.size.map(side => (1e3 * side).toPrecision(3)).map(Number).join(' × ') + ' mm';
    element('tissue').replaceChildren(...this.tissues());
    if (!chosen.tissue) element('tissue').prepend(option('', 'several'));
    element('tissue').value = chosen.tissue;
    element('hold').replaceChildren(...sidesOffered(), option(...none));
    if (!chosen.hold) element('hold').prepend(option('', 'otherwise'));
    element('hold').value = chosen.hold;
    element('springs').replaceChildren(...beds.map(([stiffness, words]) => option(stiffness, words)));
    if (!beds.some(([stiffness]) => stiffness === chosen.springs))
      element('springs').append(option(chosen.springs, `on springs of ${chosen.springs / 1e3} kPa/m`));
    element('springs').value = String(chosen.springs);
    this.pins.set(chosen.pins);
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

  /** What the mesher has said of the mesh: on cards, and for good in the panel. */
  warn(/** @type {string[]} */ warnings) {
    for (const warning of warnings) this.tell(warning, 'warn');
    element('chosen-warnings').replaceChildren(
      ...warnings.map(textContent => Object.assign(document.createElement('li'), {textContent})),
    );
    element('chosen-warnings').hidden = warnings.length === 0;
  }

  tissues() {
    const kilopascals = young => Number((young / 1e3).toPrecision(2));
    return this.choices.tissues.map(({name, young}) => option(name, `${name}, ${kilopascals(young)} kPa`));
  }

  /** What may be chosen for a file before it is opened. */
  offer() {
    element('new-tissue').append(option('', 'liver'), ...this.tissues().filter(({value}) => value !== 'liver'));
    element('new-hold').append(option('', 'at its broadest side'), ...sidesOffered());
    element('new-springs').append(...beds.map(([stiffness, words]) => option(stiffness, words)));
    element('new-units').append(option('0', 'as found'), ...units.map(([scale, words]) => option(scale, words)));
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
    if (this.springs() !== chosen.springs) changes.springs = this.springs();
    if (String(this.pins.places()) !== String(chosen.pins)) changes.pins = this.pins.places();
    if (Number(element('edge').value) !== 0) changes.edge = this.edge();
    const scale = Number(element('units').value);
    if (scale === chosen.scale) return changes;
    delete changes.edge; // it is that of the body in other units
    return {...changes, pins: [], scale: scale || -1}; // below 0: as lobe finds it
  }

  /** Of the bed on which the held side lies [Pa/m]. */
  springs() {
    return element('hold').value === none[0] ? 0 : Number(element('springs').value);
  }

  /** How fast it would be with another edge: from how fast it is, once it was pulled (at rest it sleeps). */
  speedAt(edge, tets) {
    const {chosen, pace} = this.choices;
    if (this.now.possible > 0) return speed(this.now, tets);
    const tissue = this.choices.tissues.find(({name}) => name === chosen.tissue);
    if (!(pace > 0) || !tissue) return 0;
    return speedOf({tets, volume: chosen.volume, edge, wave: Math.sqrt(tissue.young / tissue.density)}, pace);
  }

  showChoices() {
    const {chosen} = this.choices;
    if (!chosen) return;
    const edge = this.edge(),
      tets = edge === chosen.edge ? chosen.tets : tetrahedra(chosen.volume, edge);
    element('edge-length').textContent = `${(1e3 * edge).toPrecision(2)} mm`;
    const figures = [`${Math.round(Number(tets.toPrecision(3))).toLocaleString('en')} tetrahedra`];
    const speedThen = this.speedAt(edge, tets);
    if (speedThen > 0) figures.push(`${Number(speedThen.toPrecision(2))} × real time`);
    figures.push(`error about ${(100 * error(tets)).toPrecision(2)} %`);
    element('edge-figures').textContent = figures.join(', ');
    const isUnknown = ['tissue', 'hold'].some(id => element(id).value === ''),
      changes = this.changes(),
      pins = changes.pins ?? chosen.pins,
      isFree = element('hold').value === none[0] && pins.length === 0;
    element('springs').disabled = element('hold').value === none[0];
    element('pin-count').textContent = this.pins.list.length || 'none';
    element('pin-clear').disabled = this.pins.list.length === 0;
    element('remake').disabled = isUnknown || isFree || Object.keys(changes).length === 0;
    const notes = [];
    if (this.pins.isSetting) notes.push('Click on the organ where it is fixed, or on a pin to take it out.');
    if (isUnknown) notes.push('Choose a tissue and a held side: those of this scene are of no such kind.');
    if (isFree) notes.push('Nothing holds it: set a pin, or choose a side.');
    if (changes.scale && this.pins.list.length > 0) notes.push('In other units its pins are taken out.');
    if (this.choices.is_painted) notes.push('What was painted will be lost.');
    element('remake-note').textContent = notes.join(' ');
  }

  remake() {
    const {tissue, hold, springs, pins} = this.choices.chosen;
    this.setPins(false);
    this.ask({do: 'remake', tissue, hold, springs, pins, edge: 0, scale: 0, ...this.changes()});
  }

  /** How far the mesh is from the truth of its own body, as `lobe check --total-error --json` has it. */
  showErrors(errors) {
    const percent = ({relative_l2: share}) => `${(100 * share).toPrecision(2)} %`;
    const inWords = ({gesture: name, trouble, element: mesh, held, total}) => {
      const gesture = name.charAt(0).toUpperCase() + name.slice(1);
      if (trouble) return `${gesture}: ${trouble}`;
      if (!total) return `${gesture}: off by ${percent(mesh)}`;
      return `${gesture}: off by ${percent(total)} (${percent(mesh)} by the mesh, ${percent(held)} by what is held)`;
    };
    element('errors').replaceChildren(
      ...(errors ?? []).map(entry => Object.assign(document.createElement('p'), {textContent: inWords(entry)})),
    );
  }

  /** @param {{possible: number, tets: number, running: boolean, opening?: {title: string}}} status
   *  @param {number} force of the instruments [N]: what is not moved sleeps, and tells no speed */
  update(status, force) {
    if (status.opening?.title !== this.title) {
      this.title = status.opening?.title;
      this.since = performance.now();
      if (!this.title) this.show('');
    }
    if (this.title) {
      const seconds = Math.floor((performance.now() - this.since) / 1e3);
      this.show(`${this.title} …${seconds > 1 ? ` ${seconds} s` : ''}`, true);
    }
    if (!status.running || !(status.possible > 0) || !(force > 0.05)) return;
    const {possible, tets} = this.now,
      isNews = possible === 0;
    if (!isNews && possible <= status.possible && tets === status.tets) return;
    this.now = {possible: status.possible, tets: status.tets};
    if (isNews) this.showChoices();
  }

  show(text, mayCancel = false) {
    element('opening').hidden = !text;
    element('opening-text').textContent = text;
    element('open-cancel').hidden = !mayCancel;
  }
}
