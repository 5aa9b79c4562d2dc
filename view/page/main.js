// The page: what the server says goes to the parts that show it, what the user does goes to the server.
import {Bodies} from './bodies.js';
import {savePicture, stamp, Video} from './capture.js';
import {showLegend} from './colours.js';
import {Connection} from './connection.js';
import {Editor} from './editor.js';
import {Hands} from './hands.js';
import {Instruments} from './instruments.js';
import {Obstacles} from './obstacles.js';
import {Opener} from './opener.js';
import {Organ} from './organ.js';
import {hideOverlay, overlayIsShown, showHelp, showNoGraphics, showRefused} from './overlay.js';
import {colours as forceColours, Forces} from './forces.js';
import {History} from './history.js';
import {DepthGauge} from './depth_gauge.js';
import {showHaptic} from './haptic.js';
import {Pins} from './pins.js';
import {Plot} from './plots.js';
import {listenToPreferences} from './preferences.js';
import {Section} from './section.js';
import {Needle} from './stitch.js';
import {graphics, Stage} from './stage.js';
import {KeyHand} from './key_hand.js';
import {listenToKeys} from './keys.js';
import {Lines} from './lines.js';
import {cutLength, volumeOf} from './measures.js';
import {Messages} from './messages.js';
import {Tape} from './tape.js';
import {inMillimetres, ToolSizes} from './tool_sizes.js';

const element = id => document.getElementById(id);

// How an instrument is used.
const hints = {
  grasp: 'Drag the organ to pull it',
  cautery: 'Drag over the organ to burn it',
  scalpel: 'Drag over the organ to cut it; the wheel makes the cut deeper',
  probe: 'Press on the organ, and drag along it; the wheel presses deeper',
  jaws: 'Press on the organ: the jaws grip what is between them',
  hook: 'Begin beside an edge and drag to lift it. D, or the right button too, burns',
  clip: 'Press on what is narrow. The clip closes when you let go; Esc takes the applier away',
  stitch: 'Click in, click out; drag to draw the thread up; double click ties. Shift and a click cuts',
  measure: 'Drag over the organ to measure a distance',
};

class Page {
  constructor(software) {
    this.stage = new Stage(element('stage'), software);
    this.bodies = new Bodies(element('bodies'), element('labels'));
    this.organ = new Organ(this.stage, this.bodies);
    this.lines = new Lines(this.stage);
    this.section = this.organ.section = new Section(this.stage, this.organ);
    this.instruments = new Instruments(this.stage, element('labels'));
    this.obstacles = new Obstacles(this.stage);
    this.ask = (request, since) => this.connection.ask(request, since);
    this.sizes = new ToolSizes(element('tool-size'));
    this.hands = new Hands(this.stage, this.organ, this.ask, this.sizes, new DepthGauge(element('depth')));
    this.tape = this.hands.tape = new Tape(this.stage, this.organ, element('labels'));
    const depth = () => this.sizes.of('stitch');
    this.needle = this.hands.needle = new Needle(this.stage, this.organ, this.ask, depth);
    this.keyHand = new KeyHand(this.stage, this.hands);
    this.editor = new Editor(this.ask);
    this.hands.brush = this.editor;
    this.editor.onBrush = quantity => this.mode === 'edit' && this.colour(quantity);
    this.messages = new Messages(element('messages'));
    this.pins = this.hands.pins = new Pins(this.stage, this.organ);
    this.opener = new Opener(this.ask, (text, kind = 'bad') => this.messages.add(text, kind), this.pins);
    this.newtons = new Forces();
    const forces = [
      ...forceColours.map((colour, i) => ({label: `instrument ${i + 1}`, colour})),
      {label: 'of the device', colour: '#6bd6ff'},
    ];
    this.forcePlot = new Plot(element('force-plot'), forces, 0);
    this.energyPlot = new Plot(
      element('energy-plot'),
      [
        {label: 'elastic', colour: '#6fc3b4'},
        {label: 'kinetic', colour: '#d98cb3'},
      ],
      3,
    );
    this.history = new History(element('history'), seconds => this.goBack(seconds));
    this.history.onChange = () => {
      element('undo-act').disabled = this.history.acts.length === 0;
    };
    this.history.onChange();
    this.video = new Video(element('stage'), (on, why) => {
      element('video').classList.toggle('on', on);
      if (why) this.messages.add(why, 'warn');
    });
    this.blades = []; // where this page's scalpels have entered, at rest (measures.js)
    this.status = {};
    this.lost = ''; // why nothing comes; empty: it does
    this.mode = 'live';
    this.stage.before.push(() => this.showFrame());
    this.stage.drawn.push(() => this.connection.drawn());
    this.stage.onQuality.push(() => this.showQuality());
    this.showQuality();
    this.connection = new Connection({
      frame: frame => this.receive(frame),
      event: event => this.hear(event),
      state: (state, why) => this.connected(state, why),
    });
    this.listen();
    this.leaveRoom();
    this.hint('Waiting for the first picture …');
    addEventListener('resize', () => this.leaveRoom());
  }

  /** The organ lies between the panels; where there is none at the side, messages are above it. */
  leaveRoom() {
    const {offsetTop: top} = element('side'),
      isSmall = matchMedia('(max-width: 900px)').matches, // as in style.css
      right = isSmall ? 0 : element('panel').offsetWidth,
      editor = element(element('editor').hidden ? 'opener' : 'editor'),
      isBelow = editor.offsetWidth > 0.6 * innerWidth,
      dock = innerHeight - element('dock').offsetTop;
    document.body.style.setProperty('--dock', `${dock}px`);
    this.stage.setMargins({
      left: isBelow ? 0 : editor.offsetWidth,
      right,
      top: isSmall ? top + Number.parseFloat(getComputedStyle(element('messages')).maxHeight) : top,
      bottom: isBelow ? innerHeight - editor.offsetTop : dock,
    });
  }

  // ---- From the server

  // A picture is drawn where the browser draws; the server sends the next one when this was.
  receive(frame) {
    this.lost = '';
    // What is left out between two pictures was older; a surface and what is no longer told stay.
    const {skin, choices} = this.frame ?? {};
    this.frame = frame.topology ? {skin, choices, ...frame} : {...this.frame, lines: undefined, ...frame};
    this.stage.wake();
    // A page in the background draws nothing, and wants to go on hearing.
    if (document.hidden) setTimeout(() => this.showFrame(), 200);
  }

  showFrame() {
    const frame = this.frame;
    if (!frame) return;
    this.frame = null;
    if (frame.choices) this.takeChoices(frame.choices);
    if (frame.skin) this.organ.setSkin(frame.skin);
    if (frame.skinPositions) this.organ.moveSkin(frame.skinPositions);
    if (frame.topology) this.takeTopology(frame);
    else if (frame.skin) this.organ.compose();
    if (frame.obstacles) this.obstacles.set(frame.obstacles);
    if (frame.positions && frame.positions.revision === this.organ.revision) {
      this.organ.move(frame.positions.x);
      this.follow(frame.positions.x);
      this.tape.follow();
      this.pins.follow();
      this.needle.follow();
    }
    this.lines.set(frame.lines ?? []);
    if (frame.scalar) this.organ.setScalar(frame.scalar);
    if (frame.held) this.organ.setHeld(frame.held);
    if (frame.materials) this.organ.setMaterials(frame.materials);
    // Figures beside the organ and in the panel are of the same frame.
    this.isDue = performance.now() - (this.figuresAt ?? 0) > this.stage.betweenFigures();
    if (frame.tools) {
      this.newtons.take(frame.tools);
      this.instruments.update(frame.tools, this.isDue);
      this.hands.follow(frame.tools, (frame.status ?? this.status).time);
    }
    if (frame.status) this.takeStatus(frame.status);
    this.frames = (this.frames ?? 0) + 1;
    this.connection.shown(frame, this.stage.slow);
  }

  // Some times a second, while no hand is at work.
  follow(x) {
    this.shape = x;
    const now = performance.now();
    if (now - (this.followedAt ?? 0) < 400 || this.hands.isBusy()) return;
    this.followedAt = now;
    this.stage.follow(x);
  }

  /** The camera as at the start, on the body as it is now. */
  home() {
    if (this.shape) this.stage.home(this.shape.slice());
  }

  /** Of another scene than before, or of the first one. */
  takeChoices(choices) {
    const isOther = this.opened !== undefined && this.opened !== choices.opened;
    this.opened = choices.opened;
    this.opener.take(choices);
    if (!isOther) return;
    this.isOther = true; // until its surface is there
    this.volume = 0;
    this.blades = [];
    this.history.forget(0);
    this.tape.clear();
    this.hands.forget();
  }

  takeTopology({topology, fibres, bodies, positions, status}) {
    this.bodies.take(status?.bodies ?? []);
    this.organ.held = null;
    const first = !this.organ.topology || this.isOther;
    this.isOther = false;
    if (first) {
      this.stage.lookAt(topology.rest);
      this.sizes.fit(this.stage.size);
    }
    this.organ.x = this.organ.served = null;
    const x = positions?.revision === topology.revision ? positions.x : undefined;
    this.organ.setTopology(topology, x, fibres, bodies);
    if (first) this.hintOf(this.hands.kind);
    this.isMeasured = false;
    this.showLegend();
  }

  takeStatus(status) {
    const before = this.status;
    this.status = status;
    this.forces = this.newtons.figures().map(({newtons}) => newtons);
    this.force = this.forces.reduce((sum, force) => sum + force, 0);
    if (status.scene !== before.scene) {
      element('scene-name').textContent = status.scene;
      document.title = `${status.scene} · lobe`;
    }
    if (this.isDue || status.mode !== before.mode) this.showFigures(status);
    if (status.mode === 'live' && status.has_skin !== before.has_skin) {
      element('skin').parentElement.hidden = !status.has_skin;
      if (element('skin').checked) this.wantSkin();
    }
    if (status.mode !== this.mode) this.changeMode(status.mode);
    if (status.edit) this.editor.update(status.edit);
    this.opener.update(status, this.force);
    this.showControl(status);
    if (status.run !== this.run) this.beginAnew(status.run);
    this.messages.take(status.messages ?? []);
    this.needle.take(status.threads ?? []);
    if (status.mode === 'live') {
      const back = status.messages?.findLast(({name}) => name === 'went_back');
      this.history.take(status.time, status.seen, back);
      this.forcePlot.pause = this.energyPlot.pause = 1.5 * this.stage.betweenFigures();
      const felt = status.haptic?.force;
      this.forcePlot.add(status.time, [...this.newtons.values, felt ? Math.hypot(...felt) : null]);
      const {energy} = status;
      if (energy) this.energyPlot.add(energy.time, [energy.elastic * 1e3, energy.kinetic * 1e3]);
    }
    if (performance.now() - (this.legendAt ?? 0) > 200) this.showLegend();
  }

  // A few times a second, as they can be read; each change has the whole page drawn.
  showFigures(status) {
    this.figuresAt = performance.now();
    this.showForces();
    this.showMeasures();
    showHaptic(element('haptic'), status.haptic);
    const {energy} = status;
    if (energy) element('energy').textContent = `${(1e3 * (energy.elastic + energy.kinetic)).toFixed(1)} mJ`;
    const factor = element('factor');
    const live = status.mode === 'live';
    factor.textContent = !live
      ? 'painting'
      : status.stands_still
        ? 'stands still'
        : status.running
          ? `${status.factor.toFixed(2)} × real time`
          : 'paused';
    factor.classList.toggle('slow', live && status.running && status.factor < 0.9 * status.speed);
    const possible = live && status.running && status.possible > 0 ? status.possible : 0;
    element('possible').textContent = possible ? `could be ${possible.toFixed(possible < 10 ? 1 : 0)} ×` : '';
    element('sim-time').textContent = live ? `${status.time.toFixed(2)} s` : '';
    element('step').textContent = live && status.step ? `step ${(1e3 * status.step).toFixed(2)} ms` : '';
    element('step').title =
      'The smallest time step of the last frame; ' +
      `${status.again ?? 0} frames were run again with smaller ones`;
    element('tets').textContent = `${status.tets.toLocaleString('en')} tetrahedra`;
    element('pause').classList.toggle('on', !status.running);
    element('single').disabled = status.running;
    element('slow').textContent = `${status.speed}×`;
    element('slow').classList.toggle('on', status.speed !== 1);
    element('back').disabled = !(status.can_go_back > 0);
    this.history.place();
  }

  /** One value for each instrument, as in the plot. */
  showForces() {
    const figures = this.newtons.figures().map(({newtons, colour}) => {
      const figure = Object.assign(document.createElement('span'), {textContent: newtons.toFixed(2)});
      figure.style.color = colour;
      return figure;
    });
    if (figures.length === 0) figures.push('0.00');
    element('force').replaceChildren(...figures.flatMap(figure => [figure, ' ']), 'N');
  }

  /** For the length of what it cuts: each time that it has moved by 4 mm, in an organ like a liver. */
  rememberBlade(hit, along) {
    const at = this.organ.restOf(hit),
      last = this.blades.at(-1)?.at;
    if (last && Math.hypot(...at.map((x, k) => x - last[k])) < 0.03 * this.stage.size) return;
    this.blades.push({at, along: this.organ.directionAtRest(hit, along)});
  }

  showMeasures() {
    if (!this.isMeasured) {
      this.isMeasured = true;
      const {surface} = this.organ,
        volume = volumeOf(surface),
        cut = cutLength(surface, this.blades);
      if (cut === 0) this.blades = [];
      this.volume = Math.max(this.volume ?? 0, volume);
      const removed = this.volume - volume;
      element('cut-length').textContent = cut > 0 ? inMillimetres(cut) : '';
      element('removed').textContent = removed > 1e-5 * volume ? `${(1e6 * removed).toPrecision(3)} ml` : '';
    }
    const distance = this.tape.length();
    element('distance').textContent = distance > 0 ? inMillimetres(distance) : '';
    element('measures').hidden = !element('measures').querySelector('dd:not(:empty)');
  }

  showQuality() {
    const {words} = this.stage.step;
    element('quality').textContent = words && `drawn with ${words}`;
  }

  showLegend() {
    this.legendAt = performance.now();
    const {quantity, range, shares} = this.organ;
    showLegend(element('legend'), quantity, range, shares, this.status.linear_error);
  }

  showControl(status) {
    this.showBanner();
    if (this.hands.may && !status.controls) this.hands.forget();
    this.hands.may = this.opener.may = status.controls;
    if (this.mayAct === status.controls) return;
    this.mayAct = status.controls; // as its buttons show
    for (const button of document.querySelectorAll('#dock button, #editor button, #opener button'))
      if (!['tool-measure', 'open-button', 'picture', 'video', 'panel-button', 'help-button'].includes(button.id)) {
        button.toggleAttribute('data-foreign', !status.controls);
        button.setAttribute('aria-disabled', String(!status.controls));
      }
  }

  /** What the whole page must know: that nothing comes, or who holds the instruments. */
  showBanner() {
    const {controls, controlled, asks, askers} = this.status,
      ask = request => () => this.ask({do: request});
    if (this.lost) return this.banner(this.lost);
    if (controls === undefined) return this.banner('');
    if (controls && askers > 0)
      return this.banner(
        `${askers > 1 ? `${askers} pages ask` : 'Another page asks'} for the instruments.`,
        {'Hand over': ask('hand_over'), Keep: ask('keep')},
        'It gets them without an answer if you hold nothing and do nothing for 10 s.',
      );
    if (controls) return this.banner('');
    if (!controlled) return this.banner('Nobody holds the instruments.', {'Take them': ask('control')});
    if (asks) return this.banner('You have asked the page that holds the instruments for them.');
    this.banner('You are watching; another page holds the instruments.', {'Ask for them': ask('control')});
  }

  /** The program that simulates is another one than before. */
  beginAnew(run) {
    if (this.run !== undefined)
      this.messages.add(
        'lobe view was started again. The organ begins anew: at time 0, as the scene describes it.',
        'lasting',
      );
    this.run = run;
    this.volume = 0;
    this.blades = [];
    this.history.forget(0);
  }

  hear(event) {
    if (event.event === 'needs' && this.mode !== 'edit') return this.opener.lack(event);
    if (event.event === 'needs') return this.editor.note(event.text);
    // Where one paints it stands in the panel, beside the button that was pressed.
    if (event.event === 'error' || event.event === 'note') {
      if (this.mode === 'edit') this.editor.note(event.text);
      else this.messages.add(event.text, event.event === 'error' ? 'bad' : '');
    }
  }

  connected(state, why) {
    if (state === 'silent') {
      if (!this.status.running || this.lost) return;
      this.lost = `The simulation has sent nothing for ${why} s.`;
      return this.showBanner();
    }
    // What came before is not drawn any more: it would pass for what is now.
    this.frame = null;
    this.status = {};
    this.hands.forget();
    if (state === 'open') {
      hideOverlay();
      this.lost = '';
      this.messages.forget();
      this.organ.leaveSkin();
      this.ask({do: 'show', what: this.wantedScalar()});
      return this.showBanner();
    }
    this.hands.may = false;
    this.instruments.update([]);
    if (state === 'lost' || this.organ.topology) {
      this.lost = why
        ? `The connection has ended: ${why}`
        : 'The connection is lost. This is the last picture; trying again …';
      element('factor').textContent = 'no connection';
      element('possible').textContent = '';
      this.showBanner();
    }
    if (state === 'refused' && (this.refusals = (this.refusals ?? 0) + 1) > 2 && !this.organ.topology)
      showRefused();
  }

  /** @param {Record<string, () => void>} actions what its buttons are called, and do */
  banner(text, actions = {}, more = '') {
    const banner = element('banner'),
      content = [text, ...Object.keys(actions)].join('\n');
    if (banner.dataset.content === content) return;
    banner.dataset.content = content;
    banner.hidden = !text;
    banner.textContent = text;
    banner.title = more;
    for (const [textContent, onclick] of Object.entries(actions))
      banner.append(
        Object.assign(document.createElement('button'), {className: 'plain', textContent, onclick}),
      );
  }

  /** Until it is used. */
  hintOf(tool) {
    if (this.organ.topology) this.hint(hints[tool] ?? '');
  }

  hint(text) {
    element('hint').textContent = text;
    element('hint').style.opacity = text ? 1 : 0;
  }

  // ---- From the user

  listen() {
    const click = (id, act) => {
      element(id).onclick = act;
    };
    click('tool-grasp', () => this.take('grasp'));
    click('tool-cautery', () => this.take('cautery'));
    click('tool-scalpel', () => this.take('scalpel'));
    click('tool-probe', () => this.take('probe'));
    click('tool-jaws', () => this.take('jaws'));
    click('tool-hook', () => this.take('hook'));
    click('tool-clip', () => this.take('clip'));
    click('tool-stitch', () => this.take('stitch'));
    click('tool-measure', () => this.take('measure'));
    click('tool-paint', () => this.take('paint'));
    click('pause', () => this.ask({do: 'pause', on: this.status.running}));
    click('single', () => this.ask({do: 'step'}));
    click('back', () => this.goBack(1));
    click('undo-act', () => this.history.undo() || this.messages.add('Nothing was done yet.'));
    click('restart', () => {
      this.hands.forget();
      this.ask({do: 'restart'});
    });
    click('slow', () => this.ask({do: 'speed', factor: {1: 0.25, 0.25: 0.1}[this.status.speed] ?? 1}));
    click('picture', () => this.savePicture());
    click('video', () => this.video.toggle());
    click('export', () => this.ask({do: 'export', to: `hands_${stamp()}`}));
    click('help-button', () => (overlayIsShown() ? hideOverlay() : showHelp()));
    click('open-button', () => {
      if (this.mode === 'edit') return; // whose panel is there
      this.opener.toggle();
      this.leaveRoom();
    });
    click('panel-button', () => this.openPanel(!document.body.classList.contains('panel-open')));
    element('colour').onchange = () => this.colour(element('colour').value);
    element('skin').onchange = () => this.wantSkin();
    element('mesh').onchange = () => this.organ.setShowsMesh(element('mesh').checked);
    element('section').onchange = () => {
      const {checked} = element('section');
      element('section-depth').hidden = !checked;
      this.section.setOn(checked);
    };
    element('section-depth').oninput = ({target}) => this.section.setDepth(target.value / 100);
    this.hands.onAct = kind => {
      this.hint('');
      if (kind !== 'paint') this.history.begin(kind, this.connection.number + 1);
    };
    this.hands.onHover = (hit, x, y) => this.bodies.point(hit ? this.organ.bodyOf(hit) : undefined, x, y);
    this.hands.onEntry = (hit, {forward}) => this.rememberBlade(hit, forward);
    this.hands.onRefusal = this.needle.onRefusal = why => this.messages.add(why);
    this.needle.onAct = () => this.hands.onAct('stitch');
    this.needle.onPull = newtons => {
      if (newtons === null) this.hint('');
      else if (this.isDue) this.hint(`Drawn up with ${newtons.toFixed(2)} N. Double click ties; Esc lets go`);
    };
    this.hands.onBlade = blade =>
      this.hint(blade ? `${inMillimetres(blade.depth)} deep; the wheel changes it` : '');
    listenToPreferences((name, on) => {
      if (name === 'light') this.stage.setTheme(on ? 'light' : 'dark');
      for (const plot of [this.forcePlot, this.energyPlot]) plot.dress();
    });
    this.take('grasp');
    listenToKeys(this);
  }

  /** In a small window, where it covers the organ. */
  openPanel(on) {
    document.body.classList.toggle('panel-open', on);
    element('panel-button').classList.toggle('on', on);
    element('panel-button').ariaExpanded = String(on);
  }

  goBack(seconds) {
    this.hands.forget();
    this.ask({do: 'back', seconds});
  }

  wantSkin() {
    const on = element('skin').checked;
    this.organ.leaveSkin();
    if (this.status.has_skin) this.ask({do: 'skin', on});
  }

  take(tool) {
    for (const [id, name] of [
      ['tool-grasp', 'grasp'],
      ['tool-cautery', 'cautery'],
      ['tool-scalpel', 'scalpel'],
      ['tool-probe', 'probe'],
      ['tool-jaws', 'jaws'],
      ['tool-hook', 'hook'],
      ['tool-clip', 'clip'],
      ['tool-stitch', 'stitch'],
      ['tool-measure', 'measure'],
      ['tool-paint', 'paint'],
    ])
      element(id).setAttribute('aria-checked', String(name === tool));
    const paints = tool === 'paint';
    if (paints !== (this.mode === 'edit') && this.status.controls) this.ask({do: 'edit', on: paints});
    if (!paints || this.mode === 'edit') this.hands.setKind(tool);
    if (!paints) this.hintOf(tool);
  }

  changeMode(mode) {
    this.mode = mode;
    const edits = mode === 'edit';
    if (edits) this.opener.toggle(false);
    if (edits) this.organ.leaveSkin();
    else if (element('skin').checked) this.wantSkin();
    element('editor').hidden = !edits;
    this.colour(edits ? this.editor.shows() : 'tissue');
    this.instruments.update([]);
    this.take(edits ? 'paint' : 'grasp');
    if (edits) this.hint('Paint on the organ');
    this.editor.note('');
    element('pause').parentElement.style.display = edits ? 'none' : '';
    for (const plot of document.querySelectorAll('.plot')) plot.hidden = edits;
    this.tape.clear();
    for (const id of ['export', 'open-button', 'history']) element(id).hidden = edits;
    this.leaveRoom();
  }

  wantedScalar() {
    const {quantity} = this.organ;
    return ['von_mises', 'volume_ratio', 'linear_error'].includes(quantity) ? quantity : 'none';
  }

  colour(quantity) {
    element('colour').value = quantity;
    this.organ.show(quantity);
    if (quantity === 'displacement' && this.organ.x) this.organ.showDisplacement(this.organ.x);
    this.ask({do: 'show', what: this.wantedScalar()});
    this.showLegend();
  }

  savePicture() {
    this.stage.drawFine(savePicture);
  }
}

const drawing = graphics();
if (!drawing) {
  showNoGraphics();
} else {
  window.lobe = new Page(drawing.software);
}
