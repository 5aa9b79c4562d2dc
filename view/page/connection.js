// The socket: connects, connects again when the server comes back, numbers what is asked, and tells how long
// it took to be seen.
import {readFrame} from './protocol.js';

const shortest = 6; // between two frames [ms]
const longSilence = 3000; // of a simulation that runs [ms]
const share = 0.2; // of the time that a picture takes: a frame may be as old as that

export class Connection {
  /** @param {{frame: Function, event: Function, state: Function}} handlers of what comes, and of how it is:
   *   'open', 'lost', 'refused', or 'silent' for so many seconds */
  constructor(handlers) {
    this.handlers = handlers;
    this.number = 0;
    this.asked = new Map(); // requests that no picture knows of yet: number → {hand, asked} [ms]
    this.underWay = []; // requests that the picture which is being drawn knows of
    this.trips = []; // of requests, from the hand to the finished picture that knows of it [ms]
    this.acknowledged = 0; // when [ms]
    this.drawing = 0; // what a picture takes [ms]
    this.wait = 300;
    this.heard = 0; // when anything came last [ms]
    this.open();
    setInterval(() => this.listen(), 500);
  }

  listen() {
    const silence = performance.now() - this.heard;
    if (this.socket.readyState === WebSocket.OPEN && silence > longSilence)
      this.handlers.state('silent', Math.round(silence / 1e3));
  }

  open() {
    const address = new URL('live', location.href);
    address.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    address.search = location.search;
    this.socket = new WebSocket(address);
    this.socket.binaryType = 'arraybuffer';
    let opened = false;
    this.socket.onopen = () => {
      opened = true;
      this.heard = performance.now();
      this.wait = 300;
      this.asked.clear();
      this.handlers.state('open');
    };
    this.socket.onmessage = message => this.receive(message.data);
    this.socket.onclose = event => {
      this.handlers.state(opened ? 'lost' : 'refused', event.reason);
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(2000, this.wait * 1.5);
    };
  }

  receive(data) {
    this.heard = performance.now();
    if (typeof data === 'string') return this.handlers.event(JSON.parse(data));
    const frame = readFrame(data);
    frame.received = performance.now();
    this.handlers.frame(frame);
    // Not when it is drawn: until then a later one may come.
    const pause = document.hidden ? 200 : Math.max(shortest, share * this.drawing);
    const wait = this.acknowledged + pause - frame.received;
    if (wait > 0) setTimeout(() => this.acknowledge(), wait);
    else this.acknowledge();
  }

  acknowledge() {
    this.acknowledged = performance.now();
    this.send({do: 'seen'});
  }

  /** The frame is about to be drawn, which takes so long. */
  shown(frame, drawing) {
    this.drawing = drawing;
    this.underWay = []; // what changed nothing is never drawn
    const last = frame.status?.seen ?? 0;
    for (const [number, {hand, asked}] of this.asked) {
      if (number > last) break;
      this.asked.delete(number);
      this.underWay.push({hand, asked, received: frame.received});
    }
  }

  /** The picture of the last frame that was shown is finished. */
  drawn() {
    const now = performance.now();
    for (const {hand, asked, received} of this.underWay)
      this.trips.push({hand: asked - hand, server: received - asked, draw: now - received});
    this.underWay = [];
    if (this.trips.length > 2000) this.trips.splice(0, 1000);
  }

  /** @param {number} hand when the hand did what leads to it [ms] */
  ask(request, hand = performance.now()) {
    this.number += 1;
    if (this.send({...request, number: this.number}))
      this.asked.set(this.number, {hand, asked: performance.now()});
  }

  send(request) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(request));
    return true;
  }
}
