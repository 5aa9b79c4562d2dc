// Which way the fibres run: a short line in each triangle of the surface that moves with it.
import * as THREE from './third_party/three-0.187.0/three.module.js';

const halfLength = 0.4, // of the root of twice the triangle's area
  nearer = 0.06; // by this part of the organ's size the lines lie before the surface, which is rounded

export class Fibres {
  /** @param {HTMLInputElement} box which says whether they are wanted; hidden where a body has none */
  constructor(stage, box) {
    this.stage = stage;
    this.box = box;
    this.marked = []; // per line: where its triangle begins, and what that one's sides are multiplied by
    this.nearer = {value: 0}; // [m]
    const material = new THREE.LineBasicMaterial({color: 0xfae69e, toneMapped: false, fog: false});
    material.onBeforeCompile = shader => {
      shader.uniforms.nearer = this.nearer;
      shader.vertexShader = 'uniform float nearer;\n' + shader.vertexShader;
      shader.vertexShader = shader.vertexShader.replace(
        '#include <project_vertex>',
        `#include <project_vertex>
        gl_Position = projectionMatrix * vec4(mvPosition.xyz * (1.0 - nearer / length(mvPosition.xyz)), 1.0);`,
      );
    };
    this.lines = new THREE.LineSegments(new THREE.BufferGeometry(), material);
    this.lines.visible = this.lines.frustumCulled = false;
    stage.scene.add(this.lines);
    box.onchange = () => {
      this.move(this.x);
      stage.invalidate();
    };
  }

  /** @param {Float32Array | undefined} parts two numbers per triangle: how much of its first two sides, from
   *   the first corner, make up the fibre in it; none: the body has no fibres */
  set(parts, topology) {
    const {triangles, rest} = topology;
    this.marked = [];
    for (let t = 0; t < (parts?.length ?? 0) / 2; ++t) {
      if (parts[2 * t] === 0 && parts[2 * t + 1] === 0) continue;
      const length = halfLength * Math.sqrt(twiceArea(triangles, rest, t));
      this.marked.push([3 * t, length * parts[2 * t], length * parts[2 * t + 1]]);
    }
    this.triangles = triangles;
    this.box.parentElement.hidden = this.marked.length === 0;
    this.nearer.value = nearer * this.stage.size;
    this.position = new THREE.BufferAttribute(new Float32Array(6 * this.marked.length), 3).setUsage(
      THREE.DynamicDrawUsage,
    );
    this.lines.geometry.dispose();
    this.lines.geometry = new THREE.BufferGeometry().setAttribute('position', this.position);
    this.move(rest);
  }

  move(x) {
    this.x = x;
    this.lines.visible = this.box.checked && this.marked.length > 0;
    if (!this.lines.visible) return;
    const ends = this.position.array;
    this.marked.forEach(([at, p, q], line) => {
      const [a, b, c] = [0, 1, 2].map(k => 3 * this.triangles[at + k]);
      for (let k = 0; k < 3; ++k) {
        const middle = (x[a + k] + x[b + k] + x[c + k]) / 3,
          half = p * (x[b + k] - x[a + k]) + q * (x[c + k] - x[a + k]);
        ends[6 * line + k] = middle - half;
        ends[6 * line + 3 + k] = middle + half;
      }
    });
    this.position.needsUpdate = true;
  }
}

function twiceArea(triangles, x, t) {
  const corner = k => new THREE.Vector3().fromArray(x, 3 * triangles[3 * t + k]);
  const first = corner(0);
  return corner(1).sub(first).cross(corner(2).sub(first)).length();
}
