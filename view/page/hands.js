// What mouse, pen or finger do on the canvas: left on the organ acts, anything else moves the camera.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {bringing} from './bring.js';
import {makeRing} from './ring.js';
import {Blade, BladeGhost} from './scalpel.js';

const nearby = 60, // from how far beside the organ a hook begins [pixels]
  closing = 0.3, // until a clip has closed, after which its applier goes [s]
  betweenPoses = 7; // [ms]

export class Hands {
  /** @param {ToolSizes} sizes (tool_sizes.js) @param {DepthGauge} gauge (depth_gauge.js) */
  constructor(stage, organ, ask, sizes, gauge) {
    this.stage = stage;
    this.organ = organ;
    this.ask = ask;
    this.sizes = sizes;
    this.gauge = gauge;
    this.kind = 'grasp';
    this.may = false; // this page controls
    this.held = new Map(); // hands that were left where they are: number → {kind, point}
    this.actives = new Map(); // hands that move: pointer → {hand, kind, point}
    this.closing = new Map(); // hands that close a clip: number → {asked [ms], since [s]}
    this.pedal = false; // pressed: hooks burn
    this.camera = new Set(); // pointers that move the camera
    this.cameraDoes = 'turn'; // or 'shift'; two of them zoom and shift
    this.last = new Map(); // where each pointer was
    this.onAct = () => {}; // told which instrument begins
    this.onHover = () => {}; // told what the pointer is over, and where: (hit, x, y); null: over nothing
    this.onRefusal = () => {}; // told why an instrument does not begin
    this.onEntry = () => {}; // told where a blade enters the organ: (hit)
    this.onBlade = () => {}; // told of a blade that cuts (scalpel.js); null: there is none any more
    this.tape = null; // with begin(hit) and reach(hit)
    this.pins = null; // with click(hit, x, y), while they are set
    this.needle = null; // stitch.js
    this.brush = null; // of the editor: {paint(point), end()}
    const canvas = stage.canvas;
    canvas.addEventListener('pointerdown', event => this.down(event));
    canvas.addEventListener('pointermove', event => this.move(event));
    // Where there are such events, a pull need not wait for the next picture to be drawn.
    canvas.addEventListener(
      'pointerrawupdate',
      event => this.actives.get(event.pointerId)?.kind === 'grasp' && this.move(event),
    );
    canvas.addEventListener('pointerup', event => this.up(event));
    canvas.addEventListener('pointercancel', event => this.up(event));
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('dblclick', () => this.kind === 'stitch' || this.releaseHeld()); // or it ties
    canvas.addEventListener('wheel', event => this.wheel(event), {passive: false});
    canvas.addEventListener('pointerleave', () => this.showNothing());
    this.ring = makeRing();
    stage.scene.add(this.ring);
    this.ghost = new BladeGhost(stage);
  }

  setKind(kind) {
    this.letGo();
    if (this.needle?.pulled && kind !== 'stitch') this.needle.drop();
    this.kind = kind;
    this.sizes.setKind(kind);
    this.hideBlade();
    this.ring.visible = false;
    const aims = ['cautery', 'scalpel', 'hook', 'clip', 'measure', 'stitch'].includes(kind);
    this.stage.canvas.classList.toggle('cautery', aims);
    this.stage.canvas.classList.toggle('paint', kind === 'paint');
    this.stage.invalidate();
  }

  /** The hand that began first, of those that move. */
  get active() {
    return this.actives.values().next().value ?? null;
  }

  /** The radius of the ring [m]. */
  reach() {
    if (this.kind === 'paint') return this.brush.radius();
    if (['scalpel', 'measure', 'stitch'].includes(this.kind)) return 0.03 * this.stage.size;
    return this.sizes.of(this.kind) * (['jaws', 'clip', 'hook'].includes(this.kind) ? 0.5 : 1);
  }

  down(event) {
    const {pointerId, offsetX: x, offsetY: y} = event;
    this.stage.canvas.focus();
    if (pointerId >= 0) this.stage.canvas.setPointerCapture(pointerId);
    this.last.set(pointerId, {x, y});
    // A second finger zooms where the first one moves the camera; otherwise it is a second hand.
    if (event.button === 0 && (this.may || this.kind === 'measure') && !event.altKey && this.camera.size === 0) {
      const ray = this.stage.ray(x, y);
      if (this.pins?.isSetting && this.pins.click(this.organ.hit(ray), x, y)) return this.last.delete(pointerId);
      if (this.may && this.kind !== 'paint' && this.takeHeld(event)) return;
      const hit = this.organ.hit(ray);
      if (this.kind === 'stitch' && this.needle.down(event, hit, ray))
        return this.actives.set(pointerId, {kind: 'stitch'});
      if (hit) return this.begin(pointerId, hit, ray);
      const beside = this.kind === 'hook' && this.organ.beside(x, y, nearby);
      if (beside) return this.begin(pointerId, {point: beside, isBeside: true}, ray);
    }
    this.camera.add(pointerId);
    this.cameraDoes = event.button === 1 || (event.button === 2 && event.shiftKey) ? 'shift' : 'turn';
  }

  begin(pointer, hit, ray) {
    const {kind} = this,
      brought = bringing[kind]?.(this.stage, hit, this.sizes.of(kind), this.organ);
    if (typeof brought === 'string') return this.onRefusal(brought);
    const hand = this.freeHand();
    if (hand < 0) return;
    this.onAct(kind);
    this.onHover(null);
    const active = {hand, kind, point: hit.point.clone()};
    this.actives.set(pointer, active);
    if (kind === 'paint' || kind === 'measure') {
      this.actives.set(pointer, {kind});
      return kind === 'paint' ? this.brush.paint(this.organ.restOf(hit)) : this.tape.begin(hit);
    }
    this.stage.canvas.classList.add('holding');
    if (brought) this.beginWith(brought, active);
    else if (kind === 'scalpel') this.bringBlade(active, hit);
    else this.takeHold(hand, ray, hit);
  }

  beginWith({tool, on, point, there}, active) {
    Object.assign(active, {point, there});
    this.bring(active.hand, tool, on);
    if (on) return;
    if (active.kind === 'hook') this.burnWith(active);
    this.showRing(null, null);
    this.lead(active);
  }

  takeHold(hand, ray, hit) {
    const [from, along] = [this.organ.start(ray, hit), ray.direction].map(vector => vector.toArray());
    this.ask({do: 'take', hand, from, along, radius: this.sizes.of('grasp')});
  }

  /** @param tool as a scene says it, with "at" in place of "path" @param on whether it works at once */
  bring(hand, tool, on = false) {
    this.ask({do: 'bring', hand, tool});
    if (on) this.ask({do: 'turn_on', hand, on});
  }

  bringBlade(active, hit) {
    this.ghost.hide();
    const blade = new Blade(this.stage, this.organ, hit, this.sizes.of('scalpel'));
    Object.assign(active, {blade, point: blade.tip});
    this.onEntry(hit, blade);
    this.showBlade(active);
    this.bring(active.hand, {type: 'scalpel', at: [...blade.tip.toArray(), ...blade.heel.toArray()]}, true);
  }

  showBlade({blade}) {
    const at = this.stage.project(blade.surface);
    if (at) this.gauge.show(at.x, at.y, blade.depth, blade.thickness);
    this.onBlade(blade);
  }

  /** Jaws close where they have been led to; the applier goes when its clip has closed.
   *  @param {number} time of the simulation [s] */
  follow(tools, time) {
    for (const [hand, clip] of this.closing) {
      if (tools.some(tool => tool.hand === hand && tool.on)) clip.since ??= time;
      const isLate = clip.since === undefined && performance.now() > clip.asked + 1e4;
      if (!isLate && !(Math.abs(time - clip.since) > closing)) continue;
      this.closing.delete(hand);
      this.ask({do: 'let_go', hand});
    }
    for (const active of this.actives.values()) {
      const {kind, hand, point, closes, there} = active;
      if (kind !== 'jaws' || closes) continue;
      const tool = tools.find(tool => tool.hand === hand && tool.jaw);
      if (!tool || point.distanceTo(new THREE.Vector3(...tool.position)) > there) continue;
      active.closes = true;
      this.ask({do: 'turn_on', hand, on: true});
    }
  }

  /** Whether a hand has an instrument, or the camera. */
  isBusy() {
    return this.actives.size + this.camera.size + this.held.size > 0 || Boolean(this.needle.pulled);
  }

  freeHand() {
    const moving = new Set([...this.actives.values()].map(({hand}) => hand)),
      isFree = hand => !this.held.has(hand) && !moving.has(hand) && !this.closing.has(hand);
    for (let hand = 0; hand < 8; ++hand) if (isFree(hand)) return hand;
    return -1;
  }

  /** A hand that was left holding, under the pointer. */
  takeHeld(event) {
    for (const [hand, {kind, point}] of this.held) {
      const at = this.stage.project(point);
      if (!at || Math.hypot(at.x - event.offsetX, at.y - event.offsetY) > 24) continue;
      this.held.delete(hand);
      this.actives.set(event.pointerId, {hand, kind, point: point.clone(), closes: true});
      this.stage.canvas.classList.add('holding');
      return true;
    }
    return false;
  }

  move(event) {
    const {pointerId, offsetX: x, offsetY: y} = event,
      last = this.last.get(pointerId);
    const active = this.actives.get(pointerId);
    if (!last || (!active && !this.camera.has(pointerId))) return this.hover(event);
    const dx = x - last.x,
      dy = y - last.y;
    this.last.set(pointerId, {x, y});
    if (active) return this.drag(active, event, dx, dy);
    if (this.camera.size > 1) return this.pinch(pointerId, dx, dy);
    if (this.cameraDoes === 'turn') this.stage.turn(dx, dy);
    else this.stage.shift(dx, dy);
  }

  // Of two fingers one has moved: what is between them stays between them.
  pinch(pointer, dx, dy) {
    const other = [...this.camera].find(id => id !== pointer),
      at = this.last.get(pointer),
      from = this.last.get(other);
    const now = Math.hypot(at.x - from.x, at.y - from.y),
      before = Math.hypot(at.x - dx - from.x, at.y - dy - from.y);
    if (now > 1 && before > 1) this.stage.zoom(before / now);
    this.stage.shift(dx / 2, dy / 2);
  }

  drag(active, event, dx, dy) {
    const {kind} = active;
    if (kind === 'stitch') return this.needle.drag(event, dx, dy);
    if (kind === 'paint' || kind === 'cautery' || kind === 'measure') {
      const hit = this.organ.hit(this.stage.ray(event.offsetX, event.offsetY));
      if (!hit) return;
      this.showRing(hit.point, hit);
      if (kind === 'paint') return this.brush.paint(this.organ.restOf(hit));
      if (kind === 'measure') return this.tape.reach(hit);
      active.point.copy(hit.point);
    } else if (kind === 'scalpel') {
      this.showRing(null, null);
      const hit = this.organ.hit(this.stage.ray(event.offsetX, event.offsetY));
      if (active.blade.slide(hit, dx, dy)) this.onEntry(hit, active.blade);
      this.showBlade(active);
    } else {
      this.showRing(null, null);
      const scale = this.stage.metresPerPixel(active.point);
      active.point
        .addScaledVector(this.stage.right(), dx * scale)
        .addScaledVector(this.stage.above(), -dy * scale);
    }
    if (kind === 'hook') this.burnWith(active, event.buttons & 2);
    this.lead(active, event.timeStamp);
  }

  /** Hooks burn while it is pressed. */
  setPedal(on) {
    if (this.pedal === on) return;
    this.pedal = on;
    for (const active of this.actives.values()) if (active.kind === 'hook') this.burnWith(active);
  }

  /** @param [button] whether its own button burns, too */
  burnWith(active, button = active.button) {
    active.button = button;
    const on = this.pedal || Boolean(button);
    if (on === Boolean(active.burns)) return;
    active.burns = on;
    this.ask({do: 'turn_on', hand: active.hand, on});
  }

  // No more often than the simulation listens: the newest pose is the one that counts.
  lead(active, since) {
    if (active.isLeading) return;
    active.isLeading = true;
    const send = () => {
      active.isLeading = false;
      active.ledAt = performance.now();
      const moves = [...this.actives.values()].includes(active);
      if (moves && active.point) this.ask({do: 'lead', hand: active.hand, to: active.point.toArray()}, since);
    };
    const wait = (active.ledAt ?? 0) + betweenPoses - performance.now();
    if (wait > 0) setTimeout(send, wait);
    else send();
  }

  wheel(event) {
    event.preventDefault();
    const notches = event.deltaY / (event.deltaMode === 1 ? 3 : 100);
    const {active} = this;
    if (this.kind === 'stitch' && this.needle.wheel(notches)) return;
    if (!active?.point) return this.stage.zoom(1.12 ** notches);
    if (active.blade) {
      active.blade.turnWheel(notches);
      this.showBlade(active);
    } else {
      active.point.addScaledVector(this.stage.forward(), -0.03 * this.stage.size * notches);
    }
    this.lead(active, event.timeStamp);
  }

  up(event) {
    const {pointerId} = event,
      active = this.actives.get(pointerId);
    this.last.delete(pointerId);
    this.camera.delete(pointerId);
    if (!active) return;
    if (active.kind === 'paint' || active.kind === 'stitch') {
      if (active.kind === 'paint') this.brush.end();
      else this.needle.up(event);
      this.actives.delete(pointerId);
    } else if (active.kind === 'clip' && event.type !== 'pointercancel') {
      this.close(pointerId);
    } else if (event.shiftKey && holds(active)) {
      this.keep();
    } else {
      this.end(pointerId);
    }
  }

  /** A clip closes where its applier is. */
  close(pointer) {
    const {hand} = this.actives.get(pointer);
    this.actives.delete(pointer);
    this.closing.set(hand, {asked: performance.now()});
    this.ask({do: 'turn_on', hand, on: true});
    this.showHolding();
  }

  /** The hands that have hold of something go on holding where they are. */
  keep() {
    for (const [pointer, active] of this.actives) {
      if (!holds(active)) continue;
      const {hand, kind, point} = active;
      this.held.set(hand, {kind, point});
      this.actives.delete(pointer);
    }
    this.showHolding();
  }

  end(pointer) {
    const {kind, hand, point} = this.actives.get(pointer);
    if (point) this.ask({do: 'let_go', hand});
    if (kind === 'scalpel') {
      this.gauge.hide();
      this.onBlade(null);
    }
    this.actives.delete(pointer);
    this.showHolding();
  }

  showHolding() {
    this.stage.canvas.classList.toggle('holding', this.actives.size > 0);
  }

  letGo() {
    for (const pointer of [...this.actives.keys()]) this.end(pointer);
  }

  releaseHeld() {
    for (const hand of this.held.keys()) this.ask({do: 'let_go', hand});
    this.held.clear();
    this.letGo();
    if (this.kind === 'stitch') this.needle.drop();
  }

  /** The server has let go of everything. */
  forget() {
    this.held.clear();
    this.actives.clear();
    this.closing.clear();
    this.camera.clear();
    this.needle?.forget();
    this.hideBlade();
    this.showHolding();
  }

  hover(event) {
    const hit = this.may || this.kind === 'measure' ? this.organ.hit(this.stage.ray(event.offsetX, event.offsetY)) : null;
    this.stage.canvas.classList.toggle('away', !hit && this.kind === 'grasp');
    this.showRing(hit?.point, hit);
    this.onHover(hit, event.offsetX, event.offsetY);
    if (this.kind === 'stitch') this.needle.hover(hit);
    if (this.kind !== 'scalpel') return;
    if (!hit) return this.hideBlade();
    const depth = this.sizes.of('scalpel');
    this.gauge.show(
      event.offsetX,
      event.offsetY,
      depth,
      this.organ.thickness(hit.point, this.stage.forward()),
    );
    this.ghost.show(hit.point, depth);
  }

  /** That which has not begun to cut. */
  hideBlade() {
    this.gauge.hide();
    this.ghost.hide();
  }

  showNothing() {
    if (this.actives.size > 0) return;
    this.showRing(null, null);
    this.onHover(null);
    this.hideBlade();
  }

  showRing(point, hit) {
    const visible = Boolean(hit);
    if (!visible && !this.ring.visible) return;
    this.ring.visible = visible;
    if (visible) {
      this.ring.position.copy(point).addScaledVector(this.stage.forward(), -0.03 * this.stage.size);
      this.ring.quaternion.copy(this.stage.camera.quaternion);
      this.ring.scale.setScalar(this.reach());
    }
    this.stage.invalidate();
  }
}

/** Whether a hand may be left as it is: its instrument has hold of the organ. */
const holds = active => active?.kind === 'grasp' || (active?.kind === 'jaws' && active.closes);
