/** Instances: rows that place prototypes, drawn as few and as coarse as the eye allows. */

import {
  BufferGeometry, Camera, Color, DynamicDrawUsage, Frustum, Group, InstancedBufferAttribute, InstancedMesh, Matrix4,
  Mesh, MeshLambertMaterial, Quaternion, Ray, Sphere, Vector3, type BufferAttribute, type Material,
} from 'three';
import type { GLTF, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';
import { MeshBVH } from 'three-mesh-bvh';
import type { Lit } from './lamps';
import { mergedOf } from './merging';
import type { Paints } from './paints';

interface RowsRecord {
  rows: Record<string, number>;
  counts: [string, number][];
  origin: [number, number, number];
}

/** One form of a prototype: what is drawn of it from some distance on. */
interface Form {
  beyond: number;
  parts: InstancedMesh[];
  /** From the numbers of the file to metres. */
  local: Matrix4;
  sphere: Sphere;
  count: number;
  capacity: number;
  matrices: InstancedBufferAttribute;
  colors: InstancedBufferAttribute;
  rooms: InstancedBufferAttribute;
  triangles: number;
  /** Row behind each instance that is drawn. */
  drawn: { block: Block; row: number }[];
  trees: (MeshBVH | undefined)[];
}

/** Rows of one prototype in one chunk. */
interface Block {
  chunk: string;
  layer: string;
  prototype: string;
  count: number;
  matrices: Float32Array;
  colors: Float32Array;
  rooms: Float32Array;
  ids: Uint16Array;
  owners: Uint16Array;
  sphere: Sphere;
}

export interface RowHit {
  distance: number;
  point: Vector3;
  id: string;
  owner: string;
  layer: string;
  prototype: string;
}

const POLE = 'traffic_signal'; // how the names of poles with lights begin
const MARGIN = 1.3; // of the capacity of a form beyond what it needs
const ROUNDS = 8; // of leaving out what is small, each with a larger limit
const COARSER = 1.4;

export class Rows {
  readonly group = new Group();
  readonly hidden = new Set<string>();
  /** Pixels below which an instance is not drawn. */
  least = 1.3;
  /** How many times sooner the coarse forms come than where there is time. */
  coarse = 1;
  triangles = 0;
  drawn = 0;
  /** Colour of a row in another look than the natural one. */
  private tone: ((id: string, owner: string, layer: string) => Color) | null = null;
  /** What poles show, by their ids. */
  private lit: ReadonlyMap<string, Lit> = new Map();
  private readonly flat = new MeshLambertMaterial();
  private readonly natural = new Map<InstancedMesh, Material | Material[]>();
  private readonly forms = new Map<string, Form[]>();
  private readonly blocks = new Map<string, Block[]>();

  constructor(private readonly paints: Paints) {}

  /** Take the prototypes of a pack. */
  addPack(file: GLTF): void {
    for (const node of [...file.scene.children]) {
      const told = node.userData as { prototype?: string; beyond?: number };
      if (told.prototype === undefined) continue;
      node.updateMatrix();
      this.addForm(told.prototype, told.beyond ?? 0, node.matrix.clone(), meshesIn(node));
    }
  }

  private addForm(name: string, beyond: number, local: Matrix4, meshes: Mesh[]): void {
    const own = this.forms.get(name) ?? [];
    const older = own.find((form) => form.beyond === beyond);
    if (older) this.dropForm(own, older);
    const capacity = 8;
    const matrices = new InstancedBufferAttribute(new Float32Array(capacity * 16), 16);
    const colors = new InstancedBufferAttribute(new Float32Array(capacity * 3), 3);
    const room = new InstancedBufferAttribute(new Float32Array(capacity * 2), 2);
    const box = new Sphere();
    const parts: InstancedMesh[] = [];
    let triangles = 0;
    for (const [number, { geometry, double, clear }] of mergedOf(meshes, this.paints, false).entries()) {
      if (geometry.boundingSphere) {
        if (number === 0) box.copy(geometry.boundingSphere);
        else box.union(geometry.boundingSphere);
      }
      triangles += (geometry.index?.count ?? 0) / 3;
      geometry.setAttribute('room', room);
      const drawn = new InstancedMesh(geometry, this.paints.get(double, clear), 0);
      drawn.instanceMatrix = matrices;
      drawn.instanceColor = colors;
      drawn.frustumCulled = false;
      drawn.matrixAutoUpdate = false;
      drawn.count = 0;
      drawn.name = name;
      drawn.renderOrder = 1;
      this.group.add(drawn);
      parts.push(drawn);
    }
    for (const mesh of meshes) mesh.geometry.dispose();
    const sphere = box.clone().applyMatrix4(local);
    for (const part of parts) {
      part.castShadow = sphere.radius > 1.2;
      part.receiveShadow = beyond === 0;
    }
    own.push({
      beyond, parts, local, sphere, count: 0, capacity, matrices, colors, rooms: room, triangles, drawn: [],
      trees: [],
    });
    if (this.tone) for (const form of own) this.dress(form);
    own.sort((one, other) => other.beyond - one.beyond); // coarse first
    this.forms.set(name, own);
  }

  private dropForm(own: Form[], form: Form): void {
    own.splice(own.indexOf(form), 1);
    for (const part of form.parts) {
      this.natural.delete(part);
      this.group.remove(part);
      part.geometry.dispose();
      part.dispose();
    }
  }

  /** Read the rows that a node of a chunk tells of. */
  async addRows(parser: GLTFParser, chunk: string, layer: string, told: RowsRecord): Promise<void> {
    const get = async (name: string): Promise<BufferAttribute> =>
      (await parser.getDependency('accessor', told.rows[name] ?? -1)) as BufferAttribute;
    const [place, turn, scale, color, id, owner, room] = await Promise.all(
      ['TRANSLATION', 'ROTATION', 'SCALE', '_COLOR_0', '_CITYX_ID', '_CITYX_OWNER', '_CITYX_ROOM'].map(get),
    );
    if (!place || !turn || !scale || !color || !id || !owner || !room) return;
    const position = new Vector3();
    const rotation = new Quaternion();
    const size = new Vector3();
    const matrix = new Matrix4();
    const list = this.blocks.get(chunk) ?? [];
    let first = 0;
    for (const [prototype, count] of told.counts) {
      const block: Block = {
        chunk, layer, prototype, count,
        matrices: new Float32Array(count * 16), colors: new Float32Array(count * 3),
        rooms: new Float32Array(count * 2), ids: new Uint16Array(count * 4), owners: new Uint16Array(count * 4),
        sphere: new Sphere(),
      };
      const points: Vector3[] = [];
      for (let row = 0; row < count; row++) {
        const at = first + row;
        position.set(
          place.getX(at) + told.origin[0], place.getY(at) + told.origin[1], place.getZ(at) + told.origin[2],
        );
        rotation.set(turn.getX(at), turn.getY(at), turn.getZ(at), turn.getW(at)).normalize();
        size.set(scale.getX(at), scale.getY(at), scale.getZ(at));
        matrix.compose(position, rotation, size).toArray(block.matrices, row * 16);
        block.colors.set([color.getX(at), color.getY(at), color.getZ(at)], row * 3);
        block.rooms.set([room.getX(at), room.getY(at) / 256], row * 2);
        block.ids.set([id.getX(at), id.getY(at), id.getZ(at), id.getW(at)], row * 4);
        block.owners.set([owner.getX(at), owner.getY(at), owner.getZ(at), owner.getW(at)], row * 4);
        points.push(position.clone());
      }
      if (prototype.startsWith(POLE)) this.light(block);
      block.sphere.setFromPoints(points);
      block.sphere.radius += 10;
      list.push(block);
      first += count;
    }
    this.blocks.set(chunk, list);
  }

  /** Show rows in colours of their own, or as they are. */
  setTone(tone: ((id: string, owner: string, layer: string) => Color) | null): void {
    this.tone = tone;
    for (const forms of this.forms.values()) for (const form of forms) this.dress(form);
  }

  /** Let the lights of poles show what is told of them. */
  showLamps(lit: ReadonlyMap<string, Lit>): void {
    this.lit = lit;
    for (const list of this.blocks.values()) for (const block of list) if (block.prototype.startsWith(POLE)) this.light(block);
    for (const [prototype, forms] of this.forms) if (prototype.startsWith(POLE)) for (const form of forms) {
      const rooms = form.rooms.array as Float32Array;
      form.drawn.forEach(({ block, row }, at) => rooms.set(block.rooms.subarray(row * 2, row * 2 + 2), at * 2));
      form.rooms.needsUpdate = true;
    }
  }

  /** A pole tells what it shows where another thing tells of its room. */
  private light(block: Block): void {
    for (let row = 0; row < block.count; row++) block.rooms.set(this.lit.get(idText(block.ids, row)) ?? [0, 0], row * 2);
  }

  private dress(form: Form): void {
    for (const part of form.parts) {
      const own = this.natural.get(part) ?? part.material;
      this.natural.set(part, own);
      part.material = this.tone ? this.flat : own;
    }
  }

  removeChunk(chunk: string): void {
    this.blocks.delete(chunk);
  }

  /** Choose what is drawn from where the camera is: the largest to the eye, up to a number of triangles. */
  update(camera: Camera, height: number, most: number): void {
    const asked = this.least;
    for (let round = 0; round < ROUNDS; round++) {
      this.choose(camera, height);
      let triangles = 0;
      for (const forms of this.forms.values()) for (const form of forms) triangles += form.drawn.length * form.triangles;
      this.triangles = triangles;
      if (triangles <= most) break;
      this.least *= COARSER;
    }
    this.drawn = 0;
    for (const forms of this.forms.values()) for (const form of forms) this.show(form);
    this.least = asked;
  }

  private choose(camera: Camera, height: number): void {
    camera.updateMatrixWorld();
    const frustum = frustumOf(camera);
    const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld);
    const focal = (camera.projectionMatrix.elements[5] ?? 1) * height; // pixels of a metre, a metre off, times 2
    for (const forms of this.forms.values()) for (const form of forms) {
      form.count = 0;
      form.drawn.length = 0;
    }
    const sphere = new Sphere();
    for (const list of this.blocks.values()) {
      for (const block of list) {
        const forms = this.forms.get(block.prototype);
        if (!forms || this.hidden.has(block.layer) || !frustum.intersectsSphere(block.sphere)) continue;
        const own = forms[forms.length - 1]?.sphere;
        if (!own) continue;
        const near = Math.max(eye.distanceTo(block.sphere.center) - block.sphere.radius, 0.1);
        if ((own.radius * 3 * focal) / near < this.least) continue;
        this.chooseRows(block, forms, own, eye, focal, frustum, sphere);
      }
    }
  }

  private chooseRows(
    block: Block, forms: Form[], own: Sphere, eye: Vector3, focal: number, frustum: Frustum, sphere: Sphere,
  ): void {
    const m = block.matrices;
    const { x, y, z } = own.center;
    for (let row = 0; row < block.count; row++) {
      const at = row * 16;
      const a = m[at] ?? 0, b = m[at + 1] ?? 0, c = m[at + 2] ?? 0;
      const d = m[at + 4] ?? 0, e = m[at + 5] ?? 0, f = m[at + 6] ?? 0;
      const g = m[at + 8] ?? 0, h = m[at + 9] ?? 0, i = m[at + 10] ?? 0;
      sphere.center.set(
        a * x + d * y + g * z + (m[at + 12] ?? 0),
        b * x + e * y + h * z + (m[at + 13] ?? 0),
        c * x + f * y + i * z + (m[at + 14] ?? 0),
      );
      const stretch = Math.sqrt(Math.max(a * a + b * b + c * c, d * d + e * e + f * f, g * g + h * h + i * i));
      sphere.radius = own.radius * stretch;
      const away = Math.max(eye.distanceTo(sphere.center), 0.1);
      if ((sphere.radius * focal) / away < this.least || !frustum.intersectsSphere(sphere)) continue;
      const form = forms.find((each) => each.beyond <= away * this.coarse) ?? forms[forms.length - 1];
      if (form) form.drawn.push({ block, row });
    }
  }

  private show(form: Form): void {
    const count = form.drawn.length;
    form.count = count;
    if (count > form.capacity) this.grow(form, Math.ceil(count * MARGIN));
    const matrices = form.matrices.array as Float32Array;
    const colors = form.colors.array as Float32Array;
    const rooms = form.rooms.array as Float32Array;
    const matrix = new Matrix4();
    for (let at = 0; at < count; at++) {
      const { block, row } = form.drawn[at] as { block: Block; row: number };
      matrix.fromArray(block.matrices, row * 16).multiply(form.local).toArray(matrices, at * 16);
      if (this.tone) this.tone(idText(block.ids, row), idText(block.owners, row), block.layer).toArray(colors, at * 3);
      else colors.set(block.colors.subarray(row * 3, row * 3 + 3), at * 3);
      rooms.set(block.rooms.subarray(row * 2, row * 2 + 2), at * 2);
    }
    form.matrices.needsUpdate = form.colors.needsUpdate = form.rooms.needsUpdate = true;
    for (const part of form.parts) {
      part.count = count;
      part.visible = count > 0;
    }
    this.drawn += count;
  }

  private grow(form: Form, capacity: number): void {
    form.capacity = capacity;
    form.matrices = new InstancedBufferAttribute(new Float32Array(capacity * 16), 16).setUsage(DynamicDrawUsage);
    form.colors = new InstancedBufferAttribute(new Float32Array(capacity * 3), 3).setUsage(DynamicDrawUsage);
    form.rooms = new InstancedBufferAttribute(new Float32Array(capacity * 2), 2).setUsage(DynamicDrawUsage);
    for (const part of form.parts) {
      part.dispose();
      part.instanceMatrix = form.matrices;
      part.instanceColor = form.colors;
      part.geometry.setAttribute('room', form.rooms);
    }
  }

  /** Return the first instance that a ray meets among those that are drawn. */
  raycast(ray: Ray, furthest: number): RowHit | null {
    let best: RowHit | null = null;
    let limit = furthest;
    const matrix = new Matrix4();
    const inverse = new Matrix4();
    const own = new Ray();
    const point = new Vector3();
    for (const [prototype, forms] of this.forms) for (const form of forms) {
      if (!form.count) continue;
      const world = form.matrices.array as Float32Array;
      for (const [number, part] of form.parts.entries()) {
        const { geometry } = part;
        const local = geometry.boundingSphere;
        for (let at = 0; local && at < form.count; at++) {
          if (!nears(ray, world, at * 16, local, limit)) continue;
          matrix.fromArray(world, at * 16);
          inverse.copy(matrix).invert();
          own.copy(ray).applyMatrix4(inverse);
          const hit = this.tree(form, number, geometry).raycastFirst(own, part.material as Material);
          if (!hit) continue;
          point.copy(hit.point).applyMatrix4(matrix);
          const distance = point.distanceTo(ray.origin);
          if (distance >= limit) continue;
          const held = form.drawn[at] as { block: Block; row: number };
          limit = distance;
          best = {
            distance, point: point.clone(), layer: held.block.layer, prototype,
            id: idText(held.block.ids, held.row), owner: idText(held.block.owners, held.row),
          };
        }
      }
    }
    return best;
  }

  private tree(form: Form, part: number, geometry: BufferGeometry): MeshBVH {
    return (form.trees[part] ??= new MeshBVH(geometry, { indirect: true }));
  }

  /** Meshes of all instances that an object is, or that belong to it; for a highlight. */
  outlines(ids: Set<string>): Mesh[] {
    const found: Mesh[] = [];
    for (const list of this.blocks.values()) for (const block of list) {
      for (let row = 0; row < block.count; row++) {
        if (!ids.has(idText(block.ids, row))) continue;
        const forms = this.forms.get(block.prototype);
        const form = forms?.[forms.length - 1];
        if (!form) continue;
        const matrix = new Matrix4().fromArray(block.matrices, row * 16).multiply(form.local);
        for (const part of form.parts) {
          const mesh = new Mesh(bare(part.geometry));
          mesh.matrixAutoUpdate = false;
          mesh.matrix.copy(matrix);
          found.push(mesh);
        }
      }
    }
    return found;
  }

  /** Where an instance stands, null if there is none of this id. */
  placeOf(id: string): Vector3 | null {
    for (const list of this.blocks.values()) for (const block of list) {
      for (let row = 0; row < block.count; row++) {
        if (idText(block.ids, row) === id) return new Vector3().fromArray(block.matrices, row * 16 + 12);
      }
    }
    return null;
  }

  layers(): Set<string> {
    const found = new Set<string>();
    for (const list of this.blocks.values()) for (const block of list) found.add(block.layer);
    return found;
  }
}

/** Whether a ray passes through the ball about an instance, nearer than a limit. */
function nears(ray: Ray, m: Float32Array, at: number, ball: Sphere, limit: number): boolean {
  const { x, y, z } = ball.center;
  const a = m[at] ?? 0, b = m[at + 1] ?? 0, c = m[at + 2] ?? 0;
  const d = m[at + 4] ?? 0, e = m[at + 5] ?? 0, f = m[at + 6] ?? 0;
  const g = m[at + 8] ?? 0, h = m[at + 9] ?? 0, i = m[at + 10] ?? 0;
  const east = a * x + d * y + g * z + (m[at + 12] ?? 0) - ray.origin.x;
  const up = b * x + e * y + h * z + (m[at + 13] ?? 0) - ray.origin.y;
  const south = c * x + f * y + i * z + (m[at + 14] ?? 0) - ray.origin.z;
  const stretch = Math.max(a * a + b * b + c * c, d * d + e * e + f * f, g * g + h * h + i * i);
  const radius = ball.radius * Math.sqrt(stretch);
  const along = east * ray.direction.x + up * ray.direction.y + south * ray.direction.z;
  if (along < -radius || along - radius > limit) return false;
  return east * east + up * up + south * south - along * along <= radius * radius;
}

function bare(geometry: BufferGeometry): BufferGeometry {
  const found = new BufferGeometry();
  found.setAttribute('position', geometry.getAttribute('position'));
  found.setIndex(geometry.index);
  return found;
}

/** Write an id of four 16-bit words, lowest first, as 16 hexadecimal digits. */
export function idText(words: ArrayLike<number>, row: number): string {
  let text = '';
  for (let word = 3; word >= 0; word--) text += (words[row * 4 + word] ?? 0).toString(16).padStart(4, '0');
  return text === '0000000000000000' ? '' : text;
}

/** What a camera sees. */
export function frustumOf(camera: Camera): Frustum {
  return new Frustum().setFromProjectionMatrix(
    new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse),
  );
}

export function meshesIn(root: { traverse(visit: (node: object) => void): void }): Mesh[] {
  const found: Mesh[] = [];
  root.traverse((node) => {
    if (node instanceof Mesh) found.push(node);
  });
  return found;
}
