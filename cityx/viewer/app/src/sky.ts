/** Sun, sky, fog and lamps at an hour and in a weather. */

import {
  AmbientLight, BackSide, Color, DirectionalLight, FogExp2, Group, HemisphereLight, MathUtils, Mesh, ShaderMaterial,
  SphereGeometry, Vector3, Vector4, type Object3D, type Scene, type WebGLRenderer,
} from 'three';
import { Falling } from './falling';
import { lights, plainLight, weather } from './paints';
import type { Environment, SceneInfo } from './types';

const SHADOW_PIXELS = 2048;
const SHADOW_PIXELS_PLAIN = 1024;
const CONTRAST = 3.912; // optical depth at which contrast falls to 2 %
const FALLS = new Color(0.85, 0.88, 0.92); // what drops and flakes give back of the light of a day
const SHOWN = `
  uniform vec3 high; uniform vec3 low; uniform vec3 glow; uniform vec3 sun; uniform vec4 bed;
  vec3 shownAt(vec3 d) {
    if (d.y < 0.0) return mix(low, bed.rgb, bed.a * smoothstep(0.02, 0.25, -d.y)); // a plain in the haze
    float up = max(d.y, 0.0);
    float near = max(dot(d, sun), 0.0);
    return mix(low, high, pow(up, 0.45)) + glow * (pow(near, 8.0) * 0.25 + pow(near, 64.0) * 0.5) * (1.0 - up * 0.5);
  }
  // What three.js makes of a colour by its neutral mapping and the curve of sRGB.
  vec3 mapped(vec3 light) {
    float least = min(light.r, min(light.g, light.b));
    light -= least < 0.08 ? least - 6.25 * least * least : 0.04;
    float peak = max(light.r, max(light.g, light.b)), from = 0.76;
    if (peak > from) {
      float lower = 1.0 - (1.0 - from) * (1.0 - from) / (peak + 1.0 - 2.0 * from);
      light = mix(light * lower / peak, vec3(lower), 1.0 - 1.0 / (0.15 * (peak - lower) + 1.0));
    }
    return mix(light * 12.92, 1.055 * pow(light, vec3(0.41666)) - 0.055, step(0.0031308, light));
  }`;
const EARTH = new Color(0.15, 0.145, 0.125); // mean colour of ground
const DUSK = MathUtils.degToRad(-6); // of the sun, below which it is night

/** How an hour and a weather look; the numbers are those of the city's environment. */
export interface Air {
  hour: number;
  cloud: number;
  visibility: number;
  wetness: number;
  snow: number;
  /** What falls, mm of water an hour. */
  rain: number;
  snowfall: number;
}

export const WEATHERS: Record<string, Partial<Air>> = {
  clear: { cloud: 0, visibility: 40000, wetness: 0, snow: 0, rain: 0, snowfall: 0 },
  cloudy: { cloud: 0.75, visibility: 20000, wetness: 0, snow: 0, rain: 0, snowfall: 0 },
  rain: { cloud: 1, visibility: 5000, wetness: 1, snow: 0, rain: 6, snowfall: 0 },
  fog: { cloud: 1, visibility: 250, wetness: 0.3, snow: 0, rain: 0, snowfall: 0 },
  snow: { cloud: 1, visibility: 3000, wetness: 0, snow: 1, rain: 0, snowfall: 2 },
};

export class Sky {
  readonly group = new Group();
  readonly falling: Falling;
  readonly sun = new DirectionalLight(0xffffff, 3);
  air: Air;
  private readonly around = new HemisphereLight(0xbfd4ff, 0x6b6250, 1);
  private readonly least = new AmbientLight(0x8090c0, 0.1);
  private readonly dome: Mesh<SphereGeometry, ShaderMaterial>;
  private readonly fog = new FogExp2(0xbfcfe0, 0.0001);
  private readonly latitude: number;
  private readonly day: number;

  constructor(scene: Scene, told: SceneInfo, plain: boolean) {
    this.latitude = MathUtils.degToRad(told.frame.latitude);
    this.day = told.environment.day;
    this.air = airOf(told.environment);
    this.falling = new Falling(plain);
    this.dome = new Mesh(
      new SphereGeometry(1, 48, 32),
      new ShaderMaterial({
        side: BackSide, depthWrite: false, fog: false,
        uniforms: {
          high: { value: new Color() }, low: { value: new Color() }, glow: { value: new Color() },
          sun: { value: new Vector3() }, disc: { value: 1 }, exposure: { value: 1 },
          bed: { value: new Vector4() },
        },
        // Without a graphics card the sky is reckoned by vertices, and the disc of the sun by pixels.
        defines: { BY_VERTICES: String(plain) },
        vertexShader: `varying vec3 way; varying vec3 shown; uniform float exposure; ${SHOWN}
          void main() {
            way = position;
            if (BY_VERTICES) shown = mapped(shownAt(normalize(position)) * exposure);
            gl_Position = (projectionMatrix * vec4(mat3(viewMatrix) * position, 1.0)).xyww;
          }`,
        fragmentShader: `varying vec3 way; varying vec3 shown; uniform float disc; ${SHOWN}
          void main() {
            vec3 d = normalize(way);
            vec3 bright = disc * glow * smoothstep(0.9994, 0.9997, dot(d, sun)) * 12.0;
            gl_FragColor = vec4((BY_VERTICES ? shown : shownAt(d)) + bright, 1.0);
            if (BY_VERTICES) return;
            #include <tonemapping_fragment>
            #include <colorspace_fragment>
          }`,
      }),
    );
    this.dome.frustumCulled = false;
    this.dome.renderOrder = 1000; // only where nothing stands before it
    const camera = this.sun.shadow.camera;
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.setScalar(plain ? SHADOW_PIXELS_PLAIN : SHADOW_PIXELS);
    const { shadow } = this.sun;
    plainLight.shadowPlace.value = shadow.matrix;
    Object.defineProperty(plainLight.shadowDepths, 'value', { get: () => shadow.map?.depthTexture ?? null });
    Object.defineProperty(plainLight.shadowed, 'value', { get: () => Number(this.sun.castShadow && !!shadow.map) });
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.25;
    camera.near = 1;
    camera.far = 2500;
    this.group.add(this.sun, this.sun.target, this.around, this.least, this.dome, this.falling.group);
    scene.fog = this.fog;
    scene.add(this.group);
  }

  /** Elevation and azimuth (from north, clockwise) of the sun at the hour, radians. */
  place(hour = this.air.hour): { elevation: number; azimuth: number } {
    const tilt = MathUtils.degToRad(-23.44) * Math.cos((2 * Math.PI * (this.day + 10)) / 365);
    const angle = ((hour - 12) / 12) * Math.PI;
    const up = Math.sin(this.latitude) * Math.sin(tilt) + Math.cos(this.latitude) * Math.cos(tilt) * Math.cos(angle);
    const elevation = Math.asin(MathUtils.clamp(up, -1, 1));
    const east = -Math.cos(tilt) * Math.sin(angle);
    const north = Math.cos(this.latitude) * Math.sin(tilt) - Math.sin(this.latitude) * Math.cos(tilt) * Math.cos(angle);
    return { elevation, azimuth: Math.atan2(east, north) };
  }

  /** Light the city; `focus` is where shadows are sharp, `reach` how far from there they go. */
  light(renderer: WebGLRenderer, told: Environment, focus: Vector3, reach: number, natural: boolean): void {
    const changed = Math.abs(this.air.hour - told.hour) > 0.01;
    const { elevation, azimuth } = changed
      ? this.place()
      : { elevation: told.sun_elevation, azimuth: told.sun_azimuth };
    const way = new Vector3(
      Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation), -Math.cos(azimuth) * Math.cos(elevation),
    );
    const { cloud, visibility } = this.air;
    const height = MathUtils.radToDeg(elevation);
    const day = MathUtils.smoothstep(height, -6, 12);
    const low = MathUtils.clamp(1 - height / 20, 0, 1);
    const clear = (1 - cloud) ** 2;
    const dark = 1 - MathUtils.smoothstep(height, -4, 3);
    const exposure = 1.05 + 1.2 * dark;
    const warm = new Color(1, 0.96, 0.9).lerp(new Color(1, 0.58, 0.3), low);
    const air = height > 0 ? Math.exp(-0.21 / (Math.sin(elevation) + 0.506 * (height + 6.08) ** -1.636)) : 0;
    this.sun.color.copy(warm);
    this.sun.intensity = 3.6 * air * clear;
    this.sun.position.copy(focus).addScaledVector(way, 1000);
    this.sun.target.position.copy(focus);
    const camera = this.sun.shadow.camera;
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.updateProjectionMatrix();
    this.sun.castShadow = natural && this.sun.intensity > 0.05;
    const grey = new Color(0.55, 0.58, 0.62);
    const zenith = new Color(0.12, 0.28, 0.62).lerp(grey, cloud).multiplyScalar(0.02 + 0.98 * day);
    const rim = new Color(0.62, 0.74, 0.88).lerp(warm, 0.35 * low * clear).lerp(grey, cloud * 0.8)
      .multiplyScalar(0.02 + 0.98 * day);
    if (day < 0.5) {
      zenith.add(new Color(0.006, 0.01, 0.03));
      rim.add(new Color(0.03, 0.026, 0.03)); // what towns send up
    }
    const uniforms = this.dome.material.uniforms as Record<string, { value: Color | Vector3 | number }>;
    (uniforms['high']?.value as Color).copy(zenith);
    (uniforms['low']?.value as Color).copy(rim);
    (uniforms['glow']?.value as Color).copy(warm).multiplyScalar(clear * MathUtils.smoothstep(height, -8, 4) * 0.7);
    (uniforms['sun']?.value as Vector3).copy(way);
    if (uniforms['exposure']) uniforms['exposure'].value = exposure;
    if (uniforms['disc']) uniforms['disc'].value = visibility > 3000 ? clear : 0;
    this.around.color.copy(zenith).lerp(rim, 0.7).lerp(new Color(0.75, 0.75, 0.74).multiplyScalar(0.02 + 0.98 * day), 0.55);
    this.around.groundColor.copy(new Color(0.32, 0.3, 0.26).multiplyScalar(0.1 + 0.9 * day));
    this.around.intensity = 2.5 + 1.0 * cloud * day;
    this.least.intensity = 0.05 + 0.75 * dark;
    this.fog.color.copy(rim);
    this.fog.density = Math.sqrt(CONTRAST) / visibility;
    weather.wetness.value = this.air.wetness;
    weather.lyingSnow.value = this.air.snow;
    weather.skyHigh.value.copy(zenith);
    weather.skyLow.value.copy(rim);
    lights.lamps.value = dark > 0.3 ? 1 : 0;
    lights.rooms.value = changed
      ? [0.55 * dark * evening(this.air.hour), 0.25 * dark, 0.9 * dark]
      : [told.night_lights, told.work_lights, told.shop_lights];
    renderer.toneMappingExposure = exposure;
    if (elevation < DUSK) this.sun.intensity = 0;
    this.falling.set(this.air.rain, this.air.snowfall, told.wind, told.wind_from, FALLS.clone().multiplyScalar(0.12 + 0.88 * day));
    this.tellPlain(way);
    const bed = this.dome.material.uniforms['bed']?.value as Vector4;
    const { r, g, b } = this.plainOf(way);
    bed.set(r, g, b, MathUtils.smoothstep(visibility, 300, 5000));
  }

  /** The colour of a plain of mean ground in the light of now. */
  private plainOf(way: Vector3): Color {
    const ground = EARTH.clone().lerp(new Color(0.8, 0.82, 0.86), Math.min(1.18 * this.air.snow, 1));
    const sun = plainLight.sunLight.value.clone().multiplyScalar(Math.max(way.y, 0));
    return ground.multiply(sun.add(plainLight.skyLight.value));
  }

  /** Tell surfaces that are lit by vertices of the same light. */
  private tellPlain(way: Vector3): void {
    const share = 1 / Math.PI; // what a white surface gives back of the light, to each side
    const least = this.least.color.clone().multiplyScalar(this.least.intensity);
    const of = (color: Color): Color => color.clone().multiplyScalar(this.around.intensity).add(least).multiplyScalar(share);
    plainLight.sunWay.value.copy(way);
    plainLight.sunLight.value.copy(this.sun.color).multiplyScalar(this.sun.intensity * share);
    plainLight.skyLight.value.copy(of(this.around.color));
    plainLight.groundLight.value.copy(of(this.around.groundColor));
  }

  get objects(): Object3D[] {
    return [this.group];
  }
}

export function airOf(told: Environment): Air {
  return {
    hour: told.hour, cloud: told.cloud_cover, visibility: told.visibility, wetness: told.wetness, snow: told.snow,
    rain: told.rain, snowfall: told.snowfall,
  };
}

/** Share of homes with somebody awake at an hour. */
function evening(hour: number): number {
  return hour > 16 && hour < 23 ? 1 : hour > 5 && hour < 9 ? 0.6 : 0.15;
}
