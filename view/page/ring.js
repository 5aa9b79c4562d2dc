// The ring around what an instrument would reach.
import * as THREE from './third_party/three-0.187.0/three.module.js';

export function makeRing() {
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
