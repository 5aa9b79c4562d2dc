// What the organ is made of, for the eye. `fine`: wet tissue with shadows, for graphics cards. `quick`: the
// same light, found once on a sphere (light.js) and looked up by the normal; for what stands in for a card.
import {litSphere} from './light.js';
import * as THREE from './third_party/three-0.187.0/three.module.js';

// Fine unevenness of the tissue under its wet film, from the position at rest so that it moves with the
// organ: the slope in xyz, the height in w, from 0 to 1. What is finer than pixels is left out, since it
// would flicker.
const noise = /* glsl */ `
varying vec3 vRest;
float hashed(vec3 p) {
  p = 17.0 * fract(p * 0.3183099 + 0.1);
  return fract(p.x * p.y * p.z * (p.x + p.y + p.z));
}
vec4 unevenness(vec3 p) {
  vec3 i = floor(p), f = fract(p), s = f * f * (3.0 - 2.0 * f);
  vec2 e = vec2(0, 1);
  vec4 low = vec4(hashed(i), hashed(i + e.yxx), hashed(i + e.xyx), hashed(i + e.yyx));
  vec4 high = vec4(hashed(i + e.xxy), hashed(i + e.yxy), hashed(i + e.xyy), hashed(i + e.yyy));
  vec4 between = mix(low, high, s.z), up = high - low;
  vec2 across = mix(between.xz, between.yw, s.x), along = mix(between.xy, between.zw, s.y);
  vec2 upwards = mix(up.xz, up.yw, s.x);
  vec3 slope = 6.0 * f * (1.0 - f) *
    vec3(along.y - along.x, across.y - across.x, mix(upwards.x, upwards.y, s.y));
  float wide = max(length(dFdx(p)), length(dFdy(p))), share = 1.0 - smoothstep(0.35, 1.1, wide);
  return vec4(share * slope, mix(0.5, mix(across.x, across.y, s.y), share));
}
vec3 tilted(vec3 n, vec3 slope) {
  vec3 g = mat3(viewMatrix) * slope;
  return normalize(n - g + dot(g, n) * n);
}
`;

// Lines along edges are drawn on top of their triangles.
const underLines = {polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1};

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
        vec4 grain = unevenness(vRest * 900.0), patches = unevenness(vRest * 260.0);
        normal = tilted(normal, ${amount} * (900.0 * grain.xyz + 520.0 * patches.xyz));
        diffuseColor.rgb *= 0.86 + 0.16 * grain.w + 0.14 * patches.w;`,
      )
      .replace(
        '#include <clearcoat_normal_fragment_maps>',
        `#include <clearcoat_normal_fragment_maps>
        #ifdef USE_CLEARCOAT
          clearcoatNormal = tilted(clearcoatNormal, ${wetness} * 260.0 * patches.xyz);
        #endif`,
      );
  };
}

const seenThrough = {transparent: true, opacity: 0.22, depthWrite: false};

function fineSkin(more) {
  const skin = new THREE.MeshPhysicalMaterial({
    ...underLines,
    vertexColors: true,
    clearcoatRoughness: 0.22,
    ...more,
  });
  roughen(skin, '0.00022', '0.0001');
  return skin;
}

// Fresh cuts are wet with blood.
function fineCut(more) {
  const cut = new THREE.MeshPhysicalMaterial({
    ...underLines,
    vertexColors: true,
    roughness: 0.6,
    clearcoat: 0.7,
    clearcoatRoughness: 0.15,
    envMapIntensity: 0.7,
    side: THREE.DoubleSide,
    ...more,
  });
  roughen(cut, '0.0004', '0.0003');
  return cut;
}

function fineChar(more) {
  const char = new THREE.MeshStandardMaterial({
    ...underLines,
    vertexColors: true,
    roughness: 0.95,
    envMapIntensity: 0.3,
    side: THREE.DoubleSide,
    ...more,
  });
  roughen(char, '0.0', '0.0006');
  return char;
}

/** Of skin, of what was cut, and of what was charred; after each of them faded.
 *  @returns {{materials: THREE.Material[], shine(on: boolean): void}} */
export function fineLook() {
  const materials = [fineSkin, fineCut, fineChar].flatMap(make => [make(), make(seenThrough)]);
  const shine = on => {
    for (const skin of materials.slice(0, 2)) {
      skin.clearcoat = on ? 0.6 : 0.12;
      skin.roughness = on ? 0.5 : 0.6;
    }
  };
  shine(true);
  return {materials, shine};
}

const across = 128; // pixels of the sphere

// What the colour of a point is multiplied by, and in the fourth channel what its wet film adds.
function lightMap(stage, roughness, wet, reflects) {
  const [right, above, back] = [stage.right(), stage.above(), stage.forward().negate()].map(v => v.toArray());
  const lit = litSphere(across, {right, above, back}, {roughness, reflects, wet});
  const data = Uint16Array.from(lit, THREE.DataUtils.toHalfFloat);
  const map = new THREE.DataTexture(data, across, across, THREE.RGBAFormat, THREE.HalfFloatType);
  map.minFilter = map.magFilter = THREE.LinearFilter;
  map.needsUpdate = true;
  return map;
}

function lookedUp(map, options) {
  const material = new THREE.MeshMatcapMaterial({...underLines, vertexColors: true, matcap: map, ...options});
  material.wetness = {value: 1};
  material.onBeforeCompile = shader => {
    shader.uniforms.wetness = material.wetness;
    shader.fragmentShader =
      'uniform float wetness;\n' +
      shader.fragmentShader.replace(
        'vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;',
        'vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb + wetness * matcapColor.a;',
      );
  };
  return material;
}

/** The light stays with the camera, as if it was worn on the head. */
export function quickLook(stage) {
  const bothSides = {side: THREE.DoubleSide};
  const materials = [
    [lightMap(stage, 0.5, 0.6, 1), {}],
    [lightMap(stage, 0.6, 0.8, 0.7), bothSides],
    [lightMap(stage, 0.95, 0, 0.3), bothSides],
  ].flatMap(([map, options]) => [lookedUp(map, options), lookedUp(map, {...options, ...seenThrough})]);
  const shine = on => {
    for (const skin of materials.slice(0, 2)) skin.wetness.value = on ? 1 : 0.2;
  };
  return {materials, shine};
}
