// A plane through the organ: what is nearer to the viewer is not drawn, and where the plane meets the organ a
// face closes it. Nothing is cut by that.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {light} from './colours.js';

const faceColour = light([0.47, 0.15, 0.13]);

export class Section {
  constructor(stage, organ) {
    this.stage = stage;
    this.organ = organ;
    this.plane = new THREE.Plane();
    this.isOn = false;
    this.depth = 0.5; // of the organ's extent along the plane's normal
    this.makeFace();
    stage.before.push(() => this.isOn && this.follow());
    stage.onLook.push(() => this.isOn && this.dress());
  }

  // Behind each place of the plane there is organ where more of its surface looks away from the viewer than
  // towards: that is counted in the stencil, and the face drawn where it is not 0.
  makeFace() {
    const count = (side, change) =>
      new THREE.Mesh(
        new THREE.BufferGeometry(),
        new THREE.MeshBasicMaterial({
          side,
          clippingPlanes: [this.plane],
          colorWrite: false,
          depthWrite: false,
          depthTest: false,
          stencilWrite: true,
          stencilFunc: THREE.AlwaysStencilFunc,
          stencilFail: change,
          stencilZFail: change,
          stencilZPass: change,
        }),
      );
    this.counts = [
      count(THREE.BackSide, THREE.IncrementWrapStencilOp),
      count(THREE.FrontSide, THREE.DecrementWrapStencilOp),
    ];
    this.face = new THREE.Mesh(
      new THREE.PlaneGeometry(2, 2),
      new THREE.MeshBasicMaterial({
        color: new THREE.Color(...faceColour),
        side: THREE.DoubleSide,
        toneMapped: false,
        stencilWrite: true,
        stencilFunc: THREE.NotEqualStencilFunc,
        stencilFail: THREE.ReplaceStencilOp,
        stencilZFail: THREE.ReplaceStencilOp,
        stencilZPass: THREE.ReplaceStencilOp,
      }),
    );
    this.face.renderOrder = 2;
    for (const mesh of this.counts) {
      mesh.renderOrder = 1;
      mesh.frustumCulled = false;
    }
    this.group = new THREE.Group();
    this.group.add(...this.counts, this.face);
    this.group.visible = false;
    this.stage.scene.add(this.group);
  }

  /** Across the way in which the viewer looks now. */
  setOn(on) {
    this.isOn = this.group.visible = on;
    this.stage.renderer.localClippingEnabled = on;
    if (on) {
      this.plane.normal.copy(this.stage.forward());
      this.follow();
    }
    this.dress();
    this.stage.invalidate();
  }

  /** How deep it lies: 0 nearest to the viewer, 1 farthest. */
  setDepth(share) {
    this.depth = share;
    if (this.isOn) this.follow();
    this.stage.invalidate();
  }

  dress() {
    const planes = this.isOn ? [this.plane] : null,
      {mesh, lines, rim} = this.organ;
    for (const material of [...mesh.material, lines.material, rim.material]) {
      material.clippingPlanes = planes;
      material.needsUpdate = true;
    }
  }

  // The organ has moved, or has another surface.
  follow() {
    const {plane, organ, face} = this,
      {low, high} = organ.span(plane.normal);
    plane.constant = -(low + this.depth * (high - low));
    for (const mesh of this.counts) mesh.geometry = organ.mesh.geometry;
    plane.projectPoint(this.stage.target, face.position);
    face.lookAt(face.position.clone().add(plane.normal));
    face.scale.setScalar(3 * this.stage.size);
  }

  /** From where a ray meets only what is drawn. */
  start(ray) {
    if (this.shows(ray.origin)) return ray.origin.clone();
    return ray.intersectPlane(this.plane, new THREE.Vector3()) ?? ray.origin.clone();
  }

  /** Whether a point is drawn. */
  shows(point) {
    return !this.isOn || this.plane.distanceToPoint(point) >= 0;
  }
}
