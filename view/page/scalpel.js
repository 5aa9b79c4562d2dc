// Where the blade of a scalpel is while a pointer leads it. It points away from the viewer. Its tip is a
// depth below the surface under the pointer. Its heel is outside wherever the tip is, so that the cut is open
// to the viewer.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {ghostOfScalpel} from './instruments.js';

const least = 0.1, // depth, of the one it began with
  outside = 0.15, // by what the heel is outside, of the organ's radius
  // How much deeper the surface may be than a moment before: at least, of the organ's radius, and of the way
  // aside.
  step = 0.023,
  slope = 1.5,
  longest = 0.99; // that the simulation takes [m]

/** Where the blade would be if it began to cut under the pointer. */
export class BladeGhost {
  constructor(stage) {
    this.stage = stage;
    this.body = ghostOfScalpel();
    stage.scene.add(this.body);
  }

  /** @param {THREE.Vector3} point of the surface @param {number} depth below it [m] */
  show(point, depth) {
    const {stage, body} = this;
    body.visible = true;
    body.position.copy(point).addScaledVector(stage.forward(), depth);
    body.quaternion.copy(stage.camera.quaternion);
    body.userData.fit(depth + outside * stage.size, 0.2 * stage.size);
    stage.invalidate();
  }

  hide() {
    if (!this.body.visible) return;
    this.body.visible = false;
    this.stage.invalidate();
  }
}

export class Blade {
  /** @param {{point: THREE.Vector3}} hit where it enters the organ @param {number} depth [m] */
  constructor(stage, organ, hit, depth) {
    this.stage = stage;
    this.organ = organ;
    this.surface = hit.point.clone();
    this.forward = stage.forward();
    this.outside = outside * stage.size;
    this.length = Math.min(longest, organ.extent(this.forward) + this.outside);
    this.begun = this.depth = depth;
    this.tip = new THREE.Vector3();
    this.deepen(0);
    this.heel = this.tip.clone().addScaledVector(this.forward, -this.length); // where it began
    this.thickness = organ.thickness(this.surface, this.forward); // of the organ, there [m]
  }

  /** By so many notches of a wheel. */
  turnWheel(notches) {
    this.deepen(-0.2 * notches * this.begun);
  }

  deepen(by) {
    this.depth = Math.max(least * this.begun, Math.min(this.length - this.outside, this.depth + by));
    this.tip.copy(this.surface).addScaledVector(this.forward, this.depth);
  }

  /**
   * It follows the surface under the pointer; where that is none, or falls off, as in a cut that gapes, it
   * stays as far from the viewer.
   * @param {{point: THREE.Vector3}|null} hit of the ray through the pointer
   * @returns {boolean} whether it enters the organ there
   */
  slide(hit, dx, dy) {
    const {surface, forward, stage} = this,
      scale = stage.metresPerPixel(surface);
    surface.addScaledVector(stage.right(), dx * scale).addScaledVector(stage.above(), -dy * scale);
    const falls = hit ? hit.point.clone().sub(surface).dot(forward) : Infinity;
    const isThere = falls < Math.max(step * stage.size, slope * Math.hypot(dx, dy) * scale);
    if (isThere) surface.copy(hit.point);
    this.thickness = this.organ.thickness(surface, forward) || this.thickness;
    this.deepen(0);
    return isThere;
  }
}
