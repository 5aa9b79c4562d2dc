// What mouse, pen or finger do on the canvas: left on the organ acts, anything else moves the camera.
import * as THREE from './third_party/three-0.187.0/three.module.js';

const grasp = {kind: 'grasp', radius: 0.012},
  cauteryRadius = 0.0055, // [m]
  blade = {depth: 0.02, above: 0.03}, // of the tip below where it begins, of the heel towards the viewer [m]
  probe = {radius: 0.01, press: 0.006}, // of its tip; how far that is pressed in [m]
  // Width, thickness and length of each; how far they are apart, how far they reach behind the point that was
  // clicked, from how far they come, and from how near to where they are led they close [m].
  jaws = {size: [0.03, 0.014, 0.05], opening: 0.1, depth: 0.035, from: 0.05, there: 0.003},
  betweenPoses = 7; // [ms]

export class Hands {
  constructor(stage, organ, ask) {
    this.stage = stage;
    this.organ = organ;
    this.ask = ask;
    this.kind = 'grasp';
    this.may = false; // this page controls
    this.held = new Map(); // hands that were left where they are: number → {kind, point}
    this.active = null; // {hand, kind, point, offset}
    this.camera = null; // 'turn' or 'shift'
    this.onFirst = () => {};
    this.brush = null; // of the editor: {paint(point), end()}
    const canvas = stage.canvas;
    canvas.addEventListener('pointerdown', event => this.down(event));
    canvas.addEventListener('pointermove', event => this.move(event));
    // Where there are such events, a pull need not wait for the next picture to be drawn.
    canvas.addEventListener('pointerrawupdate', event => this.active?.kind === 'grasp' && this.move(event));
    canvas.addEventListener('pointerup', event => this.up(event));
    canvas.addEventListener('pointercancel', event => this.up(event));
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('dblclick', () => this.releaseHeld());
    canvas.addEventListener('wheel', event => this.wheel(event), {passive: false});
    this.ring = makeRing();
    stage.scene.add(this.ring);
  }

  setKind(kind) {
    this.letGo();
    this.kind = kind;
    this.ring.visible = false;
    this.stage.canvas.classList.toggle('cautery', kind === 'cautery' || kind === 'scalpel');
    this.stage.canvas.classList.toggle('paint', kind === 'paint');
    this.stage.invalidate();
  }

  reach() {
    return this.kind === 'cautery'
      ? cauteryRadius
      : this.kind === 'paint'
        ? this.brush.radius()
        : this.kind === 'scalpel'
          ? blade.depth / 5
          : this.kind === 'probe'
            ? probe.radius
            : this.kind === 'jaws'
              ? jaws.opening / 2
              : grasp.radius;
  }

  down(event) {
    this.stage.canvas.focus();
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.last = {x: event.offsetX, y: event.offsetY};
    if (event.button === 0 && this.may && !event.altKey) {
      const ray = this.stage.ray(event.offsetX, event.offsetY);
      if (this.kind !== 'paint' && this.takeHeld(event)) return;
      const hit = this.organ.hit(ray);
      if (hit) return this.begin(hit, ray);
    }
    this.camera = event.button === 1 || (event.button === 2 && event.shiftKey) ? 'shift' : 'turn';
  }

  begin(hit, ray) {
    this.onFirst();
    if (this.kind === 'paint') {
      this.active = {kind: 'paint'};
      return this.brush.paint(this.organ.restOf(hit));
    }
    const hand = this.freeHand();
    if (hand < 0) return;
    this.active = {hand, kind: this.kind, point: hit.point.clone()};
    this.stage.canvas.classList.add('holding');
    if (this.kind === 'scalpel') this.bringBlade(hand);
    else if (this.kind === 'probe') this.bringProbe(hand, hit);
    else if (this.kind === 'jaws') this.bringJaws(hand, hit);
    else if (this.kind === 'cautery') this.ask({do: 'burn', hand, at: hit.point.toArray(), radius: cauteryRadius});
    else
      this.ask({
        do: 'take',
        hand,
        from: ray.origin.toArray(),
        along: ray.direction.toArray(),
        radius: grasp.radius,
      });
  }

  // It points away from the viewer, and is drawn through the tissue at the depth where it began.
  bringBlade(hand) {
    const forward = this.stage.forward(),
      heel = this.active.point.clone().addScaledVector(forward, -blade.above);
    this.active.point.addScaledVector(forward, blade.depth);
    this.ask({do: 'cut', hand, tip: this.active.point.toArray(), heel: heel.toArray()});
  }

  // It comes from the viewer's side, and is pressed in by a little.
  bringProbe(hand, hit) {
    const forward = this.stage.forward(),
      {radius, press} = probe;
    const outside = hit.point.clone().addScaledVector(forward, -1.5 * radius);
    this.ask({do: 'touch', hand, at: outside.toArray(), radius});
    this.active.point.addScaledVector(forward, press - radius);
    this.lead();
  }

  // They come open from the viewer's side, one above the other, and reach behind the point.
  bringJaws(hand, hit) {
    this.showRing(null, null);
    const forward = this.stage.forward(),
      above = this.stage.above(),
      axes = new THREE.Matrix4().makeBasis(new THREE.Vector3().crossVectors(above, forward), above, forward);
    this.active.point.copy(hit.point).addScaledVector(forward, jaws.depth - jaws.size[2]);
    this.ask({
      do: 'jaws',
      hand,
      at: this.active.point.clone().addScaledVector(forward, -jaws.from).toArray(),
      orientation: new THREE.Quaternion().setFromRotationMatrix(axes).toArray(),
      size: jaws.size,
      opening: jaws.opening,
    });
    this.lead();
  }

  /** Jaws close where they have been led to. */
  follow(tools) {
    const {kind, hand, point, closes} = this.active ?? {};
    if (kind !== 'jaws' || closes) return;
    const tool = tools.find(tool => tool.hand === hand && tool.jaw);
    if (!tool || point.distanceTo(new THREE.Vector3(...tool.position)) > jaws.there) return;
    this.active.closes = true;
    this.ask({do: 'close', hand, on: true});
  }

  freeHand() {
    for (let hand = 0; hand < 8; ++hand) if (!this.held.has(hand)) return hand;
    return -1;
  }

  /** A hand that was left holding, under the pointer. */
  takeHeld(event) {
    for (const [hand, {kind, point}] of this.held) {
      const at = this.stage.project(point);
      if (!at || Math.hypot(at.x - event.offsetX, at.y - event.offsetY) > 24) continue;
      this.held.delete(hand);
      this.active = {hand, kind, point: point.clone(), closes: true};
      this.stage.canvas.classList.add('holding');
      return true;
    }
    return false;
  }

  move(event) {
    const dx = event.offsetX - (this.last?.x ?? event.offsetX),
      dy = event.offsetY - (this.last?.y ?? event.offsetY);
    this.last = {x: event.offsetX, y: event.offsetY};
    if (this.camera) return this.camera === 'turn' ? this.stage.turn(dx, dy) : this.stage.shift(dx, dy);
    if (this.active) return this.drag(event, dx, dy);
    this.hover(event);
  }

  drag(event, dx, dy) {
    const {kind} = this.active;
    if (kind === 'paint' || kind === 'cautery') {
      const hit = this.organ.hit(this.stage.ray(event.offsetX, event.offsetY));
      if (!hit) return;
      this.showRing(hit.point, hit);
      if (kind === 'paint') return this.brush.paint(this.organ.restOf(hit));
      this.active.point.copy(hit.point);
    } else {
      this.showRing(null, null);
      const scale = this.stage.metresPerPixel(this.active.point);
      this.active.point
        .addScaledVector(this.stage.right(), dx * scale)
        .addScaledVector(this.stage.above(), -dy * scale);
    }
    this.lead(event.timeStamp);
  }

  // No more often than the simulation listens: the newest pose is the one that counts.
  lead(since) {
    if (this.isLeading) return;
    this.isLeading = true;
    const send = () => {
      this.isLeading = false;
      this.ledAt = performance.now();
      const {point, hand} = this.active ?? {};
      if (point) this.ask({do: 'lead', hand, to: point.toArray()}, since);
    };
    const wait = (this.ledAt ?? 0) + betweenPoses - performance.now();
    if (wait > 0) setTimeout(send, wait);
    else send();
  }

  wheel(event) {
    event.preventDefault();
    const notches = event.deltaY / (event.deltaMode === 1 ? 3 : 100);
    if (!this.active?.point) return this.stage.zoom(1.12 ** notches);
    this.active.point.addScaledVector(this.stage.forward(), -0.004 * notches);
    this.lead(event.timeStamp);
  }

  up(event) {
    if (this.camera) {
      this.camera = null;
      return;
    }
    if (!this.active) return;
    if (this.active.kind === 'paint') {
      this.brush.end();
      this.active = null;
      return;
    }
    if (event.shiftKey && holds(this.active)) this.keep();
    else this.letGo();
  }

  /** The hand goes on holding where it is. */
  keep() {
    if (!holds(this.active)) return;
    const {hand, kind, point} = this.active;
    this.held.set(hand, {kind, point});
    this.active = null;
    this.stage.canvas.classList.remove('holding');
  }

  letGo() {
    this.stage.canvas.classList.remove('holding');
    if (this.active?.point) this.ask({do: 'let_go', hand: this.active.hand});
    this.active = null;
  }

  releaseHeld() {
    for (const hand of this.held.keys()) this.ask({do: 'let_go', hand});
    this.held.clear();
    this.letGo();
  }

  /** The server has let go of everything. */
  forget() {
    this.held.clear();
    this.active = null;
    this.camera = null;
    this.stage.canvas.classList.remove('holding');
  }

  hover(event) {
    const hit = this.may ? this.organ.hit(this.stage.ray(event.offsetX, event.offsetY)) : null;
    this.stage.canvas.classList.toggle('away', !hit && this.kind === 'grasp');
    this.showRing(hit?.point, hit);
  }

  showRing(point, hit) {
    const visible = Boolean(hit);
    if (!visible && !this.ring.visible) return;
    this.ring.visible = visible;
    if (visible) {
      this.ring.position.copy(point).addScaledVector(this.stage.forward(), -0.004);
      this.ring.quaternion.copy(this.stage.camera.quaternion);
      this.ring.scale.setScalar(this.reach());
    }
    this.stage.invalidate();
  }
}

/** Whether a hand may be left as it is: its instrument has hold of the organ. */
const holds = active => active?.kind === 'grasp' || (active?.kind === 'jaws' && active.closes);

function makeRing() {
  const ring = new THREE.Mesh(
    new THREE.RingGeometry(0.94, 1, 64),
    new THREE.MeshBasicMaterial({
      color: 0xffffff,
      transparent: true,
      opacity: 0.55,
      depthTest: false,
      toneMapped: false,
    }),
  );
  ring.renderOrder = 20;
  ring.visible = false;
  return ring;
}
