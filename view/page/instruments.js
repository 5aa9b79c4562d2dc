// Instruments where they are, and the force on them as an arrow with its newtons.
import * as THREE from './third_party/three-0.187.0/three.module.js';
import {nearness} from './forces.js';

// Of each material there is one per look of the stage (looks.js).
const metal = (color, options) => ({
  fine: new THREE.MeshStandardMaterial({color, ...options}),
  quick: new THREE.MeshLambertMaterial({color}),
});
const steel = metal(0xc9d2d6, {metalness: 0.9, roughness: 0.28});
const dark = metal(0x56636a, {metalness: 0.25, roughness: 0.5});
// Of a blade, so much is seen through the tissue that it is in.
const seenThrough = new THREE.MeshBasicMaterial({
  color: 0xe8f0f2,
  depthTest: false,
  transparent: true,
  opacity: 0.3,
  toneMapped: false,
});
const red = new THREE.Color(0xff3b2b);
const arrowMaterial = new THREE.MeshBasicMaterial({
  depthTest: false,
  transparent: true,
  opacity: 0.92,
  toneMapped: false,
});
const millimetresPerNewton = 6,
  doing = {cautery: 'burning', scalpel: 'cutting', clip_applier: 'clipping'};

export class Instruments {
  constructor(stage, labels) {
    this.stage = stage;
    this.labels = labels;
    this.shown = new Map(); // by tool
    stage.after.push(() => this.placeLabels());
    stage.onLook.push(() => {
      for (const {body} of this.shown.values()) this.dress(body);
    });
  }

  dress(body) {
    body.traverse(part => {
      if (part.userData.looks) part.material = part.userData.looks[this.stage.look];
    });
  }

  /** @param {{tool: number, type: string, position: number[], orientation: number[], force: number[],
   *   radius: number, on: boolean, jaw?: number[], opening?: number, colour: string, most?: number}[]} tools
   *  @param {boolean} isDue whether figures are written now */
  update(tools, isDue = true) {
    const present = new Set();
    for (const tool of tools) {
      present.add(tool.tool);
      let item = this.shown.get(tool.tool);
      if (item && (item.type !== tool.type || !item.isOpen !== !tool.jaw)) {
        this.remove(tool.tool, item);
        item = null;
      }
      item ??= this.make(tool);
      this.place(item, tool, isDue || !item.isWritten);
    }
    for (const [id, item] of this.shown) if (!present.has(id)) this.remove(id, item);
  }

  make(tool) {
    const blade = new THREE.Vector3(...(tool.blade ?? [0, 0, 0]));
    // The shaft leads to where the surgeon stands.
    const shaft = this.stage
      .above()
      .multiplyScalar(1.1)
      .addScaledVector(this.stage.right(), 0.55 - 0.35 * (this.shown.size % 3))
      .addScaledVector(this.stage.forward(), -0.7)
      .normalize();
    const along = blade.length() > 0 ? blade.clone().normalize() : shaft,
      rest = new THREE.Quaternion();
    const isTurned = !tool.jaw && !isHook(tool);
    if (isTurned) rest.setFromUnitVectors(new THREE.Vector3(0, 0, 1), along);
    const body = this.bodyOf(tool, blade, shaft, rest);
    this.dress(body);
    const arrow = makeArrow(),
      label = document.createElement('span');
    this.stage.scene.add(body, arrow);
    this.labels.append(label);
    const item = {
      type: tool.type,
      body,
      arrow,
      label,
      rest,
      isOpen: !!tool.jaw,
    };
    this.shown.set(tool.tool, item);
    return item;
  }

  bodyOf(tool, blade, shaft, rest) {
    // One of a scene leads where its own axes say.
    const surgeon = other => (tool.hand === undefined ? other : fromTool(shaft, tool));
    if (tool.type === 'clip_applier') return applier(tool.jaw, surgeon(new THREE.Vector3(-1, 0, 0)));
    if (tool.jaw) return jaws(tool.jaw, surgeon(new THREE.Vector3(0, 0, -1)));
    if (isHook(tool)) return hook(tool.radius, blade, surgeon(blade.clone().negate()));
    if (tool.type === 'cautery') return cautery(tool.radius || 0.005);
    if (tool.type === 'probe') return probe(tool.radius || 0.005, blade.length());
    if (tool.type !== 'scalpel') return forceps(this.stage.size);
    const length = Math.min(blade.length(), 0.3 * this.stage.size);
    return scalpel(length, shaft.applyQuaternion(rest.clone().invert()));
  }

  remove(id, item) {
    this.stage.scene.remove(item.body, item.arrow);
    for (const part of [item.body, item.arrow]) part.traverse(({geometry}) => geometry?.dispose());
    item.arrow.userData.material.dispose();
    item.label.remove();
    this.shown.delete(id);
    this.stage.invalidate();
  }

  place(item, tool, isDue) {
    const place = [tool.on, ...tool.position, ...(tool.orientation ?? []), tool.opening ?? 0],
      force = new THREE.Vector3(...tool.force),
      size = force.length(),
      isSame = item.was?.every((value, k) => value === place[k]) && force.distanceTo(item.force) < 0.01;
    if (isSame && !(isDue && item.isOld)) return;
    item.was = place;
    item.force = force.clone();
    this.stage.invalidate();
    item.body.position.fromArray(tool.position);
    item.body.quaternion.fromArray(tool.orientation ?? [0, 0, 0, 1]).multiply(item.rest);
    item.body.userData.open?.(tool.opening ?? 0);
    const tip = item.body.getObjectByName('tip');
    for (const look of Object.values(tip?.userData.looks ?? {})) look.emissiveIntensity = tool.on ? 2.2 : 0;
    const near = nearness(size, tool.most),
      isPlain = !(tool.type in doing) || (isHook(tool) && !tool.on); // what it does is to pull or press
    item.arrow.userData.material.color.set(tool.colour).lerp(red, near);
    item.at = new THREE.Vector3(...tool.position);
    item.isOld = !isDue; // what is written
    if (isDue) {
      item.isWritten = true;
      const newtons = `${size.toFixed(2)} N` + (near > 0 ? ` of ${tool.most}` : '');
      item.label.textContent = isPlain ? newtons : doing[tool.type];
      item.label.className = near > 0 ? 'near' : '';
    }
    item.label.hidden = !isPlain && !tool.on;
    item.arrow.visible = size > 0.02;
    if (!item.arrow.visible) return;
    const length = Math.min(
      1.2 * this.stage.size,
      size * millimetresPerNewton * 1e-3 + 0.08 * this.stage.size,
    );
    item.arrow.position.copy(item.at);
    item.arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), force.divideScalar(size));
    const thickness = 0.022 * this.stage.size;
    item.arrow.children[0].scale.set(thickness, length, thickness);
    item.arrow.children[1].position.y = length;
    item.arrow.children[1].scale.setScalar(thickness);
  }

  placeLabels() {
    for (const item of this.shown.values()) {
      const at = this.stage.project(item.at);
      item.label.style.visibility = at ? 'visible' : 'hidden';
      if (at)
        item.label.style.transform = `translate(${Math.round(at.x + 16)}px, ${Math.round(at.y + 10)}px)`;
    }
  }
}

const isHook = ({type, blade}) => type === 'cautery' && Boolean(blade?.some(length => length !== 0));

/** A direction in the axes of a tool. */
const fromTool = (direction, tool) =>
  direction.clone().applyQuaternion(new THREE.Quaternion(...tool.orientation).invert());
const partOf = (geometry, looks) => {
  const mesh = new THREE.Mesh(geometry);
  mesh.userData.looks = looks;
  return mesh;
};
const shaftOf = (radius, from, to, looks) => {
  const mesh = partOf(new THREE.CylinderGeometry(radius, radius, to - from, 20), looks);
  mesh.rotation.x = Math.PI / 2;
  mesh.position.z = (from + to) / 2;
  mesh.castShadow = true;
  return mesh;
};

function forceps(size) {
  const group = new THREE.Group(),
    r = 0.024 * size,
    jaw = 0.17 * size;
  for (const side of [-1, 1]) {
    const blade = partOf(new THREE.CapsuleGeometry(0.5 * r, jaw, 4, 12), steel);
    blade.rotation.x = Math.PI / 2;
    blade.rotation.z = -side * 0.16;
    blade.scale.set(1, 1, 0.7);
    blade.position.set(side * 0.55 * r, 0, 0.5 * jaw);
    blade.castShadow = true;
    group.add(blade);
  }
  group.add(
    shaftOf(1.15 * r, jaw, jaw + 0.28 * size, steel),
    shaftOf(1.5 * r, jaw + 0.28 * size, jaw + 5 * size, dark),
  );
  return group;
}

function cautery(radius) {
  const group = new THREE.Group();
  const looks = metal(0xb9a58c, {metalness: 0.7, roughness: 0.35});
  for (const look of Object.values(looks)) look.emissive.set(0xff5a1a);
  const tip = partOf(new THREE.SphereGeometry(radius, 24, 16), looks);
  tip.name = 'tip';
  tip.castShadow = true;
  group.add(
    tip,
    shaftOf(0.4 * radius, 0.5 * radius, 5 * radius, steel),
    shaftOf(0.7 * radius, 5 * radius, 90 * radius, dark),
  );
  return group;
}

// A wire from the origin on, and a shaft that leads from there to where the surgeon stands.
function hook(radius, wire, surgeon) {
  const group = new THREE.Group(),
    looks = metal(0xb9a58c, {metalness: 0.7, roughness: 0.35}),
    length = wire.length(),
    handle = new THREE.Group(),
    bent = partOf(new THREE.CapsuleGeometry(0.6 * radius, length, 8, 16), looks);
  for (const look of Object.values(looks)) look.emissive.set(0xff5a1a);
  bent.name = 'tip';
  bent.castShadow = true;
  bent.position.copy(wire).divideScalar(2);
  bent.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), wire.clone().normalize());
  handle.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), surgeon.clone().normalize());
  handle.add(shaftOf(0.6 * radius, 0, 0.8 * length, steel), shaftOf(radius, 0.8 * length, 11 * length, dark));
  group.add(bent, handle);
  return group;
}

// Two legs along x, above and below the plane z = 0, about the origin; the shaft is where they begin.
function applier([width, , length], surgeon) {
  const group = new THREE.Group(),
    handle = new THREE.Group(),
    legs = [-1, 1].map(() => partOf(new THREE.BoxGeometry(length, width, 0.5 * width), steel)),
    bar = partOf(new THREE.BoxGeometry(0.5 * width, width, 1), dark),
    r = 0.3 * width;
  for (const part of [...legs, bar]) part.castShadow = true;
  bar.position.x = handle.position.x = -0.5 * length;
  handle.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), surgeon);
  handle.add(shaftOf(r, 0, 0.8 * length, steel), shaftOf(1.4 * r, 0.8 * length, 9 * length, dark));
  group.add(...legs, bar, handle);
  group.userData.open = opening => {
    legs.forEach((leg, k) => (leg.position.z = (k === 0 ? -0.5 : 0.5) * (opening + 0.5 * width)));
    bar.scale.z = opening + width;
  };
  group.userData.open(0);
  return group;
}

// Its cutting edge from the tip, in the origin, along z. The handle leans to where the surgeon stands, so
// that a blade that is pushed away from the viewer is not behind it.
function scalpel(length, surgeon) {
  const group = new THREE.Group(),
    handle = new THREE.Group(),
    edge = partOf(new THREE.CylinderGeometry(0.09 * length, 0.008 * length, length, 4), steel);
  edge.rotation.x = Math.PI / 2;
  edge.position.z = 0.5 * length;
  edge.castShadow = true;
  handle.position.z = length;
  const lean = surgeon.clone().multiplyScalar(1.3).add(new THREE.Vector3(0, 0, 1)).normalize();
  handle.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), lean);
  handle.add(
    shaftOf(0.06 * length, -0.05 * length, 0.6 * length, steel),
    shaftOf(0.09 * length, 0.6 * length, 6 * length, dark),
  );
  const ghost = new THREE.Mesh(edge.geometry, seenThrough);
  ghost.position.copy(edge.position);
  ghost.rotation.copy(edge.rotation);
  ghost.renderOrder = 9;
  group.add(edge, ghost, handle);
  return group;
}

/** A scalpel whose blade has any length, seen through everything. In the axes of a camera it points away. */
export function ghostOfScalpel() {
  const group = scalpel(1, new THREE.Vector3(0.55, 1.1, 0.7).normalize()),
    [edge, through, handle] = group.children;
  group.remove(edge);
  group.traverse(part => {
    if (!part.isMesh) return;
    part.material = seenThrough;
    part.castShadow = false;
    part.renderOrder = 9;
  });
  group.visible = false;
  /** @param {number} length of the blade @param {number} most of it that its width is in proportion to */
  group.userData.fit = (length, most) => {
    const size = Math.min(length, most);
    through.scale.set(size, length, size);
    through.position.z = length / 2;
    handle.scale.set(size / 2, size / 2, size);
    handle.position.z = length;
  };
  return group;
}

// A rounded tip on a shaft; a capsule's axis leads from the tip along z.
function probe(radius, length) {
  const group = new THREE.Group(),
    tip = partOf(new THREE.CapsuleGeometry(radius, length, 12, 24), steel);
  tip.rotation.x = Math.PI / 2;
  tip.position.z = length / 2;
  tip.castShadow = true;
  group.add(
    tip,
    shaftOf(0.45 * radius, length + 0.5 * radius, length + 6 * radius, steel),
    shaftOf(0.7 * radius, length + 6 * radius, length + 80 * radius, dark),
  );
  return group;
}

// Two blocks that start at the origin and lead along z, one above and one below the plane y = 0. They open in
// parallel, and hang on a bar at the end of the shaft, which leads to where the surgeon stands.
function jaws([width, thickness, length], surgeon) {
  const group = new THREE.Group(),
    handle = new THREE.Group(),
    both = [-1, 1].map(() => partOf(new THREE.BoxGeometry(width, thickness, length), steel)),
    bar = partOf(new THREE.BoxGeometry(0.4 * width, 1, 0.12 * length), dark),
    r = 0.14 * width;
  for (const part of [...both, bar]) part.castShadow = true;
  bar.position.z = -0.06 * length;
  handle.position.z = -0.12 * length;
  handle.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), surgeon);
  handle.add(shaftOf(r, 0, 0.8 * length, steel), shaftOf(1.4 * r, 0.8 * length, 11 * length, dark));
  group.add(...both, bar, handle);
  group.userData.open = opening => {
    both.forEach((jaw, k) => jaw.position.set(0, (k === 0 ? -0.5 : 0.5) * (opening + thickness), length / 2));
    bar.scale.y = opening + 2 * thickness;
  };
  group.userData.open(0);
  return group;
}

function makeArrow() {
  const group = new THREE.Group(),
    material = arrowMaterial.clone();
  group.userData.material = material;
  const shaft = new THREE.Mesh(
    new THREE.CylinderGeometry(0.35, 0.35, 1, 16).translate(0, 0.5, 0),
    material,
  );
  const head = new THREE.Mesh(new THREE.ConeGeometry(1.1, 2.8, 20).translate(0, 1.2, 0), material);
  group.add(shaft, head);
  group.renderOrder = 10;
  shaft.renderOrder = head.renderOrder = 10;
  return group;
}
