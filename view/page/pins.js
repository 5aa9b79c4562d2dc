// Places of the organ that a scene is to fix when it is made anew. They are drawn where they are now.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {anchorOf, pointOf} from './anchors.js';

const colour = 0xffd46b,
  near = 16; // of a pin [pixels]

export class Pins {
  constructor(stage, organ) {
    this.stage = stage;
    this.organ = organ;
    this.isSetting = false; // a click sets one, or takes it out
    this.isShown = false;
    this.onChange = () => {};
    this.list = []; // {place (anchors.js), ball}
    this.geometry = new THREE.SphereGeometry(1, 20, 14);
    this.material = new THREE.MeshBasicMaterial({color: colour, depthTest: false, transparent: true, opacity: 0.9});
  }

  /** @param {number[][]} places at rest [m] */
  set(places) {
    for (const {ball} of this.list) this.stage.scene.remove(ball);
    this.list = [];
    for (const at of places) this.add({smooth: null, rest: new THREE.Vector3(...at)});
    this.follow();
  }

  places() {
    return this.list.map(({place}) => place.rest.toArray());
  }

  show(on) {
    this.isShown = on;
    this.follow();
  }

  /** Returns whether there was something to do. */
  click(hit, x, y) {
    const at = this.list.findIndex(({ball}) => {
      const shown = this.stage.project(ball.position);
      return shown && Math.hypot(shown.x - x, shown.y - y) < near;
    });
    if (at >= 0) this.stage.scene.remove(...this.list.splice(at, 1).map(({ball}) => ball));
    else if (hit) this.add(anchorOf(this.organ, hit));
    else return false;
    this.follow();
    this.onChange();
    return true;
  }

  add(place) {
    const ball = new THREE.Mesh(this.geometry, this.material);
    ball.renderOrder = 21;
    this.stage.scene.add(ball);
    this.list.push({place, ball});
  }

  /** The organ has moved. */
  follow() {
    for (const {place, ball} of this.list) {
      ball.visible = this.isShown && Boolean(this.organ.smooth);
      if (!ball.visible) continue;
      ball.position.copy(pointOf(this.organ, place));
      ball.scale.setScalar(0.02 * this.stage.size);
    }
    this.stage.invalidate();
  }
}
