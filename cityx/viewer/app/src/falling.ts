/** Rain and snow that fall about the eye, as many as the weather has of them. */

import {
  BufferAttribute, BufferGeometry, Color, Group, LineSegments, Points, ShaderMaterial, Vector3,
} from 'three';

const [RAIN_BOX, SNOW_BOX] = [24, 20]; // metres, edge of the cube about the eye that is filled
// In a cube at 1 mm of water an hour, and at most; their number grows slower than the rate, as `cityx.blender.air` has it.
const [DROPS, MOST_DROPS] = [2400, 14_000];
const [FLAKES, MOST_FLAKES] = [5000, 16_000];
const PLAIN_SHARE = 0.6; // of them where there is no graphics card
const GROWTH = 0.75;
const DROP_SPEED = 7.5; // metres a second
const FLAKE_SPEED = 1.1;
const HIGH = 60; // metres above the ground from which no drop is seen
const LONGEST_S = 3600; // after which the clock begins anew

export class Falling {
  readonly group = new Group();
  private readonly rain: LineSegments<BufferGeometry, ShaderMaterial>;
  private readonly snow: Points<BufferGeometry, ShaderMaterial>;
  private clock = 0;

  constructor(private readonly plain: boolean) {
    this.rain = new LineSegments(new BufferGeometry(), falls(RAIN_BOX, RAIN_VERTEX, RAIN_FRAGMENT));
    this.snow = new Points(new BufferGeometry(), falls(SNOW_BOX, SNOW_VERTEX, SNOW_FRAGMENT));
    for (const each of [this.rain, this.snow]) {
      each.geometry.setDrawRange(0, 0);
      each.frustumCulled = false;
      each.renderOrder = 1001; // after the sky
      each.visible = false;
      this.group.add(each);
    }
  }

  /** How many drops and flakes fall. */
  get counts(): { drops: number; flakes: number } {
    return {
      drops: this.rain.visible ? this.rain.geometry.drawRange.count / 2 : 0,
      flakes: this.snow.visible ? this.snow.geometry.drawRange.count : 0,
    };
  }

  /** Let it rain and snow, mm of water an hour each, in a wind that comes from `from`, radians clockwise from north. */
  set(rain: number, snow: number, wind: number, from: number, light: Color): void {
    const share = this.plain ? PLAIN_SHARE : 1;
    const drops = Math.min(Math.floor(DROPS * share * rain ** GROWTH), Math.floor(MOST_DROPS * share));
    const flakes = Math.min(Math.floor(FLAKES * share * snow ** GROWTH), Math.floor(MOST_FLAKES * share));
    // Most cities are dry: their places are spread when it first rains or snows.
    if (drops && !this.rain.geometry.hasAttribute('position')) spread(this.rain.geometry, Math.floor(MOST_DROPS * share), 2);
    if (flakes && !this.snow.geometry.hasAttribute('position')) spread(this.snow.geometry, Math.floor(MOST_FLAKES * share), 1);
    this.rain.geometry.setDrawRange(0, drops * 2);
    this.snow.geometry.setDrawRange(0, flakes);
    this.group.visible = drops + flakes > 0;
    this.rain.visible = drops > 0;
    this.snow.visible = flakes > 0;
    const blows = new Vector3(-Math.sin(from), 0, Math.cos(from)).multiplyScalar(wind);
    uniform(this.rain, 'fall', new Vector3(0, -DROP_SPEED, 0).add(blows));
    uniform(this.snow, 'fall', new Vector3(0, -FLAKE_SPEED, 0).addScaledVector(blows, 0.6));
    for (const each of [this.rain, this.snow]) uniform(each, 'light', light);
  }

  /** Go on by some seconds; whether anything is seen to fall. */
  step(seconds: number, eye: Vector3, ground: number, pixels: number): boolean {
    this.group.visible = eye.y - ground < HIGH && (this.rain.visible || this.snow.visible);
    if (!this.group.visible) return false;
    this.clock = (this.clock + seconds) % LONGEST_S;
    for (const each of [this.rain, this.snow]) {
      uniform(each, 'clock', this.clock);
      uniform(each, 'eye', eye);
      uniform(each, 'pixels', pixels);
    }
    return true;
  }
}

function uniform(of: { material: ShaderMaterial }, name: string, value: number | Vector3 | Color): void {
  const held = of.material.uniforms[name];
  if (held) held.value = value;
}

/** Give a geometry places in a unit cube that look like chance and are the same for everybody: the sequence of Halton. */
function spread(geometry: BufferGeometry, count: number, ends: number): void {
  const halton = (number: number, base: number): number => {
    let [found, share] = [0, 1];
    for (let left = number; left > 0; left = Math.floor(left / base)) {
      share /= base;
      found += share * (left % base);
    }
    return found;
  };
  const place = new Float32Array(count * ends * 3);
  const draw = new Float32Array(count * ends * 2);
  for (let at = 0; at < count; at++) {
    for (let end = 0; end < ends; end++) {
      place.set([halton(at + 1, 2), halton(at + 1, 3), halton(at + 1, 5)], (at * ends + end) * 3);
      draw.set([halton(at + 1, 7), end], (at * ends + end) * 2);
    }
  }
  geometry.setAttribute('position', new BufferAttribute(place, 3));
  geometry.setAttribute('draw', new BufferAttribute(draw, 2));
}

function falls(box: number, vertexShader: string, fragmentShader: string): ShaderMaterial {
  return new ShaderMaterial({
    transparent: true, depthWrite: false, vertexShader: HEAD + vertexShader, fragmentShader,
    uniforms: {
      clock: { value: 0 }, eye: { value: new Vector3() }, box: { value: box }, fall: { value: new Vector3(0, -1, 0) },
      light: { value: new Color() }, pixels: { value: 720 },
    },
  });
}

const HEAD = `
attribute vec2 draw;
uniform float clock;
uniform vec3 eye;
uniform float box;
uniform vec3 fall;
uniform float pixels;
varying float shown;
// Where a thing is after it fell: what leaves the cube about the eye comes in on the other side.
vec3 stood(vec3 by) {
  vec3 at = position * box + by;
  at = mod(at - eye + 0.5 * box, box) - 0.5 * box;
  shown = 1.0 - smoothstep(0.35, 0.5, length(at) / box);
  shown *= smoothstep(0.6, 1.6, length(at));
  return at + eye;
}`;

const RAIN_VERTEX = `
void main() {
  vec3 way = fall * (0.8 + 0.4 * draw.x);
  vec3 at = stood(way * clock) + way * draw.y * 0.03;
  gl_Position = projectionMatrix * viewMatrix * vec4(at, 1.0);
}`;

const RAIN_FRAGMENT = `
uniform vec3 light;
varying float shown;
void main() {
  gl_FragColor = vec4(light, 0.45 * shown);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}`;

const SNOW_VERTEX = `
void main() {
  float turn = 6.2832 * draw.x;
  vec3 sway = vec3(sin(clock * 0.9 + turn), 0.0, cos(clock * 0.7 + turn * 3.0)) * 0.35;
  vec3 at = stood(fall * (0.75 + 0.5 * draw.x) * clock + sway);
  vec4 seen = viewMatrix * vec4(at, 1.0);
  gl_Position = projectionMatrix * seen;
  gl_PointSize = clamp((0.018 + 0.02 * draw.x) * pixels / max(-seen.z, 0.1), 1.0, 14.0);
}`;

const SNOW_FRAGMENT = `
uniform vec3 light;
varying float shown;
void main() {
  float away = length(gl_PointCoord - 0.5);
  gl_FragColor = vec4(light, 0.85 * shown * (1.0 - smoothstep(0.25, 0.5, away)));
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}`;
