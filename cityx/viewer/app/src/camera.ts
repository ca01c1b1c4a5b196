/** The camera: round the city with mouse and touch, or on foot and in flight with the keys. */

import { Euler, MathUtils, PerspectiveCamera, Raycaster, Vector2, Vector3 } from 'three';
import { MapControls } from 'three/addons/controls/MapControls.js';

export type Way = 'orbit' | 'walk' | 'fly';

const EYE = 1.7; // metres above the ground, on foot
const WALK = 3; // metres per second
const FLY = 25;
const HURRY = 4; // times as fast with shift
const LOOK = 0.0035; // radians of a pixel
const FLIGHT_MS = 900;
const FOLLOW = 45; // metres from which something that moves is followed

const KEYS: Record<string, [number, number, number]> = {
  w: [0, 0, 1], arrowup: [0, 0, 1], s: [0, 0, -1], arrowdown: [0, 0, -1], a: [-1, 0, 0], arrowleft: [-1, 0, 0],
  d: [1, 0, 0], arrowright: [1, 0, 0], e: [0, 1, 0], pageup: [0, 1, 0], q: [0, -1, 0], pagedown: [0, -1, 0],
};

export class Eye {
  readonly camera: PerspectiveCamera;
  readonly controls: MapControls;
  way: Way = 'orbit';
  /** Called when the camera is elsewhere. */
  moved: () => void = () => {};
  /** Height of the ground under a place, for those on foot. */
  ground: (from: Vector3) => number | null = () => 0;
  private readonly pressed = new Set<string>();
  private flight: { from: Vector3; to: Vector3; look: Vector3; aim: Vector3; begun: number } | null = null;
  private drag: { id: number; x: number; y: number } | null = null;

  constructor(readonly surface: HTMLCanvasElement) {
    this.camera = new PerspectiveCamera(55, 1, 0.3, 12000);
    this.camera.position.set(150, 160, 250);
    this.controls = new MapControls(this.camera, surface);
    this.controls.maxPolarAngle = MathUtils.degToRad(89);
    this.controls.minDistance = 2;
    this.controls.maxDistance = 6000;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.moved());
    surface.tabIndex = 0;
    surface.addEventListener('keydown', (event) => this.press(event, true));
    surface.addEventListener('keyup', (event) => this.press(event, false));
    surface.addEventListener('blur', () => this.pressed.clear());
    surface.addEventListener('pointerdown', (event) => {
      if (this.way !== 'orbit') this.drag = { id: event.pointerId, x: event.clientX, y: event.clientY };
    });
    surface.addEventListener('pointermove', (event) => this.turn(event));
    surface.addEventListener('pointerup', () => (this.drag = null));
  }

  get position(): Vector3 {
    return this.camera.position;
  }

  setWay(way: Way): void {
    this.way = way;
    this.controls.enabled = way === 'orbit';
    if (way === 'walk') {
      const spot = this.controls.target.clone();
      if (this.camera.position.y - spot.y > 30) this.camera.position.set(spot.x, spot.y + EYE, spot.z);
      this.stand();
      this.level();
    } else if (way === 'orbit') {
      this.aim(40);
    }
    this.moved();
  }

  /** Look ahead instead of down. */
  private level(): void {
    const turn = new Euler().setFromQuaternion(this.camera.quaternion, 'YXZ');
    this.camera.quaternion.setFromEuler(new Euler(0, turn.y, 0, 'YXZ'));
  }

  private stand(): void {
    const ground = this.ground(this.camera.position);
    if (ground !== null) this.camera.position.y = ground + EYE;
  }

  /** Go along with something that moved; from far off, come near it. */
  follow(from: Vector3 | null, to: Vector3): void {
    if (this.way !== 'orbit' || this.flight) return;
    if (!from || this.controls.target.distanceTo(to) > FOLLOW * 3) {
      const off = this.camera.position.clone().sub(this.controls.target).setLength(FOLLOW);
      this.camera.position.copy(to).add(off);
      this.controls.target.copy(to);
    } else {
      const by = to.clone().sub(from);
      this.camera.position.add(by);
      this.controls.target.add(by);
    }
    this.controls.update();
    this.moved();
  }

  /** Put the point that the camera goes round ahead of it. */
  private aim(metres: number): void {
    const ahead = this.camera.getWorldDirection(new Vector3());
    this.controls.target.copy(this.camera.position).addScaledVector(ahead, metres);
    this.controls.update();
  }

  private press(event: KeyboardEvent, down: boolean): void {
    const key = event.key.toLowerCase();
    if (!(key in KEYS) && key !== 'shift') return;
    if (down) this.pressed.add(key);
    else this.pressed.delete(key);
    event.preventDefault();
  }

  private turn(event: PointerEvent): void {
    if (!this.drag || event.pointerId !== this.drag.id) return;
    const angles = new Euler().setFromQuaternion(this.camera.quaternion, 'YXZ');
    angles.y += (event.clientX - this.drag.x) * LOOK;
    angles.x = MathUtils.clamp(angles.x + (event.clientY - this.drag.y) * LOOK, -1.5, 1.5);
    this.camera.quaternion.setFromEuler(new Euler(angles.x, angles.y, 0, 'YXZ'));
    this.drag = { id: event.pointerId, x: event.clientX, y: event.clientY };
    this.moved();
  }

  /** Go on by some seconds; whether anything moves. */
  step(seconds: number, now: number): boolean {
    if (this.flight) {
      const share = Math.min((now - this.flight.begun) / FLIGHT_MS, 1);
      const eased = share * share * (3 - 2 * share);
      this.camera.position.lerpVectors(this.flight.from, this.flight.to, eased);
      this.controls.target.lerpVectors(this.flight.look, this.flight.aim, eased);
      this.controls.update();
      if (share === 1) this.flight = null;
      this.moved();
      return true;
    }
    const push = new Vector3();
    for (const key of this.pressed) push.add(new Vector3(...(KEYS[key] ?? [0, 0, 0])));
    if (!push.lengthSq()) return false;
    const ahead = this.camera.getWorldDirection(new Vector3());
    if (this.way !== 'fly') ahead.setY(0);
    ahead.normalize();
    const right = new Vector3().crossVectors(ahead, this.camera.up).normalize();
    const speed = this.way === 'walk' ? WALK : Math.max(FLY, this.camera.position.y * 0.6);
    const by = new Vector3().addScaledVector(ahead, push.z).addScaledVector(right, push.x);
    if (this.way !== 'walk') by.y += push.y;
    by.multiplyScalar(speed * seconds * (this.pressed.has('shift') ? HURRY : 1));
    this.camera.position.add(by);
    if (this.way === 'walk') this.stand();
    else if (this.way === 'orbit') this.controls.target.add(by);
    this.moved();
    return true;
  }

  /** Fly to look at a point from some metres off. */
  goTo(point: Vector3, metres: number): void {
    const back = this.camera.getWorldDirection(new Vector3()).negate();
    back.y = Math.max(back.y, 0.45);
    back.normalize();
    if (this.way !== 'orbit') this.setWay('orbit');
    this.flight = {
      from: this.camera.position.clone(), to: point.clone().addScaledVector(back, metres),
      look: this.controls.target.clone(), aim: point.clone(), begun: performance.now(),
    };
    this.moved();
  }

  /** Stand at once where the whole extent is seen. */
  overview(extent: [number, number, number, number], height: number): void {
    const [west, south, east, north] = extent;
    const middle = new Vector3((west + east) / 2, height, -(south + north) / 2);
    const size = Math.max(east - west, north - south);
    this.camera.position.copy(middle).add(new Vector3(size * 0.35, size * 0.42, size * 0.55));
    this.controls.target.copy(middle);
    this.controls.update();
    this.moved();
  }

  plan(extent: [number, number, number, number]): void {
    const [west, south, east, north] = extent;
    const middle = new Vector3((west + east) / 2, 0, -(south + north) / 2);
    const size = Math.max((east - west) / this.camera.aspect, north - south);
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).add(new Vector3(0, size * 1.05, 0.01));
    this.controls.update();
    this.moved();
  }

  /** The ray of a place on the page. */
  ray(x: number, y: number): Raycaster {
    const box = this.surface.getBoundingClientRect();
    const at = new Vector2(((x - box.left) / box.width) * 2 - 1, 1 - ((y - box.top) / box.height) * 2);
    const caster = new Raycaster();
    this.camera.updateMatrixWorld();
    caster.setFromCamera(at, this.camera);
    return caster;
  }

  /** The camera as `cityx render --camera FILE.json` reads it. */
  record(name: string, width: number, height: number): Record<string, unknown> {
    const ahead = this.camera.getWorldDirection(new Vector3());
    const degrees = (angle: number): number => Math.round(MathUtils.radToDeg(angle) * 1000) / 1000;
    const { x, y, z } = this.camera.position;
    const high = MathUtils.degToRad(this.camera.fov);
    const rounded = [x, -z, y].map((value) => Math.round(value * 1000) / 1000);
    const camera = {
      name, position: rounded, heading_deg: (degrees(Math.atan2(ahead.x, -ahead.z)) + 360) % 360,
      pitch_deg: degrees(Math.asin(MathUtils.clamp(ahead.y, -1, 1))),
      hfov_deg: degrees(2 * Math.atan(Math.tan(high / 2) * this.camera.aspect)), width, height,
    };
    return { cameras: [camera] };
  }
}
