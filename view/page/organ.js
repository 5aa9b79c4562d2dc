// The organ as it is drawn: its skin wet, what was cut open matt and dark.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {light, models, heldColour, quantities, rampColours} from './colours.js';
import {SmoothSurface} from './smooth_surface.js';

const skinColour = light([0.5, 0.185, 0.15]),
  cutColour = light([0.42, 0.085, 0.075]);

// Fine unevenness of the tissue under its wet film, from the position at rest so that it moves with the organ.
const noise = /* glsl */ `
varying vec3 vRest;
float hashed(vec3 p) { p = fract(p * 0.3183099 + 0.1); p *= 17.0; return fract(p.x * p.y * p.z * (p.x + p.y + p.z)); }
float unevenness(vec3 p) {
  vec3 i = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(mix(hashed(i), hashed(i + vec3(1, 0, 0)), f.x), mix(hashed(i + vec3(0, 1, 0)), hashed(i + vec3(1, 1, 0)), f.x), f.y),
    mix(mix(hashed(i + vec3(0, 0, 1)), hashed(i + vec3(1, 0, 1)), f.x), mix(hashed(i + vec3(0, 1, 1)), hashed(i + vec3(1, 1, 1)), f.x), f.y), f.z);
}
vec3 bumped(vec3 n, float height) {
  vec3 sx = dFdx(-vViewPosition), sy = dFdy(-vViewPosition);
  vec3 r1 = cross(sy, n), r2 = cross(n, sx);
  float det = dot(sx, r1);
  vec3 gradient = sign(det) * (dFdx(height) * r1 + dFdy(height) * r2);
  return normalize(abs(det) * n - gradient);
}
`;

function roughen(material, wetness, amount) {
  material.onBeforeCompile = shader => {
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute vec3 rest;\nvarying vec3 vRest;')
      .replace('#include <begin_vertex>', '#include <begin_vertex>\nvRest = rest;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <clearcoat_pars_fragment>', '#include <clearcoat_pars_fragment>\n' + noise)
      .replace(
        '#include <normal_fragment_maps>',
        `#include <normal_fragment_maps>
        float grain = unevenness(vRest * 900.0), patches = unevenness(vRest * 260.0);
        normal = bumped(normal, ${amount} * (grain + 2.0 * patches));
        diffuseColor.rgb *= 0.86 + 0.16 * grain + 0.14 * patches;`,
      )
      .replace(
        '#include <clearcoat_normal_fragment_maps>',
        `#include <clearcoat_normal_fragment_maps>
        #ifdef USE_CLEARCOAT
          clearcoatNormal = bumped(clearcoatNormal, ${wetness} * patches);
        #endif`,
      );
  };
}

export class Organ {
  constructor(stage) {
    this.stage = stage;
    this.quantity = 'tissue';
    this.showsMesh = false;
    this.skin = new THREE.MeshPhysicalMaterial({
      vertexColors: true,
      roughness: 0.5,
      clearcoat: 0.6,
      clearcoatRoughness: 0.22,
    });
    this.opened = new THREE.MeshStandardMaterial({
      vertexColors: true,
      roughness: 0.9,
      envMapIntensity: 0.4,
      side: THREE.DoubleSide,
    });
    roughen(this.skin, '0.00022', '0.0001');
    roughen(this.opened, '0.0', '0.0005');
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), [this.skin, this.opened]);
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.mesh.frustumCulled = false;
    this.lines = new THREE.LineSegments(
      new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({color: 0x140505, transparent: true, opacity: 0.45}),
    );
    this.lines.visible = false;
    this.lines.frustumCulled = false;
    stage.scene.add(this.mesh, this.lines);
    this.range = [0, 1];
    this.cutCount = 0;
    this.shares = [0, 0, 0];
  }

  setTopology(topology) {
    this.topology = topology;
    this.revision = topology.revision;
    this.cutCount = topology.cut.reduce((sum, c) => sum + c, 0);
    this.shares = [0, 0, 0];
    for (const r of topology.region) this.shares[r] += 1 / topology.region.length;
    this.scalar = null;
    this.rebuild();
  }

  levels() {
    if (this.showsMesh) return 0;
    const triangles = this.topology.region.length;
    if (this.stage.software) return triangles < 8000 ? 1 : 0;
    return triangles < 6000 ? 2 : triangles < 40000 ? 1 : 0;
  }

  rebuild() {
    this.smooth = new SmoothSurface(this.topology, this.levels());
    const geometry = new THREE.BufferGeometry(),
      count = this.smooth.vertexCount,
      skin = 3 * this.smooth.skinCount * this.smooth.parts;
    this.position = new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(
      THREE.DynamicDrawUsage,
    );
    this.normal = new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(THREE.DynamicDrawUsage);
    this.colour = new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(THREE.DynamicDrawUsage);
    geometry
      .setAttribute('position', this.position)
      .setAttribute('normal', this.normal)
      .setAttribute('color', this.colour);
    geometry.setAttribute(
      'rest',
      new THREE.BufferAttribute(this.smooth.interpolate(this.topology.rest, 3), 3),
    );
    geometry.setIndex(new THREE.BufferAttribute(this.smooth.triangles, 1));
    geometry.addGroup(0, skin, 0);
    geometry.addGroup(skin, this.smooth.triangles.length - skin, 1);
    geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e9);
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    this.lines.visible = this.showsMesh;
    for (const material of [this.skin, this.opened]) {
      if (material.flatShading !== this.showsMesh) {
        material.flatShading = this.showsMesh;
        material.needsUpdate = true;
      }
    }
    this.rebuildLines();
    this.fixedColours();
    if (this.x && this.x.length === this.topology.rest.length) this.move(this.x);
  }

  rebuildLines() {
    this.lines.geometry.dispose();
    this.lines.geometry = new THREE.BufferGeometry();
    if (!this.showsMesh) return;
    const seen = new Set(),
      index = [],
      count = this.smooth.vertexCount,
      t = this.smooth.triangles;
    for (let i = 0; i < t.length; ++i) {
      const a = t[i],
        b = t[i % 3 === 2 ? i - 2 : i + 1],
        key = Math.min(a, b) * count + Math.max(a, b);
      if (!seen.has(key)) {
        seen.add(key);
        index.push(a, b);
      }
    }
    this.lines.geometry.setAttribute('position', this.position).setIndex(index);
    this.lines.geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e9);
  }

  show(quantity) {
    this.quantity = quantity;
    this.scalar = null;
    this.fixedColours();
    this.stage.invalidate();
  }

  setHeld(held) {
    this.held = held;
    this.fixedColours();
  }

  /** Colours that stay while nothing is cut or painted. */
  fixedColours() {
    if (!this.smooth) return;
    const {region, cut} = this.topology;
    const byRegion = this.quantity === 'region',
      colours = models.map(model => light(model.colour));
    const fresh = colour => colour.map((c, k) => 0.6 * c + 0.4 * cutColour[k]);
    const lighter = colours.map(fresh);
    const values = this.smooth.spread(t =>
      byRegion ? (cut[t] ? lighter : colours)[region[t]] : cut[t] ? cutColour : skinColour,
    );
    if (this.quantity === 'tissue') this.mottle(values);
    if (byRegion && this.held) this.tint(values);
    this.colour.array.set(values);
    this.colour.needsUpdate = true;
    const glossy = this.quantity === 'tissue';
    this.skin.clearcoat = glossy ? 0.6 : 0.12;
    this.skin.roughness = glossy ? 0.5 : 0.6;
  }

  // Living tissue is of no one colour.
  mottle(values) {
    const rest = this.smooth.interpolate(this.topology.rest, 3),
      scale = 9 / this.stage.size;
    for (let v = 0; v < rest.length; v += 3) {
      const [x, y, z] = [rest[v] * scale, rest[v + 1] * scale, rest[v + 2] * scale];
      const waves =
        Math.sin(x + 1.3 * Math.sin(y)) * Math.sin(y * 1.1 + Math.sin(z)) +
        0.6 * Math.sin(2.7 * z + 2 * x) * Math.sin(3.1 * y - x);
      for (let k = 0; k < 3; ++k) values[v + k] *= 1 + 0.09 * waves;
    }
  }

  tint(values) {
    if (this.held.length !== this.topology.rest.length / 3) return;
    const held = this.smooth.interpolate(Float32Array.from(this.held), 1),
      colour = light(heldColour);
    for (let v = 0; v < held.length; ++v)
      for (let k = 0; k < 3; ++k)
        values[3 * v + k] += (colour[k] - values[3 * v + k]) * 0.85 * Math.min(1, held[v]);
  }

  setScalar(scalar) {
    if (scalar.name !== this.quantity || scalar.steps.length !== this.topology.rest.length / 3) return;
    const values = new Float32Array(scalar.steps.length),
      scale = (scalar.high - scalar.low) / 65535;
    for (let v = 0; v < values.length; ++v) values[v] = scalar.low + scale * scalar.steps[v];
    this.scalar = values;
    this.numberColours(values, scalar.low, scalar.high);
  }

  numberColours(values, low, high) {
    const {least, span} = quantities[this.quantity];
    if (least !== undefined) low = least;
    if (high - low < span) {
      const middle = least ?? (low + high) / 2 - span / 2;
      low = middle;
      high = middle + span;
    }
    // The range follows what there is, without haste.
    const share = this.range[1] > this.range[0] && this.rangeOf === this.quantity ? 0.15 : 1;
    this.range = [
      this.range[0] + share * (low - this.range[0]),
      this.range[1] + share * (high - this.range[1]),
    ];
    this.rangeOf = this.quantity;
    rampColours(this.smooth.interpolate(values, 1), this.range[0], this.range[1], this.colour.array);
    this.colour.needsUpdate = true;
  }

  move(x) {
    this.x = x;
    this.position.array.set(this.smooth.positions(x));
    this.normal.array.set(this.smooth.normals);
    this.position.needsUpdate = this.normal.needsUpdate = true;
    if (this.quantity === 'displacement') this.showDisplacement(x);
    this.stage.invalidate();
  }

  showDisplacement(x) {
    const {rest} = this.topology,
      values = new Float32Array(rest.length / 3);
    let high = 0;
    for (let v = 0; v < values.length; ++v) {
      values[v] = Math.hypot(
        x[3 * v] - rest[3 * v],
        x[3 * v + 1] - rest[3 * v + 1],
        x[3 * v + 2] - rest[3 * v + 2],
      );
      high = Math.max(high, values[v]);
    }
    this.numberColours(values, 0, high);
  }

  setShowsMesh(on) {
    this.showsMesh = on;
    if (this.topology) this.rebuild();
    this.stage.invalidate();
  }

  /** Where a ray meets the organ first; null if nowhere. */
  hit(ray) {
    const caster = new THREE.Raycaster(ray.origin, ray.direction);
    const [first] = caster.intersectObject(this.mesh, false);
    return first ? {point: first.point, distance: first.distance, face: first.face} : null;
  }

  /** The position at rest of a point of the drawn surface. */
  restOf(hit) {
    const rest = this.smooth.interpolate(this.topology.rest, 3),
      p = this.position.array,
      weights = [];
    const corners = [hit.face.a, hit.face.b, hit.face.c];
    const at = v => new THREE.Vector3(p[3 * v], p[3 * v + 1], p[3 * v + 2]);
    const bary = new THREE.Vector3();
    THREE.Triangle.getBarycoord(hit.point, ...corners.map(at), bary);
    weights.push(bary.x, bary.y, bary.z);
    return [0, 1, 2].map(k => corners.reduce((sum, v, i) => sum + weights[i] * rest[3 * v + k], 0));
  }
}
