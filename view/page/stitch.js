// Needle and thread: each click leads the thread through the organ below that place, a drag draws its ends
// up, and a double click ties a knot between the first place and the last.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {anchorOf, pointOf} from './anchors.js';

// A braided 3-0 thread, and what soft tissue bears at a bite: stiffness, strength and that in newtons.
const material = {stiffness: 98, friction: 0.2, strength: 20, holds: 1},
  colour = 0x5b3fb0, // as in lines.js
  slack = 5, // of a click that moves a little [pixels]
  beside = 24, // from how far the ends are taken again [pixels]
  twice = {within: 400, near: 12}, // of a double click [ms, pixels]
  pace = 15, // between two places to which the ends are led [ms]
  thin = 8; // from how far a thread is cut [pixels]

const isOpen = thread => thread.sewn && !thread.cut && thread.knots.length === 0;

export class Needle {
  /** @param {(request: object, since?: number) => void} ask @param {() => number} depth of a bite [m] */
  constructor(stage, organ, ask, depth) {
    this.stage = stage;
    this.organ = organ;
    this.ask = ask;
    this.depth = depth;
    this.threads = []; // as the simulation has told them last
    this.highest = -1; // of the numbers that this page has given
    this.thread = null; // in the needle: {number, bites}
    this.isUnsure = false; // which one that is, after going back
    this.left = new Set(); // those that were left untied
    this.pulled = null; // the ends in the hand: {point, isHeld}
    this.press = null; // the pointer that is down: {x, y, hit, ray, isCut, time, moves}
    this.last = null; // click: {x, y, time}
    this.marks = []; // where the thread went in, on the skin: {place (anchors.js), ball}
    this.onAct = () => {}; // told that it sews, ties, pulls or cuts
    this.onPull = () => {}; // told with what the ends pull [N]; null: they are in no hand
    this.onRefusal = () => {}; // told why something cannot be done
    this.ball = new THREE.SphereGeometry(1, 16, 12);
    const seen = {color: colour, depthTest: false, transparent: true}; // through everything
    this.material = new THREE.MeshBasicMaterial({...seen, opacity: 0.9});
    this.line = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3()]),
      new THREE.LineBasicMaterial({...seen, opacity: 0.6}),
    );
    this.line.frustumCulled = this.line.visible = false;
    this.line.renderOrder = 21;
    stage.scene.add(this.line);
  }

  // ---- From the simulation

  /** @param {{thread: number, sewn: boolean, bites: number[], knots: number[][], cut: boolean, held: boolean,
   *   pull: number}[]} threads */
  take(threads) {
    this.threads = threads;
    if (!this.pulled) return;
    const mine = threads.find(({thread}) => thread === this.thread?.number);
    if (mine?.held) {
      this.pulled.isHeld = true;
      this.onPull(mine.pull);
    } else if (this.pulled.isHeld) {
      this.pulled = null; // it slipped, broke or tore out: messages say so
      this.onPull(null);
    }
  }

  /** The marks follow the organ. */
  follow() {
    for (const {place, ball} of this.marks) {
      ball.position.copy(pointOf(this.organ, place));
      ball.scale.setScalar(0.008 * this.stage.size);
    }
    if (this.marks.length > 0) this.stage.invalidate();
  }

  /** Everything was put back, or the hands are another page's. */
  forget() {
    this.thread = this.pulled = this.press = this.last = null;
    this.isUnsure = true;
    this.unmark();
  }

  // ---- From the pointer

  /** @returns {boolean} whether it is for the needle */
  down({offsetX: x, offsetY: y, timeStamp: time, shiftKey}, hit, ray) {
    const end = this.pulled && this.stage.project(this.pulled.point),
      takesEnds = end && Math.hypot(end.x - x, end.y - y) < beside;
    if (!hit && !takesEnds) return false;
    this.press = {x, y, hit, ray, time, isCut: shiftKey, moves: false};
    return true;
  }

  drag({offsetX: x, offsetY: y}, dx, dy) {
    const {press} = this;
    if (!press || press.isCut) return;
    if (!press.moves) {
      if (Math.hypot(x - press.x, y - press.y) <= slack) return;
      [dx, dy] = [x - press.x, y - press.y];
      press.moves = true;
      this.beginToPull(press.hit);
    }
    if (!this.pulled) return;
    const scale = this.stage.metresPerPixel(this.pulled.point);
    this.pulled.point
      .addScaledVector(this.stage.right(), dx * scale)
      .addScaledVector(this.stage.above(), -dy * scale);
    this.lead();
  }

  /** Towards the viewer, or back. @returns {boolean} whether ends are in the hand */
  wheel(notches) {
    if (!this.pulled) return false;
    this.pulled.point.addScaledVector(this.stage.forward(), -0.01 * this.stage.size * notches);
    this.lead();
    return true;
  }

  up({offsetX: x, offsetY: y, timeStamp: time, type}) {
    const {press, last} = this;
    this.press = null;
    if (!press || press.moves || type === 'pointercancel') return;
    const isSecond =
      last && time - last.time < twice.within && Math.hypot(x - last.x, y - last.y) < twice.near;
    this.last = isSecond ? null : {x, y, time};
    if (press.isCut) return this.cut(press);
    if (isSecond) return this.tie();
    if (!this.pulled && press.hit) this.bite(press);
  }

  /** A line from where the thread went in to what the pointer is over. */
  hover(hit) {
    const from = this.marks.at(-1)?.ball.position,
      isShown = Boolean(hit && from && !this.pulled);
    if (!isShown && !this.line.visible) return;
    this.line.visible = isShown;
    if (isShown) {
      const {position} = this.line.geometry.attributes;
      from.toArray(position.array, 0);
      hit.point.toArray(position.array, 3);
      position.needsUpdate = true;
    }
    this.stage.invalidate();
  }

  /** The ends fall out of the hand; if they are in none, the thread leaves the needle as it is. */
  drop() {
    if (this.pulled) {
      this.ask({do: 'drop_thread', thread: this.thread.number});
      this.pulled = null;
      return this.onPull(null);
    }
    if (this.thread) this.left.add(this.thread.number);
    this.thread = null;
    this.unmark();
  }

  // ---- What it does

  /** The thread in the needle, or the last one that is open after everything was put back. */
  current() {
    if (this.isUnsure && !this.thread) {
      const open = this.threads.findLast(thread => isOpen(thread) && !this.left.has(thread.thread));
      if (open) this.thread = {number: open.thread, bites: open.bites.length};
    }
    this.isUnsure = false;
    return this.thread;
  }

  bite({hit, ray}) {
    this.onAct();
    if (!this.current()) {
      this.highest = Math.max(this.highest, ...this.threads.map(({thread}) => thread)) + 1;
      this.thread = {number: this.highest, bites: 0};
      this.ask({do: 'thread', thread: this.highest, ...material});
    }
    const [from, along] = [this.organ.start(ray, hit), ray.direction].map(vector => vector.toArray());
    this.ask({do: 'stitch', thread: this.thread.number, from, along, depth: this.depth()});
    this.thread.bites += 1;
    const ball = new THREE.Mesh(this.ball, this.material);
    ball.renderOrder = 21;
    this.marks.push({place: anchorOf(this.organ, hit), ball});
    this.stage.scene.add(ball);
    this.follow();
  }

  tie() {
    const thread = this.current();
    if (!thread || thread.bites < 2)
      return this.onRefusal('A knot needs two places: click on both sides of the cut first.');
    this.onAct();
    this.ask({do: 'tie', thread: thread.number, first: 0, last: -1, tighten: 0});
    this.thread = this.pulled = null;
    this.onPull(null);
    this.unmark();
  }

  cut({ray, hit}) {
    if (!hit) return;
    this.onAct();
    const [from, along] = [this.organ.start(ray, hit), ray.direction].map(vector => vector.toArray());
    this.ask({do: 'cut_thread', from, along, within: thin * this.stage.metresPerPixel(hit.point)});
  }

  beginToPull(hit) {
    if (this.pulled) return;
    const thread = this.current();
    if (!thread || thread.bites === 0)
      return this.onRefusal('There is no thread to pull yet: click on both sides of the cut first.');
    if (!hit) return;
    this.onAct();
    this.pulled = {point: hit.point.clone(), isHeld: false};
    this.hover(null);
    this.send();
  }

  // No more often than the simulation listens.
  lead() {
    if (this.isLeading) return;
    this.isLeading = true;
    setTimeout(() => {
      this.isLeading = false;
      if (this.pulled) this.send();
    }, pace);
  }

  send() {
    this.ask({do: 'pull_thread', thread: this.thread.number, to: this.pulled.point.toArray()});
  }

  unmark() {
    for (const {ball} of this.marks) this.stage.scene.remove(ball);
    this.marks = [];
    this.line.visible = false;
    this.stage.invalidate();
  }
}
