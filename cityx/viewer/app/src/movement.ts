/** What moves: tracks played on a slider, by the models of their looks or, further off, by bodies. */

import {
  BoxGeometry, BufferAttribute, Color, Frustum, Group, InstancedBufferAttribute, InstancedMesh, Matrix4, Mesh, Quaternion, Ray, Sphere,
  Vector3,
  type BufferGeometry, type Camera, type Material,
} from 'three';
import type { GLTF } from 'three/addons/loaders/GLTFLoader.js';
import { mergedOf } from './merging';
import type { Paints } from './paints';
import { frustumOf, meshesIn } from './rows';

interface Mover {
  id: string;
  kind: string;
  look: string;
  from: number;
  count: number;
  tint: [number, number, number];
  size: [number, number, number];
  first: number;
}

interface Head {
  rate: number;
  duration: number;
  low: [number, number, number];
  step: number;
  movers: Mover[];
}

const UP = new Vector3(0, 1, 0);
const TURN = (2 * Math.PI) / 65536;
const NOTHING = new Matrix4().makeScale(0, 0, 0);
const MARGIN = 12; // metres about what is seen, within which a mover is drawn
const BALL = new Sphere();
const [PLACE, SIZE, ONE] = [new Vector3(), new Vector3(), new Vector3(1, 1, 1)];
const [MATRIX, LOCAL, QUATERNION, COLOR] = [new Matrix4(), new Matrix4(), new Quaternion(), new Color()];

/** Bodies of all movers of a shape that do not show as their models. */
interface Bodies {
  mesh: InstancedMesh;
  drawn: number;
}

/** What is drawn of the movers of one look. */
interface Look {
  movers: Mover[];
  /** Those that are there now, in sight or not. */
  shown: Mover[];
  far: Bodies;
  /** Where the body of each that is shown stands. */
  bodies: Matrix4[];
  modelled: number;
  model: { mesh: InstancedMesh; local: Matrix4 }[];
}

export class Movement {
  readonly group = new Group();
  readonly duration: number;
  private readonly head: Head;
  private readonly samples: Uint16Array;
  private readonly looks = new Map<string, Look>();
  private readonly bodies: Bodies[];
  private moment = 0;
  private readonly eye = new Vector3();
  /** What is seen; all until that is told. */
  private frustum: Frustum | null = null;

  /** `near` is how far off, metres, a mover shows as its model; further off it is a body of its size and colour. */
  constructor(data: ArrayBuffer, private readonly near: number, paints: Paints, private readonly shadows: boolean) {
    const length = new DataView(data).getUint32(0, true);
    this.head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length))) as Head;
    this.samples = new Uint16Array(data, 4 + length);
    this.duration = this.head.duration;
    let first = 0;
    const byLook = new Map<string, Mover[]>();
    for (const mover of this.head.movers) {
      mover.first = first;
      first += mover.count;
      byLook.set(mover.look, [...(byLook.get(mover.look) ?? []), mover]);
    }
    const made = (walks: boolean): Bodies => {
      const count = this.head.movers.filter((mover) => isWalker(mover.kind) === walks).length;
      const shape = shapeOf(walks ? 'pedestrian' : 'car');
      const vertices = shape.getAttribute('position').count;
      // Of the first paint, which has no picture and takes the colour of the mover.
      const white = new Uint8Array(vertices * 4).map((_, at) => (at % 4 === 3 ? 0 : 255));
      shape.setAttribute('paint', new BufferAttribute(white, 4, true));
      return { mesh: this.instanced(shape, paints.get(false, false), count, true), drawn: 0 };
    };
    const [wheels, walkers] = [made(false), made(true)];
    this.bodies = [wheels, walkers];
    for (const [look, movers] of byLook) {
      const far = isWalker(movers[0]?.kind ?? '') ? walkers : wheels;
      this.looks.set(look, { movers, shown: [], far, bodies: [], modelled: 0, model: [] });
    }
  }

  private instanced(shape: BufferGeometry, material: Material, count: number, painted: boolean): InstancedMesh {
    const made = new InstancedMesh(shape, material, Math.max(count, 1));
    made.frustumCulled = false;
    made.castShadow = this.shadows;
    if (painted) made.setColorAt(0, COLOR);
    shape.setAttribute('room', new InstancedBufferAttribute(new Float32Array(Math.max(count, 1) * 2).fill(1), 2));
    this.group.add(made);
    return made;
  }

  get count(): number {
    return this.head.movers.length;
  }

  /** Show movers by their models. */
  addModels(file: GLTF, paints: Paints): void {
    for (const node of [...file.scene.children]) {
      const [name, part] = ((node.userData as { prototype?: string }).prototype ?? '').split('/');
      const look = this.looks.get(name ?? '');
      if (!look) continue;
      node.updateMatrix();
      for (const { geometry, double, clear } of mergedOf(meshesIn(node), paints, false)) {
        const mesh = this.instanced(geometry, paints.get(double, clear), look.movers.length, part === 'body');
        look.model.push({ mesh, local: node.matrix.clone() });
      }
    }
    this.at(this.moment);
  }

  /** See it from elsewhere. */
  from(camera: Camera): void {
    this.eye.setFromMatrixPosition(camera.matrixWorld);
    this.frustum = frustumOf(camera);
    this.at(this.moment);
  }

  /** Put everything where it is at a moment, seconds. */
  at(moment: number): void {
    this.moment = moment;
    for (const bodies of this.bodies) bodies.drawn = 0;
    for (const look of this.looks.values()) {
      look.shown.length = 0;
      look.modelled = 0;
      for (const mover of look.movers) this.place(look, mover, moment);
      for (const { mesh } of look.model) draw(mesh, look.modelled);
    }
    for (const { mesh, drawn } of this.bodies) draw(mesh, drawn);
  }

  private place(look: Look, mover: Mover, moment: number): void {
    const { rate, low, step } = this.head;
    const at = (moment - mover.from) * rate;
    if (at < 0 || at > mover.count - 1) return;
    const one = (mover.first + Math.floor(at)) * 4;
    const two = Math.floor(at) + 1 < mover.count ? one + 4 : one;
    const share = at - Math.floor(at);
    const mixed = (axis: number): number =>
      (this.samples[one + axis] ?? 0) * (1 - share) + (this.samples[two + axis] ?? 0) * share;
    PLACE.set(low[0] + mixed(0) * step, low[2] + mixed(2) * step, -(low[1] + mixed(1) * step));
    const begin = this.samples[one + 3] ?? 0;
    let by = (this.samples[two + 3] ?? 0) - begin;
    if (by > 32768) by -= 65536;
    if (by < -32768) by += 65536;
    const heading = (begin + by * share) * TURN;
    const row = look.shown.length;
    const [length, width, height] = mover.size;
    MATRIX.compose(PLACE, QUATERNION.setFromAxisAngle(UP, heading), SIZE.set(length, height, width));
    (look.bodies[row] ??= new Matrix4()).copy(MATRIX);
    look.shown.push(mover);
    BALL.center.copy(PLACE);
    BALL.radius = MARGIN + length;
    if (this.frustum && !this.frustum.intersectsSphere(BALL)) return;
    COLOR.setRGB(...mover.tint);
    if (!look.model.length || PLACE.distanceTo(this.eye) >= this.near) {
      look.far.mesh.setMatrixAt(look.far.drawn, MATRIX);
      look.far.mesh.setColorAt(look.far.drawn++, COLOR);
      return;
    }
    MATRIX.compose(PLACE, QUATERNION.setFromAxisAngle(UP, heading + Math.PI / 2), ONE);
    for (const part of look.model) {
      part.mesh.setMatrixAt(look.modelled, LOCAL.multiplyMatrices(MATRIX, part.local));
      if (part.mesh.instanceColor) part.mesh.setColorAt(look.modelled, COLOR);
    }
    look.modelled++;
  }

  /** A body where a mover is now, for a highlight. */
  outline(id: string): Mesh[] {
    for (const look of this.looks.values()) {
      const row = look.shown.findIndex((mover) => mover.id === id);
      if (row < 0) continue;
      const mesh = new Mesh(look.far.mesh.geometry.clone());
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(look.bodies[row] ?? NOTHING);
      return [mesh];
    }
    return [];
  }

  /** The mover that a ray meets first. */
  raycast(ray: Ray, furthest: number): { id: string; kind: string; look: string; distance: number; point: Vector3 } | null {
    const matrix = new Matrix4();
    const box = new Vector3();
    const own = new Ray();
    let best: ReturnType<Movement['raycast']> = null;
    let limit = furthest;
    for (const look of this.looks.values()) {
      const { geometry } = look.far.mesh;
      if (!geometry.boundingBox) geometry.computeBoundingBox();
      const bounds = geometry.boundingBox;
      if (!bounds) continue;
      for (const [at, mover] of look.shown.entries()) {
        matrix.copy(look.bodies[at] ?? NOTHING);
        own.copy(ray).applyMatrix4(matrix.clone().invert());
        const hit = own.intersectBox(bounds, box);
        if (!hit) continue;
        const point = hit.clone().applyMatrix4(matrix);
        const distance = point.distanceTo(ray.origin);
        if (distance >= limit) continue;
        limit = distance;
        best = { id: mover.id, kind: mover.kind, look: mover.look, distance, point };
      }
    }
    return best;
  }
}

function draw(mesh: InstancedMesh, count: number): void {
  mesh.count = count;
  mesh.visible = count > 0;
  mesh.instanceMatrix.needsUpdate = true;
  if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
}

function isWalker(kind: string): boolean {
  return kind === 'pedestrian' || kind === 'animal';
}

/** A body of one metre each way, standing on the ground, its front towards +x. */
export function shapeOf(kind: string): BoxGeometry {
  const person = isWalker(kind);
  const shape = new BoxGeometry(1, 1, 1, 1, person ? 1 : 2, 1); // a vehicle narrows above its middle
  shape.translate(0, 0.5, 0);
  const place = shape.getAttribute('position');
  for (let at = 0; at < place.count; at++) {
    if (place.getY(at) > 0.9) place.setX(at, place.getX(at) * (person ? 0.6 : 0.55) - (person ? 0 : 0.06));
    if (place.getY(at) > 0.9) place.setZ(at, place.getZ(at) * 0.8);
  }
  shape.computeVertexNormals();
  return shape;
}
