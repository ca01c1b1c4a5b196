/** What moves: tracks played on a slider, one instanced mesh for each look. */

import {
  BoxGeometry, Color, Group, InstancedBufferAttribute, InstancedMesh, Matrix4, Mesh, MeshLambertMaterial, Quaternion, Ray, Vector3,
  type BufferGeometry,
  type Material,
} from 'three';
import type { GLTF } from 'three/addons/loaders/GLTFLoader.js';
import { mergedOf } from './merging';
import type { Paints } from './paints';
import { meshesIn } from './rows';

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
const STEP = 0.15; // of the distance of models that the eye goes before they are chosen anew
const [PLACE, SIZE, ONE] = [new Vector3(), new Vector3(), new Vector3(1, 1, 1)];
const [MATRIX, LOCAL, QUATERNION, COLOR] = [new Matrix4(), new Matrix4(), new Quaternion(), new Color()];

/** What is drawn of the movers of one look. */
interface Look {
  movers: Mover[];
  shown: Mover[];
  /** A body for each that does not show as its model. */
  box: InstancedMesh;
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
  private moment = 0;
  private readonly eye = new Vector3();

  /** `near` is how far off, metres, a mover shows as its model; further off it is a body of its size and colour. */
  constructor(data: ArrayBuffer, private readonly near: number) {
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
    for (const [look, movers] of byLook) {
      const box = instanced(shapeOf(movers[0]?.kind ?? ''), new MeshLambertMaterial(), movers.length, true);
      this.group.add(box);
      this.looks.set(look, { movers, shown: [], box, bodies: [], modelled: 0, model: [] });
    }
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
        const made = instanced(geometry, paints.get(double, clear), look.movers.length, part === 'body');
        geometry.setAttribute('room', new InstancedBufferAttribute(new Float32Array(look.movers.length * 2).fill(1), 2));
        this.group.add(made);
        look.model.push({ mesh: made, local: node.matrix.clone() });
      }
    }
    this.at(this.moment);
  }

  /** See it from elsewhere. */
  from(eye: Vector3): void {
    if (eye.distanceTo(this.eye) < this.near * STEP) return;
    this.eye.copy(eye);
    this.at(this.moment);
  }

  /** Put everything where it is at a moment, seconds. */
  at(moment: number): void {
    this.moment = moment;
    for (const look of this.looks.values()) {
      look.shown.length = 0;
      look.modelled = 0;
      for (const mover of look.movers) this.place(look, mover, moment);
      const models = look.model.map((part) => part.mesh);
      for (const mesh of [look.box, ...models]) {
        mesh.count = mesh === look.box ? look.shown.length : look.modelled;
        mesh.instanceMatrix.needsUpdate = true;
        if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
      }
    }
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
    const modelled = look.model.length > 0 && PLACE.distanceTo(this.eye) < this.near;
    // What shows as its model keeps a body without a size, so that rows and movers stay in step.
    look.box.setMatrixAt(row, modelled ? NOTHING : MATRIX);
    look.box.setColorAt(row, COLOR.setRGB(...mover.tint));
    look.shown.push(mover);
    if (!modelled) return;
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
      const mesh = new Mesh(look.box.geometry.clone());
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
      look.box.geometry.computeBoundingBox();
      const bounds = look.box.geometry.boundingBox;
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

function instanced(shape: BufferGeometry, material: Material, count: number, painted: boolean): InstancedMesh {
  const made = new InstancedMesh(shape, material, count);
  made.frustumCulled = false;
  made.castShadow = true;
  if (painted) made.setColorAt(0, COLOR);
  return made;
}

/** A body of one metre each way, standing on the ground, its front towards +x. */
export function shapeOf(kind: string): BoxGeometry {
  const shape = new BoxGeometry(1, 1, 1, 2, 2, 1);
  shape.translate(0, 0.5, 0);
  const place = shape.getAttribute('position');
  const person = kind === 'pedestrian' || kind === 'animal';
  for (let at = 0; at < place.count; at++) {
    if (place.getY(at) > 0.9) place.setX(at, place.getX(at) * (person ? 0.6 : 0.55) - (person ? 0 : 0.06));
    if (place.getY(at) > 0.9) place.setZ(at, place.getZ(at) * 0.8);
  }
  shape.computeVertexNormals();
  return shape;
}
