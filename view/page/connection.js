// The socket: connects, connects again when the server comes back, numbers what is asked, and tells how long it took to be seen.
import {readFrame} from './protocol.js';

export class Connection {
  /** @param {{frame: Function, event: Function, state: Function}} handlers */
  constructor(handlers) {
    this.handlers = handlers;
    this.number = 0;
    this.asked = new Map(); // when each request that no frame knows of yet was made [ms]
    this.latencies = []; // from a request to the picture that knows of it [ms]
    this.wait = 300;
    this.open();
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
    if (typeof data === 'string') return this.handlers.event(JSON.parse(data));
    const frame = readFrame(data);
    this.handlers.frame(frame);
  }

  /** The frame is about to be on the screen. */
  seen(frame) {
    this.send({do: 'seen'});
    const now = performance.now(),
      last = frame.status?.seen ?? 0;
    for (const [number, since] of this.asked) {
      if (number > last) break;
      this.asked.delete(number);
      this.latencies.push(now - since);
    }
    if (this.latencies.length > 2000) this.latencies.splice(0, 1000);
  }

  ask(request) {
    this.number += 1;
    if (this.send({...request, number: this.number})) this.asked.set(this.number, performance.now());
  }

  send(request) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(request));
    return true;
  }
}
