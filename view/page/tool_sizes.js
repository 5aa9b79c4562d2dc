// How large the instruments are: in proportion to the organ, until the slider says otherwise.
const of = organ => ({
  grasp: {word: 'Grip', what: 'Radius of what the forceps take hold of', size: 0.012 * organ},
  cautery: {word: 'Tip', what: 'Radius of the tip that burns', size: 0.0055 * organ},
  scalpel: {word: 'Depth', what: 'How deep the blade begins below the surface', size: 0.02 * organ},
  probe: {word: 'Tip', what: 'Radius of the tip that presses', size: 0.01 * organ},
  jaws: {word: 'Opening', what: 'How far the jaws are apart', size: 0.1 * organ},
  hook: {word: 'Wire', what: 'Length of the wire of the hook', size: 0.05 * organ},
  stitch: {word: 'Depth', what: 'How deep below the surface the thread goes', size: 0.005 * organ},
  clip: {word: 'Clip', what: 'How wide a clip opens at most', size: 0.08 * organ},
});
const usual = 0.135, // radius of an organ for which these are [m]
  steps = 8, // of the slider, for twice the size
  most = 0.99; // that the simulation takes [m]

const neat = size => Number(size.toPrecision(2));
export const inMillimetres = size => `${Number((1e3 * size).toPrecision(size < 0.1 ? 2 : 3))} mm`;

export class ToolSizes {
  /** @param {HTMLElement} element with a label, a range and an output */
  constructor(element) {
    this.element = element;
    this.slider = element.querySelector('input');
    this.chosen = new Map(); // kind → steps of the slider
    this.kind = 'grasp';
    this.onChange = () => {};
    this.slider.oninput = () => this.choose(Number(this.slider.value));
    this.fit(usual);
  }

  /** For an organ of this radius [m]. */
  fit(radius) {
    this.usual = of(radius / usual);
    this.show();
  }

  /** The instrument that the slider is for. */
  setKind(kind) {
    this.kind = kind;
    this.show();
  }

  choose(step) {
    const {min, max} = this.slider;
    this.chosen.set(this.kind, Math.max(Number(min), Math.min(Number(max), step)));
    this.show();
    this.onChange();
  }

  /** Larger by so many steps; below 0: smaller. */
  change(by) {
    if (this.kind in this.usual) this.choose((this.chosen.get(this.kind) ?? 0) + by);
  }

  /** Of an instrument [m]. */
  of(kind) {
    return Math.min(most, neat(this.usual[kind].size * 2 ** ((this.chosen.get(kind) ?? 0) / steps)));
  }

  show() {
    const {element, slider, kind} = this;
    element.hidden = !(kind in this.usual);
    if (element.hidden) return;
    const {word, what} = this.usual[kind];
    element.title = `${what} ([ and ])`;
    element.querySelector('span').textContent = word;
    element.querySelector('output').textContent = inMillimetres(this.of(kind));
    slider.value = String(this.chosen.get(kind) ?? 0);
    slider.ariaLabel = what;
  }
}
