// What the hands did, as marks on a bar of the simulated time, and the way back to before each of them. The
// simulation keeps the state in which each act began, and one every half second.
const acts = {
  grasp: {word: 'Pull'},
  cautery: {word: 'Burn'},
  scalpel: {word: 'Cut'},
  probe: {word: 'Press'},
  jaws: {word: 'Grip'},
  hook: {word: 'Hook'},
  clip: {word: 'Clip'},
  stitch: {word: 'Stitch', isAtOnce: true}, // done in the moment in which it begins
};
const margin = 0.1, // the simulation is ahead of what the page has heard, by about that [s]
  apart = 0.4; // within that after an act there is no other state to go back to [s]

export class History {
  /** @param {HTMLElement} bar @param {(seconds: number) => void} goBack by so much simulated time */
  constructor(bar, goBack) {
    this.bar = bar;
    this.goBack = goBack;
    this.acts = []; // {kind, time, mark, number}, the newest at the end
    this.time = 0; // of the simulation, as last heard [s]
    this.onChange = () => {}; // of the acts
    this.wanted = null; // to be gone back to [s]
    this.known = null; // the last message that the simulation went back
    bar.onclick = event => {
      if (event.target !== bar) return;
      this.to((this.time * event.offsetX) / bar.clientWidth);
    };
  }

  /** A hand has begun something. @param {number} number of the request that it makes */
  begin(kind, number) {
    if (!(kind in acts)) return;
    const mark = document.createElement('button'),
      act = {kind, time: this.time, mark, number},
      what = `${acts[kind].word} at ${this.time.toFixed(1)} s: go back to before it`;
    Object.assign(mark, {className: kind, title: what, ariaLabel: what, onclick: () => this.before(act)});
    this.acts.push(act);
    this.bar.append(mark);
    this.place();
    this.onChange();
  }

  /** Back to before the last act. @returns {boolean} whether there was one */
  undo() {
    const last = this.acts.at(-1);
    if (last) this.before(last);
    return Boolean(last);
  }

  before({time, hasBegun}) {
    this.to(time, hasBegun ? 0 : margin);
  }

  to(time, earlier = margin) {
    this.wanted = time;
    this.goBack(Math.max(0, this.time - time) + earlier);
  }

  /** The simulation is at this time [s], and knows of the requests up to this number. What it has gone back
   *  over is forgotten.
   *  @param {{number: number, times: number, text: string}} [back] its last message that it went back, which
   *   tells where to, while it has gone on since */
  take(time, seen = 0, back = undefined) {
    const landed = this.landing(time, back),
      before = this.time;
    this.time = time;
    // By then an act that was asked for has begun, a moment ago. If nothing was heard for long, other states
    // were kept since; what is done at once is then undone from before the silence.
    for (const act of this.acts)
      if (!act.hasBegun && seen >= act.number && time >= act.time)
        Object.assign(act, {
          time: acts[act.kind].isAtOnce && time > before + apart ? Math.max(act.time, before) : time,
          hasBegun: true,
        });
    if (landed === null) return;
    this.forget(Math.min(landed, this.wanted ?? landed));
    // It was further ahead than thought. A message has four digits.
    const isPast = this.wanted !== null && landed > this.wanted + 1e-3 * Math.max(1, landed);
    if (isPast) return this.goBack(Math.max(0, time - this.wanted) + margin);
    this.wanted = null;
  }

  // Where it went back to since the last call [s]; null: it did not.
  landing(time, back) {
    const key = back ? `${back.number} ${back.times}` : '',
      isNews = this.known !== null && key !== this.known;
    this.known = key;
    if (isNews && back) return Number(/ to (\S+) s$/.exec(back.text)?.[1] ?? time);
    return time < this.time ? time : null;
  }

  forget(from) {
    for (const {mark} of this.acts.filter(act => act.time >= from)) mark.remove();
    this.acts = this.acts.filter(act => act.time < from);
    this.onChange();
  }

  /** Some times a second: the marks lie where their time is. */
  place() {
    for (const {mark, time} of this.acts)
      mark.style.left = `${this.time > 0 ? ((100 * time) / this.time).toFixed(2) : 0}%`;
  }
}
