// What there is to say, for some seconds, on a few cards: conditions of the simulation, and answers of the
// server. What is said again of the same thing is counted on its card.

const seconds = {warn: 8, bad: 12, lasting: 60};
const most = 3; // cards
const betweenTexts = 250; // of a card that is said again and again [ms]
// What the simulation puts right by itself.
const quiet = /sub_stepped|unravelling|lumped|cache|went_back/;
const good = /clipped|punctured|exited/;
const serious = /bleeding|leak|stands_still|failed|diverged|too_stiff|everything_cut|refused/;

// For a surgeon; what the simulation says of it stands in the card's title, and in its place with details.
const words = {
  diverged: 'The simulation broke down. Go back, or restart.',
  near_inversion: 'Tissue is crushed almost flat at one place. Pull or press less there.',
  pieces: 'A piece has come loose.',
  everything_cut: 'Nothing of the organ is left.',
  torn: 'A stitch has torn out of the tissue.',
  broken: 'A thread has broken.',
  slipped: 'The grip slipped off: it was pulled too hard.',
  blade_inside: 'The blade is wholly inside: this cut opens nowhere. Draw it out a little.',
  missed: 'There is nothing to take hold of.',
  inside: 'The instrument began inside the organ, and feels nothing of it: draw it out.',
  clip: 'The clip has closed on nothing.',
  clipped: 'A clip has closed.',
  bleeding: 'It bleeds: what was opened carries blood.',
  punctured: 'The needle has gone in.',
  exited: 'The needle has come out.',
  drawn_out: 'The end of the thread was drawn out of the tissue: draw less far.',
  leak: 'Bile leaks: what was opened carries it.',
  too_stiff: 'This organ is too firm for the simulation to keep up. Coarser parts, or softer tissue, help.',
};

const keyOf = ({name, about}) => `${name} ${about ?? ''}`;

export class Messages {
  constructor(element) {
    this.element = element;
    this.cards = new Map(); // key → card
    this.known = null; // how often each was said: key → times
  }

  /** @param {{number: number, name: string, about: string, text: string, times: number}[]} messages those of
   *   the session, the newest at the end */
  take(messages) {
    const said = new Map();
    for (const message of messages)
      said.set(keyOf(message), (said.get(keyOf(message)) ?? 0) + message.times);
    // What was said before this page came is not news.
    const known = this.known ?? said;
    this.known = said;
    for (const [key, times] of said) {
      const news = times - (known.get(key) ?? 0);
      if (news <= 0) continue;
      const {name, text} = messages.findLast(message => keyOf(message) === key);
      const kind = serious.test(name) ? 'bad' : good.test(name) ? '' : 'warn';
      if (!quiet.test(name)) this.add(text, kind, key, news, words[name]);
    }
  }

  forget() {
    this.known = null;
  }

  /** @param {string} key what it is about: there is one card for it @param {number} times it was said
   *  @param {string} [plain] the same in plain words */
  add(text, kind = '', key = text, times = 1, plain = text) {
    const card = this.cards.get(key) ?? this.make(kind, key);
    card.text = text;
    card.plain = plain;
    card.times += times;
    clearTimeout(card.leaving);
    card.leaving = setTimeout(() => this.remove(card), 1e3 * (seconds[kind] ?? 6));
    this.write(card);
  }

  make(kind, key) {
    // The oldest one goes first, but a serious one last.
    if (this.cards.size >= most) {
      const cards = [...this.cards.values()];
      this.remove(cards.find(card => !/bad|lasting/.test(card.kind)) ?? cards[0]);
    }
    const line = Object.assign(document.createElement('div'), {className: `message ${kind}`});
    line.innerHTML = '<span></span><b></b>';
    line.onclick = () => this.remove(card);
    const card = {key, kind, line, text: '', plain: '', times: 0, written: -Infinity};
    this.cards.set(key, card);
    this.element.append(line);
    return card;
  }

  // A few times a second, as it can be read.
  write(card) {
    if (card.writing) return;
    const write = () => {
      card.writing = null;
      card.written = performance.now();
      const [text, count] = card.line.children;
      const isTechnical = document.body.classList.contains('details');
      text.textContent = isTechnical ? card.text : card.plain;
      card.line.title = card.text;
      count.textContent = card.times > 1 ? `${card.times} ×` : '';
    };
    const wait = card.written + betweenTexts - performance.now();
    if (wait > 0) card.writing = setTimeout(write, wait);
    else write();
  }

  remove(card) {
    clearTimeout(card.leaving);
    clearTimeout(card.writing);
    if (this.cards.get(card.key) === card) this.cards.delete(card.key);
    card.line.remove();
  }
}
