// Threads with which the organ is sewn, as thin tubes from point to point. They are seen through the tissue
// that they lie in, faintly.
import * as THREE from './third_party/three-0.187.0/three.module.js';

const colour = 0x5b3fb0, // of the dyed sutures of surgery
  radius = 0.0035; // of the organ's size, so that it is seen

export class Threads {
  constructor(stage) {
    this.stage = stage;
    this.looks = {
      fine: new THREE.MeshStandardMaterial({color: colour, roughness: 0.45}),
      quick: new THREE.MeshLambertMaterial({color: colour}),
    };
    this.within = new THREE.MeshBasicMaterial({
      color: colour,
      depthTest: false,
      transparent: true,
      opacity: 0.35,
      toneMapped: false,
    });
    this.segment = new THREE.CylinderGeometry(1, 1, 1, 6, 1, true).rotateX(Math.PI / 2);
    this.knot = new THREE.SphereGeometry(1, 8, 6);
    this.meshes = [];
    stage.onLook.push(() => {
      for (const mesh of this.meshes.slice(0, 2)) mesh.material = this.looks[stage.look];
    });
  }

  /** @param {{points: Float32Array}[]} lines those that a frame has */
  set(lines) {
    const segments = lines.reduce((sum, {points}) => sum + Math.max(0, points.length / 3 - 1), 0),
      points = lines.reduce((sum, {points}) => sum + points.length / 3, 0);
    if (segments === 0 && this.meshes.length === 0) return;
    if (this.meshes[0]?.count !== segments || this.meshes[1]?.count !== points) this.make(segments, points);
    if (segments > 0) this.place(lines);
    this.stage.invalidate();
  }

  make(segments, points) {
    for (const mesh of this.meshes) {
      this.stage.scene.remove(mesh);
      mesh.dispose();
    }
    this.meshes = [];
    if (segments === 0) return;
    const material = this.looks[this.stage.look];
    this.meshes = [
      new THREE.InstancedMesh(this.segment, material, segments),
      new THREE.InstancedMesh(this.knot, material, points), // so that there is no gap where it bends
    ];
    const ghost = new THREE.InstancedMesh(this.segment, this.within, segments);
    ghost.instanceMatrix = this.meshes[0].instanceMatrix;
    ghost.renderOrder = 9;
    this.meshes.push(ghost);
    for (const mesh of this.meshes) mesh.frustumCulled = false;
    this.stage.scene.add(...this.meshes);
  }

  place(lines) {
    const [tubes, joints] = this.meshes,
      thick = radius * this.stage.size,
      along = new THREE.Vector3(0, 0, 1),
      no = new THREE.Quaternion(),
      turn = new THREE.Quaternion(),
      matrix = new THREE.Matrix4();
    let segment = 0,
      joint = 0;
    for (const {points} of lines) {
      const at = i => new THREE.Vector3().fromArray(points, 3 * i);
      for (let i = 0; i < points.length / 3; ++i) {
        joints.setMatrixAt(joint++, matrix.compose(at(i), no, new THREE.Vector3().setScalar(thick)));
        if (i === 0) continue;
        const [from, to] = [at(i - 1), at(i)],
          length = from.distanceTo(to);
        turn.setFromUnitVectors(along, length > 0 ? to.clone().sub(from).divideScalar(length) : along);
        matrix.compose(from.add(to).divideScalar(2), turn, new THREE.Vector3(thick, thick, length));
        tubes.setMatrixAt(segment++, matrix);
      }
    }
    for (const mesh of [tubes, joints]) mesh.instanceMatrix.needsUpdate = true;
  }
}
