// What stands around the organ and does not move: tables, bars, walls of a cavity.
import * as THREE from './third_party/three-0.187.0/three.module.js';

const looks = {
  fine: new THREE.MeshStandardMaterial({color: 0x7d8d96, metalness: 0.55, roughness: 0.45}),
  quick: new THREE.MeshLambertMaterial({color: 0x7d8d96}),
};

export class Obstacles {
  constructor(stage) {
    this.stage = stage;
    this.group = new THREE.Group();
    stage.scene.add(this.group);
    stage.onLook.push(() => this.dress());
  }

  dress() {
    for (const mesh of this.group.children) mesh.material = looks[this.stage.look];
  }

  /** @param {{position: number[], orientation: number[], shape: object}[]} obstacles from the server */
  set(obstacles) {
    for (const mesh of this.group.children) mesh.geometry.dispose();
    this.group.clear();
    for (const {position, orientation, shape} of obstacles) {
      const mesh = new THREE.Mesh(geometryOf(shape, this.stage.size));
      mesh.position.fromArray(position);
      mesh.quaternion.fromArray(orientation);
      mesh.castShadow = mesh.receiveShadow = true;
      this.group.add(mesh);
    }
    this.dress();
    if (obstacles.length > 0) this.stage.lowerGround(new THREE.Box3().setFromObject(this.group).min.z);
    this.stage.invalidate();
  }
}

function geometryOf({sphere, capsule, box, mesh}, size) {
  if (sphere) return new THREE.SphereGeometry(sphere.radius, 32, 20);
  if (capsule)
    return new THREE.CapsuleGeometry(capsule.radius, capsule.length, 10, 24)
      .rotateX(Math.PI / 2)
      .translate(0, 0, capsule.length / 2);
  if (box) return new THREE.BoxGeometry(...box.size);
  if (mesh) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(mesh.points.flat(), 3));
    geometry.setIndex(mesh.triangles.flat());
    geometry.computeVertexNormals();
    return geometry;
  }
  return new THREE.CircleGeometry(8 * size, 64); // a plane
}
