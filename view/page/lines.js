// What is drawn as lines: threads with which the organ is sewn, needles, and strands that tie bodies to each
// other. They are seen through the tissue that they lie in, faintly.
import * as THREE from './third_party/three-0.187.0/three.module.js';

// By what draws them. Radii are of the organ's size, so that they are seen.
const kinds = {
  threads: {colour: 0x5b3fb0, radius: 0.0035, ends: 2}, // dyed sutures; round ends, so that bends have no gap
  clips: {colour: 0xc9ced6, radius: 0.0026, ends: 2},
  needles: {colour: 0xaeb6c2, radius: 0.0024, ends: 2},
  attachments: {colour: 0xe3d3a6, radius: 0.0018, ends: 0},
};
const torn = new THREE.Color(0x8d1f16);

class Tubes {
  constructor(stage, {colour, radius, ends}) {
    this.stage = stage;
    this.colour = new THREE.Color(colour);
    this.radius = radius;
    this.ends = ends; // that are drawn of each segment
    this.looks = {
      fine: new THREE.MeshStandardMaterial({roughness: 0.45}),
      quick: new THREE.MeshLambertMaterial(),
    };
    this.within = new THREE.MeshBasicMaterial({
      color: colour,
      depthTest: false,
      transparent: true,
      opacity: 0.35,
      toneMapped: false,
    });
    this.tube = new THREE.CylinderGeometry(1, 1, 1, 6, 1, true).rotateX(Math.PI / 2);
    this.ball = new THREE.SphereGeometry(1, 8, 6);
    this.count = 0; // of segments
    this.meshes = [];
  }

  dress() {
    for (const mesh of this.meshes)
      if (mesh.material !== this.within) mesh.material = this.looks[this.stage.look];
  }

  set(segments) {
    if (segments.length !== this.count) this.make(segments.length);
    if (this.count === 0) return;
    const thick = this.radius * this.stage.size,
      [tubes, , balls] = this.meshes,
      along = new THREE.Vector3(0, 0, 1),
      no = new THREE.Quaternion(),
      turn = new THREE.Quaternion(),
      matrix = new THREE.Matrix4(),
      colour = new THREE.Color();
    segments.forEach(({from, to, damage}, i) => {
      const length = from.distanceTo(to);
      turn.setFromUnitVectors(along, length > 0 ? to.clone().sub(from).divideScalar(length) : along);
      const middle = from.clone().add(to).divideScalar(2);
      tubes.setMatrixAt(i, matrix.compose(middle, turn, new THREE.Vector3(thick, thick, length)));
      colour.lerpColors(this.colour, torn, damage);
      tubes.setColorAt(i, colour);
      [from, to].slice(0, this.ends).forEach((end, k) => {
        balls.setMatrixAt(2 * i + k, matrix.compose(end, no, new THREE.Vector3().setScalar(thick)));
        balls.setColorAt(2 * i + k, colour);
      });
    });
    for (const mesh of [tubes, balls].filter(Boolean))
      mesh.instanceMatrix.needsUpdate = mesh.instanceColor.needsUpdate = true;
  }

  make(count) {
    this.count = count;
    for (const mesh of this.meshes) {
      this.stage.scene.remove(mesh);
      mesh.dispose();
    }
    this.meshes = [];
    if (count === 0) return;
    const material = this.looks[this.stage.look],
      tubes = new THREE.InstancedMesh(this.tube, material, count),
      ghost = new THREE.InstancedMesh(this.tube, this.within, count);
    ghost.instanceMatrix = tubes.instanceMatrix;
    ghost.renderOrder = 9;
    this.meshes = [tubes, ghost];
    if (this.ends > 0) this.meshes.push(new THREE.InstancedMesh(this.ball, material, this.ends * count));
    for (const mesh of this.meshes) mesh.frustumCulled = false;
    this.stage.scene.add(...this.meshes);
  }
}

export class Lines {
  constructor(stage) {
    this.stage = stage;
    this.tubes = Object.fromEntries(
      Object.entries(kinds).map(([term, kind]) => [term, new Tubes(stage, kind)]),
    );
    stage.onLook.push(() => {
      for (const tubes of Object.values(this.tubes)) tubes.dress();
    });
  }

  /** @param {{term: string, ends: Float32Array, damages: Float32Array}[]} groups those that a frame has */
  set(groups) {
    const isEmpty = groups.length === 0 && Object.values(this.tubes).every(({count}) => count === 0);
    if (isEmpty) return;
    for (const [term, tubes] of Object.entries(this.tubes)) {
      const segments = groups.filter(group => group.term === term).flatMap(segmentsOf);
      tubes.set(segments);
    }
    this.stage.invalidate();
  }
}

const segmentsOf = ({ends, damages}) =>
  Array.from(damages, (damage, i) => ({
    from: new THREE.Vector3().fromArray(ends, 6 * i),
    to: new THREE.Vector3().fromArray(ends, 6 * i + 3),
    damage,
  }));
