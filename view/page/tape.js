// A tape between two places of the organ's skin, which follows them as the organ moves.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {anchorOf, pointOf} from './anchors.js';
import {inMillimetres} from './tool_sizes.js';

const colour = 0x9fe8ff;

export class Tape {
  constructor(stage, organ, labels) {
    this.stage = stage;
    this.organ = organ;
    this.ends = []; // where on the organ (anchors.js)
    this.points = [];
    this.line = new THREE.Line(
      new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3()]),
      new THREE.LineBasicMaterial({color: colour, depthTest: false, transparent: true}),
    );
    this.line.frustumCulled = false;
    this.line.renderOrder = 21;
    this.dots = [0, 1].map(
      () => new THREE.Mesh(new THREE.SphereGeometry(1, 16, 12), new THREE.MeshBasicMaterial({color: colour})),
    );
    stage.scene.add(this.line, ...this.dots);
    this.label = document.createElement('span');
    labels.append(this.label);
    stage.after.push(() => this.placeLabel());
    this.clear();
  }

  clear() {
    this.ends = [];
    this.follow();
  }

  /** From a place that a ray has hit. */
  begin(hit) {
    this.ends = [anchorOf(this.organ, hit), anchorOf(this.organ, hit)];
    this.follow();
  }

  /** To another one. */
  reach(hit) {
    this.ends[1] = anchorOf(this.organ, hit);
    this.follow();
  }

  /** Where its ends are now; and what is between them [m]. */
  follow() {
    this.points = this.ends.map(end => pointOf(this.organ, end));
    const isShown = this.points.length === 2;
    this.line.visible = isShown;
    for (const dot of this.dots) dot.visible = isShown;
    this.label.hidden = !isShown;
    this.stage.invalidate();
    if (!isShown) return;
    const {position} = this.line.geometry.attributes;
    this.points.forEach((point, i) => {
      point.toArray(position.array, 3 * i);
      this.dots[i].position.copy(point);
      this.dots[i].scale.setScalar(0.012 * this.stage.size);
    });
    position.needsUpdate = true;
    this.label.textContent = inMillimetres(this.length());
  }

  length() {
    return this.points.length === 2 ? this.points[0].distanceTo(this.points[1]) : 0;
  }

  placeLabel() {
    if (this.label.hidden) return;
    const at = this.stage.project(this.points[0].clone().lerp(this.points[1], 0.5));
    if (at) this.label.style.transform = `translate(${Math.round(at.x + 12)}px, ${Math.round(at.y - 30)}px)`;
  }
}
