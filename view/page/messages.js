// What there is to say, for some seconds: conditions of the simulation, and answers of the server.

const seconds = {warn: 8, bad: 12};
// What the simulation puts right by itself.
const quiet = /sub_stepped|unravelling|lumped|cache|went_back/;
const serious = /stands_still|diverged|too_stiff|everything_cut|refused/;

export class Messages {
  constructor(element) {
    this.element = element;
    this.last = null;
  }

  /** @param {{number: number, name: string, text: string, times: number}[]} messages the newest at the end */
  take(messages) {
    const newest = messages.length ? messages[messages.length - 1].number : 0;
    // What was said before this page came is not news.
    if (this.last === null || newest < this.last) this.last = newest;
    for (const message of messages)
      if (message.number > this.last && !quiet.test(message.name))
        this.add(message.text, serious.test(message.name) ? 'bad' : 'warn');
    this.last = newest;
  }

  forget() {
    this.last = null;
  }

  add(text, kind = '') {
    const [first] = this.element.children;
    if (this.element.lastChild?.textContent === text) this.element.lastChild.remove();
    else if (this.element.children.length > 4) first.remove();
    const line = Object.assign(document.createElement('div'), {textContent: text, className: kind});
    this.element.append(line);
    setTimeout(() => line.remove(), 1e3 * (seconds[kind] ?? 6));
  }
}
