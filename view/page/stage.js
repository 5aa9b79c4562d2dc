// Where the organ lies: renderer, light, camera. It draws when something has changed, and not otherwise.
import {fill, key, lamps, reflected, sky, walls} from './light.js';
import {firstQuick, ladder, Quality} from './quality.js';
import * as THREE from './third_party/three-0.187.0/three.module.js';

// Behind the organ, in either look of quality.js.
const themes = {
  dark: {fine: new THREE.Color(0x161d21), quick: new THREE.Color(0x203338), ground: 0x1d3a3f},
  light: {fine: new THREE.Color(0xdde5e8), quick: new THREE.Color(0xd2dcdf), ground: 0xb4c6c9},
};

const fallen = 3; // radii of the body, beyond which it has fallen away

/** What draws here, in words; null where there is no WebGL. */
export function graphics() {
  const context = document.createElement('canvas').getContext('webgl2');
  if (!context) return null;
  const info = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return {name, software: /swiftshader|llvmpipe|software/i.test(name)};
}

export class Stage {
  constructor(canvas, software) {
    this.canvas = canvas;
    this.software = software;
    // Nothing is behind it: the browser need not mix it with anything.
    const wanted = {alpha: false, stencil: true, antialias: !software, powerPreference: 'high-performance'};
    this.renderer = new THREE.WebGLRenderer({canvas, context: canvas.getContext('webgl2', wanted)});
    this.renderer.toneMapping = THREE.ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 1.05;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.scene = new THREE.Scene();
    const steps = ladder(Math.min(devicePixelRatio, software ? 1 : 2));
    [this.best] = steps;
    // Software stays in the quick look: to compile the shaders of the other takes it seconds. It draws fewer
    // pixels sooner, so that the hand waits less.
    this.quality = software
      ? new Quality(steps.slice(firstQuick(steps)), 0, {slow: 11, quick: 5})
      : new Quality(steps, 0);
    this.step = this.quality.step; // of quality.js, at which it draws
    this.theme = themes.dark;
    this.onLook = []; // called when it has changed
    this.onQuality = []; // called with the step, when that has changed by itself
    this.camera = new THREE.PerspectiveCamera(28, 1, 0.01, 10);
    this.camera.up.set(0, 0, 1);
    this.target = new THREE.Vector3();
    this.azimuth = -1.25;
    this.elevation = 0.38;
    this.distance = 0.6;
    this.size = 0.2;
    this.margins = {left: 0, right: 0, top: 0, bottom: 0}; // that panels cover [pixels]
    this.middle = new THREE.Vector3(); // of the body that it was told to look at
    this.shape = null; // of which the whole is seen from home: positions [m]
    this.isHome = false; // nobody has moved the camera since
    this.before = []; // called when the browser draws next, whether or not there is a new picture
    this.after = []; // called after each picture
    this.drawn = []; // called when the graphics card has finished it
    this.slow = 0; // what a picture takes, a mean [ms]
    this.pictures = 0;
    this.shadowAge = 0; // pictures since the shadow map was drawn
    this.addLights();
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  addLights() {
    this.key = farLight(key);
    this.key.castShadow = true;
    this.key.shadow.bias = -0.0006;
    this.key.shadow.normalBias = 0.0015;
    this.key.shadow.radius = 3;
    this.key.shadow.intensity = 0.75;
    const above = new THREE.HemisphereLight(sky.colour, sky.ground, sky.strength);
    above.position.set(...sky.from);
    this.scene.add(this.key, farLight(fill), above, this.key.target);
    this.ground = new THREE.Mesh(
      new THREE.CircleGeometry(1, 64),
      new THREE.MeshLambertMaterial({color: 0x1d3a3f}),
    );
    this.ground.receiveShadow = true;
    this.scene.add(this.ground);
    this.draws(this.step);
  }

  // What wet tissue reflects. It takes seconds where there is no graphics card, so only the fine look has it.
  addReflections() {
    if (this.scene.environment) return;
    const maker = new THREE.PMREMGenerator(this.renderer);
    this.scene.environment = maker.fromScene(operatingRoom(), 0.03).texture;
    this.scene.environmentIntensity = reflected;
    maker.dispose();
  }

  get look() {
    return this.step.look;
  }
  get pixelRatio() {
    return this.step.pixels;
  }

  /** Draws at a step of quality.js from now on, until it goes to another one by itself. */
  draws(step) {
    this.step = step;
    const fine = step.look === 'fine',
      {shadow} = this.key;
    if (fine) this.addReflections();
    document.body.classList.toggle('plain-glass', !fine); // blurring takes as long as the organ
    this.renderer.shadowMap.enabled = this.key.castShadow = this.ground.visible = fine;
    this.renderer.shadowMap.autoUpdate = false;
    this.renderer.shadowMap.needsUpdate = true;
    if (fine && shadow.mapSize.x !== step.shadow) {
      shadow.mapSize.setScalar(step.shadow);
      shadow.map?.dispose();
      shadow.map = null;
    }
    this.scene.background = this.theme[step.look];
    this.ground.material.color.set(this.theme.ground);
    this.scene.fog = fine ? new THREE.Fog(this.theme.fine, 5 * this.size, 14 * this.size) : null;
    for (const f of this.onLook) f();
    this.resize();
  }

  setTheme(/** @type {'dark'|'light'} */ name) {
    this.theme = themes[name];
    this.draws(this.step);
  }

  /** What lays things flat on the ground, along the light. */
  ontoGround() {
    const light = this.key.position.clone().sub(this.key.target.position),
      height = this.ground.position.z;
    const [x, y] = [light.x / light.z, light.y / light.z];
    return new THREE.Matrix4().set(1, 0, -x, x * height, 0, 1, -y, y * height, 0, 0, 0, height, 0, 0, 0, 1);
  }

  /** The ground lies below what stands there, too. */
  lowerGround(/** @type {number} */ z) {
    this.ground.position.z = Math.min(this.ground.position.z, z - 0.02 * this.size);
  }

  /** Lights a body, and looks at it [m]. */
  lookAt(points) {
    const box = new THREE.Box3().setFromArray(points),
      sphere = box.getBoundingSphere(new THREE.Sphere());
    this.size = sphere.radius;
    this.middle = sphere.center;
    this.ground.position.set(sphere.center.x, sphere.center.y, box.min.z - 0.12 * this.size);
    this.ground.scale.setScalar(30 * this.size);
    const light = this.key.shadow.camera,
      reach = 1.7 * this.size;
    this.key.position
      .copy(sphere.center)
      .add(new THREE.Vector3(...key.from).multiplyScalar(2 * this.size));
    this.key.target.position.copy(sphere.center);
    Object.assign(light, {
      left: -reach,
      right: reach,
      top: reach,
      bottom: -reach,
      near: this.size,
      far: 10 * this.size,
    });
    light.updateProjectionMatrix();
    this.draws(this.step);
    this.home(points);
  }

  setMargins(margins) {
    this.margins = margins;
    this.resize();
    if (this.isHome) this.home();
  }

  /** The share of the window that is open, of its width and of its height. */
  openShares() {
    const {clientWidth: w, clientHeight: h} = this.canvas,
      {left, right, top, bottom} = this.margins;
    return [Math.max(0.3, (w - left - right) / w), Math.max(0.3, (h - top - bottom) / h)];
  }

  /** Looks from the front, so that all of these points are between the panels; what fell away is left out. */
  home(points = this.shape) {
    if (!points) return;
    const near = this.nearOf(points);
    if (near.length > 0) points = near;
    this.shape = points;
    this.azimuth = -1.25;
    this.elevation = 0.38;
    new THREE.Box3().setFromArray(points).getCenter(this.target);
    this.place();
    this.distance = this.distanceFor(points);
    this.place();
    this.lowerGround(lowest(points) - 0.02 * this.size);
    this.isHome = true;
  }

  // From there each point is within the open part of the window: of a point that is x aside, y above and z
  // nearer than the target, at least z + max(x / tan(width), y / tan(height)).
  distanceFor(points) {
    const [openWidth, openHeight] = this.openShares(),
      fill = 0.9,
      half = fill * Math.tan((this.camera.fov * Math.PI) / 360),
      halfWidth = half * this.camera.aspect * openWidth,
      halfHeight = half * openHeight,
      [right, above, forward] = [this.right(), this.above(), this.forward()];
    const {x: tx, y: ty, z: tz} = this.target;
    let distance = 0.1 * this.size;
    for (let i = 0; i < points.length; i += 3) {
      const [x, y, z] = [points[i] - tx, points[i + 1] - ty, points[i + 2] - tz];
      const aside = Math.abs(x * right.x + y * right.y + z * right.z) / halfWidth,
        up = Math.abs(x * above.x + y * above.y + z * above.z) / halfHeight;
      const nearer = -(x * forward.x + y * forward.y + z * forward.z);
      distance = Math.max(distance, nearer + Math.max(aside, up));
    }
    return distance;
  }

  /** Where nobody has moved the camera yet, it follows a body that moves far, as one that begins to sag. What
   *  falls away it lets go. */
  follow(points) {
    if (!this.isHome) return;
    const near = this.nearOf(points);
    if (near.length > 0 && this.distanceOf(near) >= 0.05 * this.size) this.home(near);
  }

  // Those of these points that have not left the place where the body was.
  nearOf(points) {
    const {x, y, z} = this.middle,
      near = [];
    for (let i = 0; i < points.length; i += 3)
      if (Math.hypot(points[i] - x, points[i + 1] - y, points[i + 2] - z) < fallen * this.size)
        near.push(points[i], points[i + 1], points[i + 2]);
    return near;
  }

  // How far the box of these points is from that of what is seen from home [m].
  distanceOf(points) {
    const box = new THREE.Box3().setFromArray(points),
      seen = new THREE.Box3().setFromArray(this.shape);
    return Math.max(box.min.distanceTo(seen.min), box.max.distanceTo(seen.max));
  }

  place() {
    this.elevation = Math.max(-1.5, Math.min(1.5, this.elevation));
    this.distance = Math.max(0.5 * this.size, Math.min(12 * this.size, this.distance));
    const c = Math.cos(this.elevation);
    this.camera.position
      .set(Math.cos(this.azimuth) * c, Math.sin(this.azimuth) * c, Math.sin(this.elevation))
      .multiplyScalar(this.distance)
      .add(this.target);
    this.camera.near = 0.05 * this.distance;
    this.camera.far = 40 * this.size + this.distance;
    this.camera.lookAt(this.target);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.invalidate();
  }

  turn(dx, dy) {
    this.isHome = false;
    this.azimuth -= 0.006 * dx;
    this.elevation += 0.006 * dy;
    this.place();
  }

  shift(dx, dy) {
    this.isHome = false;
    const scale = this.metresPerPixel(this.target);
    this.target.addScaledVector(this.right(), -dx * scale).addScaledVector(this.above(), dy * scale);
    this.place();
  }

  zoom(factor) {
    this.isHome = false;
    this.distance *= factor;
    this.place();
  }

  right() {
    return new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
  }
  above() {
    return new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
  }
  forward() {
    return this.camera.getWorldDirection(new THREE.Vector3());
  }
  depth(point) {
    return point.clone().sub(this.camera.position).dot(this.forward());
  }
  metresPerPixel(point) {
    return (2 * this.depth(point) * Math.tan((this.camera.fov * Math.PI) / 360)) / this.canvas.clientHeight;
  }

  /** The ray through a place of the window. */
  ray(x, y) {
    const at = new THREE.Vector2(
      (2 * x) / this.canvas.clientWidth - 1,
      1 - (2 * y) / this.canvas.clientHeight,
    );
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, this.camera);
    return caster.ray;
  }

  /** Where a point is in the window [pixels]; null behind the camera. */
  project(point) {
    if (this.depth(point) <= 0) return null;
    const p = point.clone().project(this.camera);
    return {x: ((p.x + 1) / 2) * this.canvas.clientWidth, y: ((1 - p.y) / 2) * this.canvas.clientHeight};
  }

  resize() {
    const {clientWidth: w, clientHeight: h} = this.canvas;
    this.renderer.setPixelRatio(this.pixelRatio);
    this.renderer.setSize(w, h, false);
    const {left, right, top, bottom} = this.margins;
    this.camera.aspect = w / h;
    this.camera.setViewOffset(w, h, (right - left) / 2, (bottom - top) / 2, w, h);
    this.place();
  }

  /** There is something new to see. */
  invalidate() {
    this.isOld = true;
    this.wake();
  }

  /** There may be. Where the last picture is not finished yet, what is old by then is never drawn. */
  wake() {
    if (this.isAwake) return;
    this.isAwake = true;
    if (this.fence) return; // then watch() goes on
    requestAnimationFrame(() => {
      this.isAwake = false;
      this.begun = performance.now();
      for (const f of this.before) f();
      if (!this.isOld) return;
      this.draw();
      for (const f of this.after) f();
    });
  }

  draw() {
    this.isOld = false;
    this.pictures += 1;
    this.begun ??= performance.now();
    this.ageShadow();
    this.renderer.render(this.scene, this.camera);
    const gl = this.renderer.getContext();
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    this.watch();
  }

  // Where not every picture has its shadows drawn anew, the last one before all is still has.
  ageShadow() {
    const {shadowMap} = this.renderer;
    if (!shadowMap.enabled) return;
    clearTimeout(this.lastShadow);
    this.shadowAge = this.shadowAge + 1 >= this.step.every ? 0 : this.shadowAge + 1;
    if (this.shadowAge === 0) shadowMap.needsUpdate = true;
    if (shadowMap.needsUpdate) return;
    this.lastShadow = setTimeout(() => {
      shadowMap.needsUpdate = true;
      this.invalidate();
    }, 150);
  }

  /** Whether the graphics card, or what stands in for it, has finished the last picture. */
  isDrawn() {
    const gl = this.renderer.getContext(),
      took = performance.now() - this.begun;
    if (gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED && took < 1000) return false;
    gl.deleteSync(this.fence);
    this.fence = this.begun = null;
    this.slow += 0.15 * (took - this.slow);
    this.adapt(took);
    for (const f of this.drawn) f();
    if (this.isAwake) {
      this.isAwake = false;
      this.wake();
    }
    return true;
  }

  /** How long it takes. */
  watch() {
    setTimeout(() => {
      if (this.fence && !this.isDrawn()) this.watch();
    }, 3);
  }

  /** How often what is beside the picture may change: the more it costs, the less often [ms]. */
  betweenFigures() {
    return Math.max(120, 5 * this.slow);
  }

  /** A picture took so long [ms]. Goes to another step of quality where that is too long, or very short. */
  adapt(took) {
    if (document.hidden || !this.quality.drew(took, performance.now())) return;
    this.draws(this.quality.step);
    for (const f of this.onQuality) f(this.step);
  }

  /** Draws at this step of quality, whatever it takes. */
  hold(step) {
    this.adapt = () => {};
    this.draws(step);
  }

  /** A picture without haste: what is on the canvas is that until the next one is drawn. */
  drawFine(then) {
    const {step, best} = this;
    this.draws({...best, pixels: Math.max(1, best.pixels)});
    this.renderer.render(this.scene, this.camera);
    then(this.canvas);
    this.draws(step);
  }
}

function lowest(points) {
  let z = Infinity;
  for (let i = 2; i < points.length; i += 3) z = Math.min(z, points[i]);
  return z;
}

const farLight = ({colour, strength, from}) => {
  const light = new THREE.DirectionalLight(colour, strength);
  light.position.set(...from);
  return light;
};

// Lamps and walls that wet tissue reflects.
function operatingRoom() {
  const room = new THREE.Scene();
  room.background = new THREE.Color(walls.colour);
  for (const {colour, strength, width, height, at} of lamps) {
    const lamp = new THREE.Mesh(
      new THREE.PlaneGeometry(width, height),
      new THREE.MeshBasicMaterial({
        color: new THREE.Color(colour).multiplyScalar(strength),
        side: THREE.DoubleSide,
      }),
    );
    lamp.position.set(...at);
    lamp.lookAt(0, 0, 0);
    room.add(lamp);
  }
  return room;
}
