// The organ as it is drawn: its skin wet, what was cut open matt and dark.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {charColours, heldColour, light, materialColours, models} from './colours.js';
import {quantities, rampColours, tissueOf} from './colours.js';
import {Fibres} from './fibres.js';
import {fineLook, quickLook} from './looks.js';
import {SmoothSurface} from './smooth_surface.js';

const joined = (a, b) => {
  const both = new Float32Array(a.length + b.length);
  both.set(a);
  both.set(b, a.length);
  return both;
};

export class Organ {
  /** @param {Bodies} bodies (bodies.js) */
  constructor(stage, bodies) {
    this.stage = stage;
    this.bodies = bodies;
    bodies.onChange = () => this.compose();
    this.quantity = 'tissue';
    this.showsMesh = false;
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry());
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.mesh.frustumCulled = false;
    this.lines = new THREE.LineSegments(
      new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({color: 0x140505, transparent: true, opacity: 0.45}),
    );
    this.lines.visible = false;
    this.lines.frustumCulled = false;
    // Where an opened face meets the skin: so a cut is seen that has not come apart.
    this.rim = new THREE.LineSegments(
      new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({color: 0x250303, transparent: true, opacity: 0.75}),
    );
    this.rim.frustumCulled = false;
    this.shadow = new THREE.Mesh(
      new THREE.BufferGeometry(),
      new THREE.MeshBasicMaterial({toneMapped: false}),
    );
    this.shadow.matrixAutoUpdate = this.shadow.frustumCulled = false;
    stage.scene.add(this.mesh, this.lines, this.rim, this.shadow);
    this.section = null; // section.js: what is not drawn is not hit
    this.fibres = new Fibres(stage, document.getElementById('fibres'));
    stage.onLook.push(() => this.dress());
    this.dress();
    this.range = [0, 1];
    this.cutCount = 0;
    this.shares = models.map(() => 0);
  }

  /** In the look that the stage wants: a light that casts no shadow gets one that is the organ laid flat. */
  dress() {
    const {stage} = this;
    this.looks ??= {};
    this.look = this.looks[stage.look] ??= stage.look === 'fine' ? fineLook() : quickLook(stage);
    this.mesh.material = this.look.materials; // in the order of SmoothSurface.counts
    this.shadow.visible = stage.look === 'quick' && stage.step.hasShadow;
    this.shadow.material.color.copy(stage.scene.background).multiplyScalar(0.5);
    this.look.shine(this.quantity === 'tissue');
    this.shadeFlat();
    if (this.smooth && this.smooth.levels.length !== this.levels()) this.rebuild();
  }

  shadeFlat() {
    for (const material of this.mesh.material) {
      if (material.flatShading === this.showsMesh) continue;
      material.flatShading = this.showsMesh;
      material.needsUpdate = true;
    }
  }

  /** @param {Float32Array} [x] present positions, where it is not at rest
   *  @param {Uint8Array} [body] of each triangle, where there are several */
  setTopology(topology, x, fibres, body) {
    this.surface = {...topology, body}; // of the tetrahedra, as the server tells it
    this.topology = this.composed();
    this.revision = topology.revision;
    this.cutCount = topology.cut.reduce((sum, c) => sum + Number(c > 0), 0);
    this.shares = models.map(() => 0);
    for (const r of topology.region) this.shares[r] += 1 / topology.region.length;
    this.scalar = null;
    this.fibres.set(fibres, topology);
    this.rebuild();
  }

  // ---- A finer skin, which takes the place of the tetrahedra's own

  /**
   * Sets the skin that is shown after compose().
   * @param {{triangles: Uint32Array, rest: Float32Array, revision: number}|null} skin
   */
  setSkin(skin) {
    this.skin = skin;
    this.skinX = null;
  }

  moveSkin({revision, x}) {
    if (revision === this.skin?.revision) this.skinX = x;
  }

  leaveSkin() {
    const was = this.showsSkin();
    this.setSkin(null);
    if (was) this.compose();
  }

  showsSkin() {
    const isWhole = this.bodies.areAll('shown') && !this.showsMesh;
    return Boolean(this.skinX) && this.quantity === 'tissue' && isWhole;
  }

  compose() {
    if (!this.surface) return;
    this.topology = this.composed();
    this.rebuild();
  }

  /** The triangles to draw: all of the surface, or its cut faces and the skin. Vertices are those of both. */
  composed() {
    const {surface, skin} = this;
    if (!this.showsSkin()) return surface.body ? this.withoutHidden() : surface;
    const triangles = [],
      of = [],
      count = surface.rest.length / 3;
    for (let t = 0; t < surface.cut.length; ++t)
      if (surface.cut[t]) {
        triangles.push(...surface.triangles.subarray(3 * t, 3 * t + 3));
        of.push(t);
      }
    const opened = of.length;
    for (const v of skin.triangles) triangles.push(count + v);
    return {
      triangles: Uint32Array.from(triangles),
      rest: joined(surface.rest, skin.rest),
      region: new Uint8Array(triangles.length / 3),
      cut: Uint8Array.from({length: triangles.length / 3}, (_, t) => (t < opened ? surface.cut[of[t]] : 0)),
    };
  }

  /** Those of bodies that are drawn; `of`: their numbers on the surface. */
  withoutHidden() {
    const {surface, bodies} = this;
    if (bodies.areAll('shown')) return surface;
    const of = Uint32Array.from(surface.body.keys()).filter(t => !bodies.is(surface.body[t], 'hidden')),
      pick = values => values.constructor.from(of, t => values[t]);
    const triangles = new Uint32Array(3 * of.length),
      body = pick(surface.body);
    of.forEach((t, i) => triangles.set(surface.triangles.subarray(3 * t, 3 * t + 3), 3 * i));
    return {
      ...surface,
      of,
      triangles,
      body,
      region: pick(surface.region),
      cut: pick(surface.cut),
      faded: body.map(b => Number(bodies.is(b, 'faded'))),
    };
  }

  levels() {
    if (this.showsMesh) return 0;
    const triangles = this.topology.region.length,
      worthwhile = triangles < 6000 ? 2 : triangles < 40000 ? 1 : 0;
    return Math.min(worthwhile, this.stage.step.levels);
  }

  rebuild() {
    this.drawn = null;
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
    let begin = 0;
    this.smooth.counts.forEach((count, i) => {
      if (count > 0) geometry.addGroup(begin, 3 * count * this.smooth.parts, i);
      begin += 3 * count * this.smooth.parts;
    });
    geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e9);
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    this.rebuildShadow();
    this.lines.visible = this.showsMesh;
    this.shadeFlat();
    this.rebuildLines();
    this.rebuildRim(skin);
    this.fixedColours();
    if (this.served?.length === this.surface.rest.length) this.move(this.served);
  }

  rebuildShadow() {
    const {geometry, matrix} = this.shadow;
    geometry.dispose();
    this.laidFlat = new THREE.BufferAttribute(this.topology.rest.slice(), 3).setUsage(THREE.DynamicDrawUsage);
    this.shadow.geometry = new THREE.BufferGeometry()
      .setAttribute('position', this.laidFlat)
      .setIndex(new THREE.BufferAttribute(this.topology.triangles, 1));
    matrix.copy(this.stage.ontoGround());
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

  // Edges that one triangle of an opened face has alone.
  rebuildRim(skin) {
    const count = this.smooth.vertexCount,
      t = this.smooth.triangles,
      once = new Map();
    for (let i = skin; i < t.length; ++i) {
      const a = t[i],
        b = t[i % 3 === 2 ? i - 2 : i + 1],
        key = Math.min(a, b) * count + Math.max(a, b);
      once.has(key) ? once.set(key, null) : once.set(key, [a, b]);
    }
    const index = [...once.values()].filter(Boolean).flat();
    this.rim.geometry.dispose();
    this.rim.geometry = new THREE.BufferGeometry().setAttribute('position', this.position).setIndex(index);
    this.rim.visible = index.length > 0;
  }

  show(quantity) {
    const was = this.showsSkin();
    this.quantity = quantity;
    this.scalar = null;
    if (this.showsSkin() !== was) this.compose();
    else this.fixedColours();
    this.stage.invalidate();
  }

  setHeld(held) {
    this.held = held;
    this.fixedColours();
  }

  setMaterials(materials) {
    this.materials = materials;
    if (this.quantity === 'material') this.fixedColours();
  }

  /** Colours that stay while nothing is cut or painted. */
  fixedColours() {
    if (!this.smooth) return;
    const {region, cut, body, of} = this.topology;
    const byRegion = this.quantity === 'region',
      colours = models.map(model => light(model.colour)),
      cutColour = light(tissueOf(0).opened);
    const fresh = colour => colour.map((c, k) => 0.6 * c + 0.4 * cutColour[k]);
    const lighter = colours.map(fresh);
    const ofMaterials = this.quantity === 'material' && this.materials?.length === this.surface.region.length,
      tints = materialColours.map(light);
    const tissues = [...Array(body ? 256 : 1).keys()].map(b => {
      const {skin, opened} = tissueOf(b);
      return [light(skin), light(opened), light(charColours.face)];
    });
    const values = this.smooth.spread(t => {
      if (ofMaterials) return tints[this.materials[of ? of[t] : t] % tints.length];
      if (byRegion) return (cut[t] ? lighter : colours)[region[t]];
      return tissues[body ? body[t] : 0][cut[t]];
    });
    if (this.quantity === 'tissue') {
      this.scorch(values);
      this.mottle(values);
    }
    if ((byRegion || ofMaterials) && this.held) this.tint(values);
    this.colour.array.set(values);
    this.colour.needsUpdate = true;
    this.look.shine(this.quantity === 'tissue');
    this.stage.invalidate();
  }

  // The skin is charred where it meets a charred face, less and less away from there.
  scorch(values) {
    const {triangles, rest, cut} = this.topology,
      key = v => `${rest[3 * v]},${rest[3 * v + 1]},${rest[3 * v + 2]}`,
      burnt = new Set();
    triangles.forEach((v, i) => cut[Math.floor(i / 3)] === 2 && burnt.add(key(v)));
    if (burnt.size === 0) return;
    const ofSkin = new Float32Array(rest.length / 3);
    triangles.forEach((v, i) => {
      if (cut[Math.floor(i / 3)] === 0 && burnt.has(key(v))) ofSkin[v] = 1;
    });
    const shares = this.smooth.interpolate(ofSkin, 1),
      rim = light(charColours.rim);
    shares.forEach((share, v) => {
      for (let k = 0; k < 3; ++k) values[3 * v + k] += share * (rim[k] - values[3 * v + k]);
    });
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
    this.stage.invalidate();
  }

  /** @param {Float32Array} served positions of the surface */
  move(served) {
    this.served = served;
    const x = this.showsSkin() ? joined(served, this.skinX) : served;
    this.x = x;
    if (!this.hasMoved(x)) return;
    this.drawn = x;
    this.position.array.set(this.smooth.positions(x));
    this.normal.array.set(this.smooth.normals);
    this.laidFlat.array.set(x);
    this.fibres.move(x);
    this.position.needsUpdate = this.normal.needsUpdate = this.laidFlat.needsUpdate = true;
    if (this.quantity === 'displacement') this.showDisplacement(x);
    this.stage.invalidate();
  }

  /** Enough to be seen; a body at rest costs nothing. */
  hasMoved(x) {
    const {drawn} = this,
      least = 0.03 * this.stage.metresPerPixel(this.stage.target);
    if (drawn?.length !== x.length) return true;
    for (let i = 0; i < x.length; ++i) if (Math.abs(x[i] - drawn[i]) > least) return true;
    return false;
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
    this.compose();
    this.stage.invalidate();
  }

  /** Where a ray meets the organ first; null if nowhere. */
  hit(ray) {
    const caster = new THREE.Raycaster(ray.origin, ray.direction);
    const first = this.met(caster).find(({point}) => this.section?.shows(point) ?? true);
    return first
      ? {point: first.point, distance: first.distance, face: first.face, faceIndex: first.faceIndex}
      : null;
  }

  // What is faded stands in nobody's way.
  met(caster) {
    return caster.intersectObject(this.mesh, false).filter(({face}) => face.materialIndex % 2 === 0);
  }

  /** The number of the body that was hit; undefined where there are no several. */
  bodyOf(hit) {
    const t = this.smooth.order[Math.floor(hit.faceIndex / this.smooth.parts)];
    return this.topology.body?.[t];
  }

  /** From where a ray meets nothing before what it has hit: behind the section, and behind what is faded or
   *  hidden. */
  start(ray, hit) {
    const from = this.section.start(ray),
      {triangles, body} = this.surface;
    if (this.bodies.areAll('shown') || !body || !this.served) return from;
    const corners = [0, 1, 2].map(() => new THREE.Vector3()),
      at = new THREE.Vector3();
    let last = ray.origin.distanceTo(from);
    for (let t = 0; t < body.length; ++t) {
      if (this.bodies.is(body[t], 'shown')) continue;
      corners.forEach((corner, k) => corner.fromArray(this.served, 3 * triangles[3 * t + k]));
      if (!ray.intersectTriangle(...corners, false, at)) continue;
      const distance = ray.origin.distanceTo(at);
      if (distance < hit.distance) last = Math.max(last, distance);
    }
    return ray.at((last + hit.distance) / 2, at);
  }

  /** The surface as it is now of the body that was hit: its triangles, and where its vertices are. */
  around(hit) {
    const {triangles, body, rest} = this.surface,
      of = this.bodyOf(hit);
    const isOf = (_, i) => !body || body[Math.floor(i / 3)] === of;
    return {triangles: triangles.filter(isOf), x: this.served ?? rest};
  }

  /** Of what is near a place of the window, a point there that is as deep; null: nothing is within `reach`
   *  pixels. */
  beside(x, y, reach) {
    const {array} = this.position,
      at = new THREE.Vector3();
    let best = reach,
      depth = 0;
    for (let i = 0; i < array.length; i += 3) {
      const place = this.stage.project(at.fromArray(array, i)),
        distance = place ? Math.hypot(place.x - x, place.y - y) : Infinity;
      if (distance < best) [best, depth] = [distance, this.stage.depth(at)];
    }
    if (!(best < reach)) return null;
    const {origin, direction} = this.stage.ray(x, y);
    return origin.clone().addScaledVector(direction, depth / direction.dot(this.stage.forward()));
  }

  /** How thick the organ is behind a point of its surface, along a direction [m]; 0: nothing is there. */
  thickness(/** @type {THREE.Vector3} */ point, /** @type {THREE.Vector3} */ direction) {
    const reach = this.extent(direction),
      behind = point.clone().addScaledVector(direction, reach),
      caster = new THREE.Raycaster(behind, direction.clone().negate());
    // Seen from behind, the nearest side is the last one before the point.
    const sides = this.met(caster).map(({distance}) => reach - distance);
    return sides.findLast(side => side > 1e-3 * this.stage.size) ?? 0;
  }

  /** How far the body reaches along a direction [m]. */
  extent(/** @type {THREE.Vector3} */ direction) {
    const {low, high} = this.span(direction);
    return high - low;
  }

  /** From where to where it reaches along a direction [m]. */
  span(/** @type {THREE.Vector3} */ direction) {
    const {array} = this.position;
    let low = Infinity,
      high = -Infinity;
    for (let i = 0; i < array.length; i += 3) {
      const along = array[i] * direction.x + array[i + 1] * direction.y + array[i + 2] * direction.z;
      low = Math.min(low, along);
      high = Math.max(high, along);
    }
    return {low, high};
  }

  /** The position at rest of a point of the drawn surface. */
  restOf(hit) {
    const now = this.cornersOf(hit, this.position),
      [a, b, c] = this.cornersOf(hit, this.mesh.geometry.attributes.rest),
      weights = new THREE.Vector3();
    THREE.Triangle.getBarycoord(hit.point, ...now, weights);
    return a.multiplyScalar(weights.x).addScaledVector(b, weights.y).addScaledVector(c, weights.z).toArray();
  }

  /** A direction as it is at rest, by how the surface has turned where it was hit. */
  directionAtRest(hit, direction) {
    const axesOf = ([a, b, c]) => {
      const x = b.clone().sub(a).normalize(),
        z = new THREE.Vector3().crossVectors(x, c.clone().sub(a)).normalize();
      return new THREE.Matrix4().makeBasis(x, new THREE.Vector3().crossVectors(z, x), z);
    };
    const now = axesOf(this.cornersOf(hit, this.position)),
      rest = axesOf(this.cornersOf(hit, this.mesh.geometry.attributes.rest));
    return direction.clone().applyMatrix4(now.transpose()).applyMatrix4(rest).toArray();
  }

  cornersOf({face}, attribute) {
    return [face.a, face.b, face.c].map(v => new THREE.Vector3().fromBufferAttribute(attribute, v));
  }
}
