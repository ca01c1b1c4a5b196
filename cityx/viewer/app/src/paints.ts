/**
 * Materials of the city. Their pictures are the layers of one texture and their numbers the columns
 * of a table, so surfaces of all of them are drawn by one call.
 */

import {
  Color, DataArrayTexture, DataTexture, DoubleSide, FloatType, FrontSide, LinearFilter, LinearMipmapLinearFilter,
  LinearMipmapNearestFilter,
  LinearSRGBColorSpace, Matrix4, MeshBasicMaterial, MeshStandardMaterial, NearestFilter, RepeatWrapping, SRGBColorSpace,
  NoColorSpace, Vector3, type Texture, type WebGLProgramParametersWithUniforms,
} from 'three';
import type { GLTF } from 'three/addons/loaders/GLTFLoader.js';

/** Which look a mesh is shown in. */
export type Coloring = 'natural' | 'class' | 'instance' | 'height' | 'provenance';

/** Shares of lit rooms: homes, work, shops; and whether lamps are on. */
export const lights = { rooms: { value: [0, 0, 0] as [number, number, number] }, lamps: { value: 0 } };

/** How wet and how snowed-over surfaces are, 0 to 1, and what of the sky they mirror: see `Sky`. */
export const weather = {
  wetness: { value: 0 }, lyingSnow: { value: 0 }, skyHigh: { value: new Color() }, skyLow: { value: new Color() },
};

/** Light as a machine without a graphics card reckons it, by vertices: see `Sky`. */
export const plainLight = {
  sunWay: { value: new Vector3(0, 1, 0) }, sunLight: { value: new Color() }, skyLight: { value: new Color() },
  groundLight: { value: new Color() }, shadowPlace: { value: new Matrix4() }, shadowDepths: { value: null as Texture | null },
  shadowed: { value: 0 },
};

const LAMP_STRENGTH = 4;
// Lights of signals, counted from 1, and how bright they burn: those of `cityx.blender.materials`.
const SIGNALS = ['signal_stop', 'signal_amber', 'signal_green', 'walk_red', 'walk_green'];
const SIGNAL_GLOW = [[1, 0.03, 0.02], [1, 0.42, 0.02], [0.02, 0.85, 0.42], [1, 0.03, 0.02], [0.02, 0.85, 0.42]];
const SIGNAL_STRENGTH = 1.1;
const COLOR_EDGE = 512; // pixels of a picture
const PLAIN_EDGE = 256;
const RELIEF_EDGE = 256;
const AT_LEAST = 16; // layers that a texture has room for
const AT_ONCE = 16; // pictures that are read back together
const ROWS = 3; // of the table: colour and flags; glow and how snow lies; roughness, metalness, relief and what rain does
// A closed film of water and snow, as `cityx.assets.styles` and `cityx.outputs.gltf_material` have them.
const [DRIEST, FILM_ROUGHNESS, FILMED] = [0.45, 0.12, 0.6];
const SNOW = new Color(0.8, 0.82, 0.86);

export type Shown = MeshStandardMaterial | MeshBasicMaterial;

/** What a mesh needs to know of a material to be merged with others. */
export interface Paint {
  layer: number;
  double: boolean;
  clear: boolean;
}

export class Paints {
  /** Whether surfaces are shown without gloss and relief, as a machine without a graphics card can. */
  plain = false;
  readonly base = new Map<string, MeshStandardMaterial>();
  /** What rain and snow do to each: `weathering` of `cityx.viewer.content`. */
  private readonly weathering = new Map<string, [porosity: number, pools: number, snow: number, share: number]>();
  /** Materials that the tint of a row leaves as they are. */
  private readonly untinted = new Set<string>();
  private readonly layers = new Map<string, number>([['', 0]]);
  private readonly known = new Map<string, Shown>();
  private readonly pictures: Record<'color' | 'rough' | 'normal', DataArrayTexture | null> = {
    color: null, rough: null, normal: null,
  };
  private readonly uniforms = {
    paintTable: { value: null as DataTexture | null }, paintColors: { value: null as DataArrayTexture | null },
    paintRoughs: { value: null as DataArrayTexture | null }, paintNormals: { value: null as DataArrayTexture | null },
    roomShares: lights.rooms, lampsOn: lights.lamps, ...weather,
  };

  /** Take the materials of a file; each keeps the layer that it has. */
  async read(file: GLTF): Promise<void> {
    const told = file.scene.userData as { materials?: string[]; untinted?: string[]; weather?: [number, number, number, number][] };
    const names = told.materials ?? [];
    told.weather?.forEach((does, number) => this.weathering.set(names[number] ?? '', does));
    told.untinted?.forEach((name) => this.untinted.add(name));
    await Promise.all(
      names.map(async (name, number) => {
        const made = (await file.parser.getDependency('material', number)) as MeshStandardMaterial;
        made.name = name;
        this.base.set(name, made);
        if (!this.layers.has(name)) this.layers.set(name, this.layers.size);
      }),
    );
    this.fill();
  }

  /** A material of the city as a file has it: in the weather of now, but for what faces up. */
  weathered(name: string): MeshStandardMaterial {
    const found = (this.base.get(name) ?? new MeshStandardMaterial()).clone();
    const [porosity, , , share] = this.weathering.get(name) ?? [0, 0, 0, 0];
    const wet = weather.wetness.value;
    const white = share * weather.lyingSnow.value;
    found.color.multiplyScalar(1 - DRIEST * wet * porosity).lerp(SNOW, white);
    found.roughness += (FILM_ROUGHNESS - found.roughness) * FILMED * wet;
    found.roughness += (0.7 - found.roughness) * white;
    return found;
  }

  /** Where a material is found, layer 0 for one that is not known. */
  paint(name: string): Paint {
    const base = this.base.get(name);
    return {
      layer: this.layers.get(name) ?? 0, double: base?.side === DoubleSide, clear: base?.transparent ?? false,
    };
  }

  /** The one material that shows meshes of all paints, or those of all clear ones. */
  get(double: boolean, clear: boolean): Shown {
    const key = `${double} ${clear}`;
    let found = this.known.get(key);
    if (!found) {
      found = this.plain ? new MeshBasicMaterial() : new MeshStandardMaterial();
      found.side = double ? DoubleSide : FrontSide;
      if (clear) {
        const first = [...this.base.values()].find((each) => each.transparent);
        Object.assign(found, { transparent: true, depthWrite: false, opacity: first?.opacity ?? 0.5 });
      }
      found.onBeforeCompile = (shader) => this.compile(shader);
      found.customProgramCacheKey = () => `paints ${this.plain}`;
      this.known.set(key, found);
    }
    return found;
  }

  private fill(): void {
    const count = Math.max(AT_LEAST, 2 ** Math.ceil(Math.log2(this.layers.size)));
    const table = new Float32Array(count * ROWS * 4).fill(1);
    table.set([0, 0, 0, 0], count * 4);
    table.set([0.8, 0, 0, 0], count * 8);
    for (const [name, layer] of this.layers) {
      const base = this.base.get(name);
      if (!base) continue;
      const dark = this.plain && base.metalness > 0.5 ? 0.6 : 1; // what it mirrors is darker than itself
      const signal = SIGNALS.indexOf(name);
      const flags = (this.untinted.has(name) ? 0 : 1) + (name === 'glass' ? 2 : 0) + 4 * (signal + 1);
      const glow = signal < 0
        ? base.emissive.clone().multiplyScalar(base.emissiveIntensity * LAMP_STRENGTH)
        : new Color(...(SIGNAL_GLOW[signal] as [number, number, number])).multiplyScalar(SIGNAL_STRENGTH);
      table.set([base.color.r * dark, base.color.g * dark, base.color.b * dark, flags], layer * 4);
      const [porosity, pools, snow] = this.weathering.get(name) ?? [0, 0, 0];
      table.set([glow.r, glow.g, glow.b, snow], (count + layer) * 4);
      table.set([base.roughness, base.metalness, base.normalMap ? base.normalScale.x : 0, porosity + 2 * pools], (count * 2 + layer) * 4);
    }
    this.uniforms.paintTable.value?.dispose();
    const made = new DataTexture(table, count, ROWS, undefined, FloatType);
    made.minFilter = made.magFilter = NearestFilter;
    made.needsUpdate = true;
    this.uniforms.paintTable.value = made;
    this.draw(count);
  }

  private draw(count: number): void {
    const draw = (kind: 'color' | 'rough' | 'normal', edge: number, empty: string, of: (base: MeshStandardMaterial) => Texture | null): DataArrayTexture => {
      const held = this.pictures[kind];
      held?.dispose();
      const images = Array.from({ length: count }, () => null as CanvasImageSource | null);
      for (const [name, layer] of this.layers) {
        const base = this.base.get(name);
        images[layer] = ((base && of(base)?.image) ?? null) as CanvasImageSource | null;
      }
      const made = layered(images, edge, empty);
      made.colorSpace = kind === 'color' && !this.plain ? SRGBColorSpace : NoColorSpace; // else the shader decodes it
      made.anisotropy = this.plain ? 1 : 4;
      made.minFilter = this.plain ? LinearMipmapNearestFilter : LinearMipmapLinearFilter;
      return (this.pictures[kind] = made);
    };
    this.uniforms.paintColors.value = draw('color', this.plain ? PLAIN_EDGE : COLOR_EDGE, '#ffffff', (base) => base.map);
    if (this.plain) return;
    this.uniforms.paintRoughs.value = draw('rough', RELIEF_EDGE, '#ffffff', (base) => base.roughnessMap);
    this.uniforms.paintNormals.value = draw('normal', RELIEF_EDGE, '#8080ff', (base) => base.normalMap);
  }

  private compile(shader: WebGLProgramParametersWithUniforms): void {
    Object.assign(shader.uniforms, this.uniforms);
    if (this.plain) {
      this.compilePlain(shader);
      return;
    }
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', `#include <common>\n${VERTEX_HEAD}`)
      .replace('#include <color_vertex>', VERTEX_BODY);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>\n${FRAGMENT_HEAD}\n${RELIEF_HEAD}\n${WEATHER_HEAD}`)
      .replace('#include <map_fragment>', 'diffuseColor.rgb *= texture(paintColors, vPlace).rgb * vTint;')
      .replace('#include <color_fragment>', '')
      .replace('#include <emissivemap_fragment>', 'totalEmissiveRadiance += vGlow.rgb;')
      .replace('#include <roughnessmap_fragment>', 'float roughnessFactor = vSurface.x * texture(paintRoughs, vPlace).g;')
      .replace('#include <metalnessmap_fragment>', 'float metalnessFactor = vSurface.y * texture(paintRoughs, vPlace).b;')
      .replace('#include <normal_fragment_maps>', `if (vSurface.z > 0.0) normal = relief(normal);\n${WEATHER_BODY}`);
  }

  /** Light by vertices: what a picture costs without a graphics card is the work of each pixel. */
  private compilePlain(shader: WebGLProgramParametersWithUniforms): void {
    Object.assign(shader.uniforms, plainLight);
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', `#include <common>\n#define TELLS_ALL false\n${VERTEX_HEAD}\n${PLAIN_HEAD}`)
      .replace('#include <color_vertex>', VERTEX_BODY)
      .replace('#include <fog_vertex>', `#include <fog_vertex>\n${PLAIN_BODY}`);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', `#include <common>\n${FRAGMENT_HEAD}\n${PLAIN_FRAGMENT}`)
      .replace('#include <color_fragment>', '')
      .replace('#include <map_fragment>', 'diffuseColor.rgb = mix(decoded(texture(paintColors, vPlace).rgb), SNOW, vWhite) * (vAround + vSun * unshaded()) + vGlow.rgb;')
      .replace('#include <colorspace_fragment>', 'gl_FragColor.rgb = encoded(gl_FragColor.rgb);')
      .replace('#include <fog_fragment>', 'gl_FragColor.rgb = mix(gl_FragColor.rgb, fogColor, vHaze);');
  }
}

const VERTEX_HEAD = `
#ifndef TELLS_ALL
#define TELLS_ALL true
#endif
attribute vec4 paint;
uniform sampler2D paintTable;
uniform vec3 roomShares;
uniform float lampsOn;
uniform float wetness;
uniform float lyingSnow;
varying vec3 vPlace;
flat varying vec4 vSurface;
varying vec3 vTint;
flat varying vec4 vGlow;
#ifdef USE_INSTANCING
attribute vec2 room;
// Whether a light of a pole burns; the red ones where it is not known what is shown.
float burns(int signal) {
  int shows = int(room.x + 0.5), walks = int(room.y + 0.5);
  if (signal == 1) return float(shows == 0 || shows == 2 || shows == 3);
  if (signal == 2) return float(shows == 3 || shows == 4);
  if (signal == 3) return float(shows == 5 || shows == 6);
  return signal == 4 ? float(walks < 2) : float(walks == 2);
}
#else
float burns(int signal) { return float(signal == 1 || signal == 4); }
#endif`;

const VERTEX_BODY = `
int layer = int(paint.w * 255.0 + 0.5);
vec4 look = texelFetch(paintTable, ivec2(layer, 0), 0);
vPlace = vec3(uv, float(layer));
vTint = paint.rgb * look.rgb;
int flags = int(look.w + 0.5);
int signal = flags >> 2;
vGlow = vec4(0.0);
vSurface = vec4(0.0);
if (TELLS_ALL || signal > 0 || lampsOn + wetness + lyingSnow > 0.0) { // a fetch for each vertex takes time
  vGlow = texelFetch(paintTable, ivec2(layer, 1), 0);
  vGlow.rgb *= signal > 0 ? burns(signal) : lampsOn;
  vSurface = texelFetch(paintTable, ivec2(layer, 2), 0);
}
#ifdef USE_INSTANCING_COLOR
if ((flags & 1) > 0) vTint *= instanceColor;
#endif
#ifdef USE_INSTANCING
float share = room.x < 0.5 ? roomShares.x : room.x < 1.5 ? roomShares.y : roomShares.z;
if ((flags & 2) > 0 && room.y < share) vGlow.rgb += vec3(1.0, 0.72, 0.38) * (0.7 + 1.3 * fract(room.y * 37.0));
#endif`;

// What water and snow do, by how far a surface faces up; `snow` is the row of `weathering`.
const WEATHER = `
const float DRIEST = ${DRIEST};
const vec3 SNOW = vec3(${SNOW.toArray().join(', ')});
float reached(float up) { return 0.35 + 0.65 * smoothstep(0.1, 0.8, up); }
float lying(float snow, float up, float patches) {
  if (snow > 1.5) return 0.8 * smoothstep(-0.6, 0.9, up + 0.8 * patches - 0.4);
  return snow * smoothstep(0.72, 0.95, up + 0.3 * patches) * smoothstep(0.5, 0.6, up);
}`;

const PLAIN_HEAD = `${WEATHER}
uniform vec3 sunWay;
uniform vec3 sunLight;
uniform vec3 skyLight;
uniform vec3 groundLight;
uniform mat4 shadowPlace;
uniform float fogDensity;
varying float vHaze;
varying float vWhite;
varying vec3 vAround;
varying vec3 vSun;
varying vec3 vShadow;`;

const PLAIN_BODY = `
vec3 facing = normal;
vec4 stood = vec4(transformed, 1.0);
#ifdef USE_INSTANCING
mat3 turned = mat3(instanceMatrix);
facing = normalize(turned * (facing / vec3(dot(turned[0], turned[0]), dot(turned[1], turned[1]), dot(turned[2], turned[2]))));
stood = instanceMatrix * stood;
#endif
stood = modelMatrix * stood;
float thick = fogDensity * fogDensity * mvPosition.z * mvPosition.z;
vHaze = 1.0 - 1.0 / (1.0 + thick * (1.0 + thick * (0.5 + thick * 0.2))); // about 1 - exp(-thick)
vWhite = 0.0;
if (wetness + lyingSnow > 0.0) { // noise and what is mirrored would be the work of pixels
  float porosity = vSurface.w < 2.0 ? vSurface.w : vSurface.w - 2.0;
  vTint *= 1.0 - DRIEST * wetness * reached(facing.y) * porosity;
  vWhite = clamp(1.18 * lyingSnow, 0.0, 1.0) * lying(vGlow.w, facing.y, 0.5);
  vTint = mix(vTint, vec3(1.0), vWhite);
}
vAround = vTint * mix(groundLight, skyLight, 0.5 * facing.y + 0.5);
vSun = vTint * sunLight * max(dot(facing, sunWay), 0.0);
vShadow = (shadowPlace * (stood + vec4(facing * 0.25, 0.0))).xyz;`;

const PLAIN_FRAGMENT = `
uniform highp sampler2D shadowDepths;
uniform float shadowed;
const vec3 SNOW = vec3(${SNOW.toArray().join(', ')});
varying float vHaze;
varying float vWhite;
varying vec3 vAround;
varying vec3 vSun;
varying vec3 vShadow;
// The curve of sRGB within a hundredth, without powers.
vec3 decoded(vec3 told) { return told * (told * (told * 0.305306 + 0.682171) + 0.012523); }
vec3 encoded(vec3 light) { return 1.13 * sqrt(light) - 0.13 * light; }
float unshaded() {
  if (shadowed < 0.5 || any(lessThan(vShadow, vec3(0.0))) || any(greaterThan(vShadow, vec3(1.0)))) return 1.0;
  return step(vShadow.z - 0.0004, texture(shadowDepths, vShadow.xy).r);
}`;

const FRAGMENT_HEAD = `
uniform highp sampler2DArray paintColors;
varying vec3 vPlace;
flat varying vec4 vSurface;
varying vec3 vTint;
flat varying vec4 vGlow;`;

// Chance that goes on smoothly over the ground, 0 to 1.
const WEATHER_HEAD = `${WEATHER}
uniform float wetness;
uniform float lyingSnow;
uniform vec3 skyHigh;
uniform vec3 skyLow;
float chance(ivec2 at) {
  uint mixed = uint(at.x) * 1597334677u ^ uint(at.y) * 3812015801u;
  mixed = (mixed ^ mixed >> 15) * 2246822519u;
  return float(mixed >> 8) / 16777216.0;
}
float noise(vec2 at) {
  ivec2 corner = ivec2(floor(at));
  vec2 by = smoothstep(0.0, 1.0, at - floor(at));
  return mix(mix(chance(corner), chance(corner + ivec2(1, 0)), by.x),
             mix(chance(corner + ivec2(0, 1)), chance(corner + ivec2(1, 1)), by.x), by.y);
}`;

const WEATHER_BODY = `
if (wetness + lyingSnow > 0.0) {
  vec3 high = (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz, toEye = normalize(vViewPosition);
  vec3 stood = cameraPosition - vViewPosition * mat3(viewMatrix);
  float up = dot(nonPerturbedNormal, high);
  float level = float(vSurface.w >= 2.0);
  float patches = 0.6 * noise(stood.xz * 0.8) + 0.4 * noise(stood.xz * 3.1);
  float wet = wetness * reached(up);
  float hollow = 0.7 * noise(stood.xz * 0.23) + 0.3 * noise(stood.xz * 0.9);
  float pooled = level * smoothstep(0.97, 0.995, up) * clamp(wetness * 2.0 - 0.6, 0.0, 1.0)
    * smoothstep(0.0, 0.05, hollow - 0.66 + 0.13 * wetness);
  float white = clamp(1.18 * lyingSnow, 0.0, 1.0) * lying(vGlow.w, up, patches);
  if (vGlow.w < 1.0) white *= 0.4 + 1.2 * patches; // tyres leave some of it
  diffuseColor.rgb *= (1.0 - DRIEST * wet * (vSurface.w - 2.0 * level)) * (1.0 - 0.4 * pooled);
  diffuseColor.rgb = mix(diffuseColor.rgb, SNOW, white);
  roughnessFactor = mix(roughnessFactor, ${FILM_ROUGHNESS}, ${FILMED} * wet);
  roughnessFactor = mix(mix(roughnessFactor, 0.03, pooled), 0.7, white);
  metalnessFactor *= 1.0 - white;
  normal = normalize(mix(normal, nonPerturbedNormal, max(pooled, 0.5 * wet)));
  float share = 0.02 + 0.98 * pow(1.0 - max(dot(normal, toEye), 0.0), 5.0);
  float seen = max(dot(reflect(-toEye, normal), high), 0.0);
  totalEmissiveRadiance += mix(skyLow, skyHigh, pow(seen, 0.45)) * share * (1.0 - white)
    * smoothstep(0.3, 0.8, up) * max(0.7 * pooled, 0.35 * wet);
}`;

const RELIEF_HEAD = `
uniform highp sampler2DArray paintRoughs;
uniform highp sampler2DArray paintNormals;
vec3 relief(vec3 surface) {
  vec3 across = dFdx(-vViewPosition), down = dFdy(-vViewPosition);
  vec2 u = dFdx(vPlace.xy), v = dFdy(vPlace.xy);
  vec3 one = cross(down, surface), two = cross(surface, across);
  vec3 tangent = one * u.x + two * v.x, bitangent = one * u.y + two * v.y;
  float longest = max(dot(tangent, tangent), dot(bitangent, bitangent));
  if (longest == 0.0) return surface;
  float by = inversesqrt(longest);
  vec3 told = texture(paintNormals, vPlace).xyz * 2.0 - 1.0;
  told.xy *= vSurface.z;
  return normalize(tangent * by * told.x + bitangent * by * told.y + surface * told.z);
}`;

/** Draw images into the layers of one texture. */
function layered(images: (CanvasImageSource | null)[], edge: number, empty: string): DataArrayTexture {
  const size = edge * edge * 4;
  const data = new Uint8Array(images.length * size);
  const canvas = document.createElement('canvas');
  canvas.width = edge;
  canvas.height = edge * AT_ONCE;
  const context = canvas.getContext('2d', { willReadFrequently: true });
  for (let first = 0; context && first < images.length; first += AT_ONCE) {
    context.fillStyle = empty;
    context.fillRect(0, 0, edge, edge * AT_ONCE);
    const some = images.slice(first, first + AT_ONCE);
    some.forEach((image, at) => image && context.drawImage(image, 0, at * edge, edge, edge));
    data.set(context.getImageData(0, 0, edge, edge * some.length).data, first * size);
  }
  const made = new DataArrayTexture(data, edge, edge, images.length);
  made.wrapS = made.wrapT = RepeatWrapping;
  made.magFilter = LinearFilter;
  made.generateMipmaps = true;
  made.needsUpdate = true;
  return made;
}

/** A colour for a name or an id, always the same one. */
export function colorOf(text: string, into = new Color()): Color {
  let hash = 2166136261;
  for (let at = 0; at < text.length; at++) hash = Math.imul(hash ^ text.charCodeAt(at), 16777619);
  const hue = ((hash >>> 8) % 360) / 360;
  return into.setHSL(hue, 0.55, 0.35 + ((hash >>> 3) % 25) / 100, LinearSRGBColorSpace);
}
