/** The city: chunks that come and go, nearest first, and what a ray meets in them. */

import { BufferAttribute, BufferGeometry, Camera, Color, Group, Mesh, Ray, Vector2, Vector3, type Material } from 'three';
import { GLTFLoader, type GLTF } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { MeshBVH } from 'three-mesh-bvh';
import { mergedOf } from './merging';
import { Paints, colorOf, type Coloring } from './paints';
import { meshesIn, Rows } from './rows';
import type { Source } from './source';
import type { ChunkInfo, PackInfo, Provenance, SceneInfo } from './types';

export interface Hit {
  distance: number;
  point: Vector3;
  id: string;
  owner: string;
  layer: string;
  prototype: string;
}

interface Surface {
  mesh: Mesh;
  layer: string;
  ids: string[];
  /** Row of `ids`, by vertex. */
  feature: Uint32Array;
  tree?: MeshBVH;
  natural: BufferAttribute;
}

interface Chunk {
  info: ChunkInfo;
  group: Group;
  surfaces: Surface[];
}

const AT_ONCE = 6; // chunks on their way
const GROUPS = ['ground', 'buildings', 'surroundings', 'nature', 'street'];
const LATER = 60; // metres that a chunk of the next group seems further off
// What hides much is drawn first.
const ORDER: Record<string, number> = { ground: 2, surroundings: 3 };
const SMALL = 0.1; // square metres of a triangle of the ground: two of three are smaller, of a hundredth of its area
const UNSEEN = 0.5; // square pixels
const SPOT = new Vector3();
const FORM_WAITS = 500; // metres; what is further off asks for no near form

export class City {
  readonly group = new Group();
  readonly paints = new Paints();
  readonly rows = new Rows(this.paints);
  readonly chunks = new Map<string, Chunk>();
  readonly hidden = new Set<string>();
  coloring: Coloring = 'natural';
  /** Called when something came or went. */
  changed: () => void = () => {};
  failed: (what: string) => void = () => {};
  /** Called when all chunks of ground and buildings have come. */
  standing: () => void = () => {};
  /** Called with the models of what moves. */
  movers: (file: GLTF) => void = () => {};
  pending = 0;
  /** Parts of the city that could not be loaded, and why. */
  readonly missing = new Map<string, string>();
  private readonly origins = new Map<string, number>();
  private originOfLayer: Record<string, number> = {};
  private readonly loader = new GLTFLoader();
  /** Name of the pack that is loaded, by kind and distance. */
  private readonly packs = new Map<string, string>();
  private paintsName = '';
  private wanted = 0;

  constructor(private readonly source: Source) {
    this.loader.setMeshoptDecoder(MeshoptDecoder);
    this.group.add(this.rows.group);
  }

  /** Show a state of the city: load what is new, nearest first, and drop what is gone. */
  async show(scene: SceneInfo, eye: Vector3): Promise<{ came: string[]; went: string[] }> {
    const turn = ++this.wanted;
    const listed = new Map(scene.chunks.map((chunk) => [chunk.name, chunk]));
    const went = [...this.chunks.keys()].filter((name) => !listed.has(name));
    this.missing.clear(); // they are asked for again
    const news = scene.chunks.filter((chunk) => !this.chunks.has(chunk.name));
    if (scene.paints !== this.paintsName) {
      await this.paints.read(await this.parse(`paints/${scene.paints}.glb`));
      this.paintsName = scene.paints;
    }
    const order = (chunk: ChunkInfo): number => away(chunk, eye) + LATER * GROUPS.indexOf(chunk.group);
    news.sort((one, other) => order(one) - order(other));
    const packs = scene.packs.filter((pack) => this.packs.get(`${pack.kind} ${pack.beyond}`) !== pack.name);
    let left = news.filter((chunk) => chunk.group === 'ground' || chunk.group === 'buildings').length;
    const jobs: (() => Promise<void>)[] = news.map((chunk) => async () => {
      await this.load(chunk, went, turn);
      if ((chunk.group === 'ground' || chunk.group === 'buildings') && --left === 0) this.standing();
    });
    const small = packs.filter((pack) => pack.beyond > 0 || pack.kind !== 'tree');
    jobs.splice(Math.min(jobs.length, 8), 0, ...small.map((pack) => () => this.loadPack(pack)));
    jobs.push(...packs.filter((pack) => !small.includes(pack)).map((pack) => () => this.loadPack(pack)));
    this.pending = jobs.length;
    await inTurn(jobs, AT_ONCE, () => {
      this.pending--;
      this.changed();
    });
    if (turn === this.wanted) for (const name of went) this.drop(name);
    this.pending = 0;
    this.changed();
    return { came: news.map((chunk) => chunk.name), went };
  }

  private async parse(name: string): Promise<GLTF> {
    return this.loader.parseAsync(await this.source.bytes(name), '');
  }

  private async loadPack(pack: PackInfo): Promise<void> {
    try {
      const file = await this.parse(`packs/${pack.name}.glb`);
      if (pack.kind === 'mover') this.movers(file);
      else this.rows.addPack(file);
      this.packs.set(`${pack.kind} ${pack.beyond}`, pack.name);
    } catch (error) {
      this.failed(`The forms of ${pack.kind} cannot be shown: ${said(error)}`);
    }
  }

  private async load(info: ChunkInfo, went: string[], turn: number): Promise<void> {
    let file: GLTF;
    try {
      file = await this.parse(`chunks/${info.name}.glb`);
    } catch (error) {
      this.missing.set(info.name, `${info.group}, cell ${info.cell.join(', ')}: ${said(error)}`);
      const [first] = this.missing.values();
      this.failed(`${this.missing.size === 1 ? 'A part' : `${this.missing.size} parts`} of the city cannot be shown (${first}). The rest is there; reload the page to try again.`);
      return;
    }
    const chunk: Chunk = { info, group: new Group(), surfaces: [] };
    const ids = await readIds(file);
    for (const node of [...file.scene.children]) {
      const layer = node.name;
      const told = node.userData as Parameters<Rows['addRows']>[3] | { rows?: undefined };
      if (told.rows) await this.rows.addRows(file.parser, info.name, layer, told);
      node.updateWorldMatrix(true, true);
      for (const surface of this.surfaces(meshesIn(node), layer, ids)) {
        chunk.surfaces.push(surface);
        chunk.group.add(surface.mesh);
      }
    }
    // What a change replaces goes in the same frame as what comes in its place.
    const older = [...this.chunks.values()].find(
      (each) => went.includes(each.info.name) && each.info.group === info.group && sameCell(each.info, info),
    );
    if (turn !== this.wanted) {
      this.rows.removeChunk(info.name);
      return;
    }
    if (older) this.drop(older.info.name);
    this.chunks.set(info.name, chunk);
    this.group.add(chunk.group);
    chunk.group.updateMatrixWorld(true);
    this.dress(chunk);
  }

  private surfaces(meshes: Mesh[], layer: string, ids: string[]): Surface[] {
    const least = layer === 'ground' ? SMALL : 0;
    return mergedOf(meshes, this.paints, true, least).map(({ geometry, origin, feature, double, clear }) => {
      const mesh = new Mesh(geometry, this.paints.get(double, clear));
      mesh.position.copy(origin);
      mesh.castShadow = layer !== 'ground' && layer !== 'surroundings';
      mesh.receiveShadow = true;
      mesh.visible = !this.hidden.has(layer);
      mesh.renderOrder = ORDER[layer] ?? 0;
      if (least) leaveSmall(mesh);
      for (const each of meshes) each.geometry.dispose();
      return { mesh, layer, ids, feature, natural: geometry.getAttribute('paint') as BufferAttribute };
    });
  }

  private drop(name: string): void {
    const chunk = this.chunks.get(name);
    this.rows.removeChunk(name);
    if (!chunk) return;
    this.chunks.delete(name);
    this.group.remove(chunk.group);
    for (const surface of chunk.surfaces) surface.mesh.geometry.dispose();
  }

  setHidden(layer: string, hidden: boolean): void {
    if (hidden) this.hidden.add(layer);
    else this.hidden.delete(layer);
    if (hidden) this.rows.hidden.add(layer);
    else this.rows.hidden.delete(layer);
    for (const chunk of this.chunks.values()) {
      for (const surface of chunk.surfaces) if (surface.layer === layer) surface.mesh.visible = !hidden;
    }
    this.changed();
  }

  layers(): string[] {
    const found = this.rows.layers();
    for (const chunk of this.chunks.values()) for (const surface of chunk.surfaces) found.add(surface.layer);
    return [...found].sort();
  }

  setColoring(coloring: Coloring): void {
    this.coloring = coloring;
    this.rows.group.visible = coloring !== 'height';
    this.rows.setTone(coloring === 'natural' ? null : (id, owner, layer) => this.toneOf(id, owner, layer));
    for (const chunk of this.chunks.values()) this.dress(chunk);
    this.changed();
  }

  /** Tell where objects are from. */
  setProvenance(told: Provenance): void {
    this.origins.clear();
    told.origins.forEach((name, which) => told.ids[name]?.forEach((id) => this.origins.set(id, which)));
    this.originOfLayer = told.layers;
    if (this.coloring === 'provenance') this.setColoring('provenance');
  }

  private toneOf(id: string, owner: string, layer: string): Color {
    if (this.coloring === 'instance') return colorOf(owner || id);
    if (this.coloring !== 'provenance') return colorOf(layer);
    const which = this.origins.get(id) ?? this.origins.get(owner) ?? this.originOfLayer[layer] ?? 1;
    return ORIGINS[which] ?? UNKNOWN;
  }

  /** Give the meshes of a chunk the look that was chosen. */
  private dress(chunk: Chunk): void {
    for (const surface of chunk.surfaces) {
      if (this.coloring === 'natural' || surface.layer === 'surroundings') {
        surface.mesh.geometry.setAttribute('paint', surface.natural);
      } else paint(surface, this.coloring, (id) => this.toneOf(id, '', surface.layer));
    }
  }

  /** Return what a ray meets first, null for the sky. */
  raycast(ray: Ray, furthest = Infinity): Hit | null {
    let best: Hit | null = null;
    let limit = furthest;
    const own = new Ray();
    const point = new Vector3();
    for (const chunk of this.chunks.values()) {
      for (const surface of chunk.surfaces) {
        if (!surface.mesh.visible) continue;
        const geometry = surface.mesh.geometry;
        if (!geometry.boundingSphere) geometry.computeBoundingSphere();
        own.copy(ray).applyMatrix4(surface.mesh.matrixWorld.clone().invert());
        if (geometry.boundingSphere && !own.intersectsSphere(geometry.boundingSphere)) continue;
        surface.tree ??= new MeshBVH(geometry, { indirect: true }); // sections and small triangles stay in order
        const hit = surface.tree.raycastFirst(own, surface.mesh.material as Material);
        if (!hit?.face) continue;
        point.copy(hit.point).applyMatrix4(surface.mesh.matrixWorld);
        const distance = point.distanceTo(ray.origin);
        if (distance >= limit) continue;
        limit = distance;
        const id = surface.ids[surface.feature[hit.face.a] ?? -1] ?? '';
        best = { distance, point: point.clone(), id, owner: '', layer: surface.layer, prototype: '' };
      }
    }
    const row = this.rows.group.visible ? this.rows.raycast(ray, limit) : null;
    return row ?? best;
  }

  /** Return meshes of some objects, for a highlight. */
  outlines(ids: Set<string>): Mesh[] {
    const found = this.rows.outlines(ids);
    for (const chunk of this.chunks.values()) for (const surface of chunk.surfaces) {
      const wanted = new Set<number>();
      surface.ids.forEach((id, number) => ids.has(id) && wanted.add(number));
      if (!wanted.size) continue;
      const index = surface.mesh.geometry.index;
      if (!index) continue;
      const kept: number[] = [];
      for (let at = 0; at < index.count; at += 3) {
        if (wanted.has(surface.feature[index.getX(at)] ?? -1)) kept.push(index.getX(at), index.getX(at + 1), index.getX(at + 2));
      }
      if (!kept.length) continue;
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', surface.mesh.geometry.getAttribute('position'));
      geometry.setIndex(kept);
      const mesh = new Mesh(geometry);
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(surface.mesh.matrixWorld);
      found.push(mesh);
    }
    return found;
  }

  /** Choose which instances are drawn, up to a number of triangles with those of meshes. */
  update(camera: Camera, height: number, most: number): void {
    let own = 0;
    for (const chunk of this.chunks.values()) own += chunk.info.triangles;
    this.rows.update(camera, height, Math.max(most - own, most / 3));
  }

  /** Ids of all objects of meshes that are loaded. */
  ids(): Set<string> {
    const found = new Set<string>();
    for (const chunk of this.chunks.values()) for (const each of chunk.surfaces) each.ids.forEach((id) => found.add(id));
    return found;
  }
}

/** Let small triangles go where they cover less than a share of a pixel; the sky is like ground there. */
function leaveSmall(mesh: Mesh): void {
  const { geometry } = mesh;
  const large = geometry.userData['large'] as number;
  const middle = new Vector3();
  const size = new Vector2();
  mesh.onBeforeRender = (renderer, _scene, camera) => {
    const ball = geometry.boundingSphere;
    if (!ball) return;
    middle.copy(ball.center).applyMatrix4(mesh.matrixWorld);
    const near = Math.max(middle.distanceTo(SPOT.setFromMatrixPosition(camera.matrixWorld)) - ball.radius, 0.1);
    const metre = ((camera.projectionMatrix.elements[5] ?? 1) * renderer.getDrawingBufferSize(size).y) / 2 / near;
    geometry.setDrawRange(0, SMALL * metre * metre < UNSEEN ? large : Infinity);
  };
  mesh.onAfterRender = () => geometry.setDrawRange(0, Infinity);
}

function sameCell(one: ChunkInfo, other: ChunkInfo): boolean {
  return one.cell[0] === other.cell[0] && one.cell[1] === other.cell[1];
}

function away(chunk: ChunkInfo, eye: Vector3): number {
  const [west, south, , east, north] = chunk.box;
  const x = Math.max(west - eye.x, 0, eye.x - east);
  const y = Math.max(south + eye.z, 0, -eye.z - north);
  return Math.min(Math.hypot(x, y), FORM_WAITS * 20);
}

async function inTurn(jobs: (() => Promise<void>)[], most: number, done: () => void): Promise<void> {
  let next = 0;
  const work = async (): Promise<void> => {
    for (;;) {
      const job = jobs[next++];
      if (!job) return;
      await job();
      done();
    }
  };
  await Promise.all(Array.from({ length: Math.min(most, jobs.length) }, work));
}

interface Tables {
  propertyTables?: { count: number; properties: { id: { values: number } } }[];
}

/** Read the ids of the property table of a chunk, by feature id. */
async function readIds(file: GLTF): Promise<string[]> {
  const json = file.parser.json as { extensions?: { EXT_structural_metadata?: Tables } };
  const table = json.extensions?.EXT_structural_metadata?.propertyTables?.[0];
  if (!table) return [];
  const data = (await file.parser.getDependency('bufferView', table.properties.id.values)) as ArrayBuffer;
  const text = new TextDecoder().decode(new Uint8Array(data, 0, table.count * 16));
  return Array.from({ length: table.count }, (_, row) => text.slice(row * 16, row * 16 + 16));
}

/** Colours of what a map tells, a rule made, an edit changed, and a library holds. */
export const ORIGINS = [new Color(0x3b7dbf), new Color(0xd08a2e), new Color(0xc2367a), new Color(0x3d9a50)];
const UNKNOWN = new Color(0x777777);
const HEIGHTS = 60; // metres at which the colour of heights ends

function paint(surface: Surface, coloring: Coloring, tone: (id: string) => Color): void {
  const { geometry } = surface.mesh;
  const position = geometry.getAttribute('position');
  const color = new Uint8Array(position.count * 4); // layer 0, white
  const texts = surface.ids.map((id) => tone(id).clone());
  for (let at = 0; at < position.count; at++) {
    let shown = texts[surface.feature[at] ?? -1] ?? colorOf('');
    if (coloring === 'height') {
      const share = Math.min(Math.max((position.getY(at) + surface.mesh.position.y) / HEIGHTS, 0), 1);
      shown = shown.clone().setHSL(0.62 * (1 - share), 0.75, 0.42);
    }
    color.set([shown.r * 255, shown.g * 255, shown.b * 255], at * 4);
  }
  geometry.setAttribute('paint', new BufferAttribute(color, 4, true));
}

function said(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
