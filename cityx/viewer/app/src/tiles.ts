/** The page of a folder of tiles: those near the camera are loaded, others let go, a click tells of an object. */

import {
  AmbientLight, Color, DirectionalLight, InstancedMesh, Matrix4, Mesh, PerspectiveCamera, Raycaster, Scene, Vector2,
  Vector3, WebGLRenderer, type Intersection, type Object3D,
} from 'three';
import { MapControls } from 'three/addons/controls/MapControls.js';
import type { GLTF, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { TilesRenderer } from '3d-tiles-renderer/three';
import { GLTFExtensionsPlugin } from '3d-tiles-renderer/three/plugins';
import { byId, el, table, words } from './dom';
import { Source } from './source';

/** Where the page begins: its tile and what takes its metres, x east, y north, z up, to places on Earth. */
interface Start {
  name: string;
  credits: string[];
  tile: string;
  transform: number[];
  extent: [number, number];
  /** Whether a server answers, and not the files of a static site. */
  live?: boolean;
}

const TARGET = 12; // pixels that what is shown may be off
const NEAR = 1;
const FAR = 20_000;
const AT_ONCE = 6; // files on their way
const MOST_BYTES = 600e6; // of tiles that are out of sight
const MOST_FOUND = 40;
const SKY = 0xbfd4e6;
const FROM = [0, 130, 150] as const; // metres from what was looked for

/** Keeps which object each vertex and each placed thing of a file is. */
class Ids {
  readonly name = 'cityx_ids';

  constructor(private readonly parser: GLTFParser) {}

  async afterRoot(file: GLTF): Promise<void> {
    const json = this.parser.json as Json;
    const metadata = json.extensions?.EXT_structural_metadata;
    const table = metadata?.propertyTables?.[0];
    if (!metadata || !table) return;
    const bytes = async (view: number): Promise<Uint8Array> =>
      new Uint8Array((await this.parser.getDependency('bufferView', view)) as ArrayBuffer);
    const text = new TextDecoder().decode((await bytes(table.properties.id.values)).subarray(0, table.count * 16));
    const ids = Array.from({ length: table.count }, (_, row) => text.slice(row * 16, row * 16 + 16));
    const layers = Array.from((await bytes(table.properties.layer.values)).subarray(0, table.count), (one) =>
      metadata.schema.enums.layer.values[one]?.name ?? '');
    file.scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      const at = this.parser.associations.get(object);
      const placed = json.nodes[at?.nodes ?? -1]?.extensions?.EXT_instance_features;
      const merged = json.meshes[at?.meshes ?? -1]?.primitives[at?.primitives ?? 0]?.extensions?.EXT_mesh_features;
      if (placed ?? merged) object.userData.objects = { ids, layers } satisfies Objects;
    });
  }
}

/** Ids and layers of what a file shows, by feature id. */
interface Objects {
  ids: string[];
  layers: string[];
}

interface Json {
  extensions?: {
    EXT_structural_metadata?: {
      schema: { enums: { layer: { values: { name: string }[] } } };
      propertyTables?: { count: number; properties: { id: { values: number }; layer: { values: number } } }[];
    };
  };
  nodes: { extensions?: { EXT_instance_features?: object } }[];
  meshes: { primitives: { extensions?: { EXT_mesh_features?: object } }[] }[];
}

export interface Picked {
  id: string;
  layer: string;
  tile: string;
  distance: number;
}

const source = new Source();
const canvas = byId<HTMLCanvasElement>('view');
const renderer = new WebGLRenderer({ canvas, antialias: true, logarithmicDepthBuffer: true });
const scene = new Scene();
scene.background = new Color(SKY);
scene.add(new AmbientLight(0xffffff, 1.6));
const sun = new DirectionalLight(0xfff4e0, 2.4);
sun.position.set(0.5, 1, 0.35);
scene.add(sun);
const camera = new PerspectiveCamera(55, 1, NEAR, FAR);
const controls = new MapControls(camera, canvas);
controls.maxPolarAngle = 1.5;
const ray = new Raycaster();
let tiles: TilesRenderer | null = null;
let start: Start;
let failed = 0;
let names: Found[] | null = null; // of a static site, once they were asked for

/** Turn the frame of the tiles to that of the page: x east, y up, z south. */
function placed(transform: number[]): Matrix4 {
  const up = new Matrix4().makeRotationX(-Math.PI / 2);
  return up.multiply(new Matrix4().fromArray(transform).invert());
}

async function open(): Promise<void> {
  start = (await (await source.ask('start.json')).json()) as Start;
  byId('name').textContent = start.name;
  byId('credits').textContent = start.credits.join('; ');
  document.title = `${start.name} - CityX tiles`;
  tiles = new TilesRenderer(new URL('run/tileset.json', location.href).href);
  tiles.fetchOptions = { headers: source.headers(), cache: 'no-cache' };
  tiles.registerPlugin(new GLTFExtensionsPlugin({
    meshoptDecoder: MeshoptDecoder,
    plugins: [(parser: GLTFParser) => new Ids(parser)],
  }));
  tiles.errorTarget = TARGET;
  tiles.downloadQueue.maxJobsPerOrigin = AT_ONCE;
  tiles.lruCache.minBytesSize = MOST_BYTES / 2;
  tiles.lruCache.maxBytesSize = MOST_BYTES;
  tiles.setCamera(camera);
  const matrix = placed(start.transform);
  matrix.decompose(tiles.group.position, tiles.group.quaternion, tiles.group.scale);
  tiles.group.updateMatrixWorld(true);
  tiles.addEventListener('load-model', ({ scene: model, url }) => {
    model.userData.named = /tiles\/([^/]+)\//.exec(url)?.[1] ?? '';
  });
  tiles.addEventListener('load-error', ({ url }) => {
    failed += 1;
    say(`${new URL(String(url), location.href).pathname} could not be loaded.`);
  });
  scene.add(tiles.group);
  const reach = Math.max(...start.extent);
  camera.position.set(0, 0.45 * reach, 0.6 * reach);
  controls.target.set(0, 0, 0);
  controls.update();
}

/** How many files come; the types of the library do not name it. */
function counted(of: TilesRenderer): { downloading: number; parsing: number } {
  return (of as unknown as { stats: { downloading: number; parsing: number } }).stats;
}

function resize(): void {
  const { clientWidth: width, clientHeight: height } = canvas;
  renderer.setSize(width, height, false);
  camera.aspect = width / Math.max(height, 1);
  camera.updateProjectionMatrix();
}

function frame(): void {
  requestAnimationFrame(frame);
  controls.update();
  camera.updateMatrixWorld();
  if (tiles) {
    tiles.setResolutionFromRenderer(camera, renderer);
    tiles.update();
    const { downloading, parsing } = counted(tiles);
    byId('state').textContent = `${tiles.group.children.length} shown, ${downloading + parsing} on their way`;
  }
  renderer.render(scene, camera);
}

/** Tell what lies under a place of the page. */
export function pick(x: number, y: number): Picked | null {
  if (!tiles) return null;
  const box = canvas.getBoundingClientRect();
  ray.setFromCamera(new Vector2(((x - box.left) / box.width) * 2 - 1, 1 - ((y - box.top) / box.height) * 2), camera);
  const hits: Intersection[] = ray.intersectObject(tiles.group, true);
  for (const hit of hits) {
    const objects = hit.object.userData.objects as Objects | undefined;
    if (!objects || !(hit.object instanceof Mesh)) continue;
    const { geometry } = hit.object;
    const row = hit.object instanceof InstancedMesh
      ? geometry.getAttribute('_FEATURE_ID_0')?.getX(hit.instanceId ?? 0)
      : geometry.getAttribute('_feature_id_0')?.getX(hit.face?.a ?? 0);
    const id = objects.ids[row ?? -1];
    if (id) return { id, layer: objects.layers[row ?? -1] ?? '', tile: tileOf(hit.object), distance: hit.distance };
  }
  return null;
}

function tileOf(object: Object3D): string {
  for (let at: Object3D | null = object; at; at = at.parent) if (at.userData.named) return String(at.userData.named);
  return '';
}

async function tell(found: Picked): Promise<void> {
  const rows: [string, string][] = [['id', found.id], ['layer', words(found.layer)], ['tile', found.tile]];
  byId('content').replaceChildren(el('h2', {}, words(found.layer)), table(rows));
  byId('panel').hidden = false;
  const more = await known(found);
  for (const key of ['kind', 'name', 'source', 'licence']) {
    if (more[key]) rows.push([key, String(more[key])]);
  }
  const tags = Object.entries((more.tags ?? {}) as Record<string, string>);
  byId('content').replaceChildren(el('h2', {}, String(more.name || more.kind || found.layer)), table([...rows, ...tags]));
}

async function known(found: Picked): Promise<Record<string, unknown>> {
  if (start.live !== false) {
    return (await (await source.ask(`objects/${found.tile}/${found.id}`)).json()) as Record<string, unknown>;
  }
  const held = (await (await source.ask(`objects/${found.tile}.json`)).json()) as Record<string, Record<string, unknown>>;
  return held[found.id] ?? {};
}

interface Found {
  id: string;
  name: string;
  kind: string;
  tile: string;
  place: [number, number, number];
}

/** List what is called by some words, and go to the first. */
async function find(text: string): Promise<void> {
  const found = await searched(text);
  const list = found.map((one) => {
    const button = el('button', { type: 'button' }, one.name);
    button.addEventListener('click', () => go(one));
    return el('p', {}, button, ` ${words(one.kind)}`);
  });
  const said = list.length ? `${list.length} found` : `Nothing in these tiles is called “${text}”.`;
  byId('content').replaceChildren(el('h2', {}, text), el('p', { class: 'soft' }, said), ...list);
  byId('panel').hidden = false;
  if (found[0]) go(found[0]);
}

/** What is called by some words, the best first: whole names, then beginnings, then names that have all of them. */
async function searched(text: string): Promise<Found[]> {
  if (start.live !== false) {
    return ((await (await source.ask(`search?text=${encodeURIComponent(text)}`)).json()) as { found: Found[] }).found;
  }
  names ??= (await (await source.ask('names.json')).json()) as Found[];
  const wanted = text.toLowerCase().split(/\s+/).filter(Boolean);
  const whole = wanted.join(' ');
  const rank = ({ id, name }: Found): number => {
    const own = name.toLowerCase();
    if (id === whole || own === whole) return 0;
    if (own.startsWith(whole)) return 1;
    return wanted.every((word) => own.includes(word)) ? 2 : 3;
  };
  return names.filter((one) => rank(one) < 3).sort((a, b) => rank(a) - rank(b)).slice(0, MOST_FOUND);
}

function go(one: Found): void {
  if (!tiles) return;
  const place = new Vector3(...one.place).applyMatrix4(tiles.group.matrixWorld);
  controls.target.copy(place);
  camera.position.copy(place).add(new Vector3(...FROM));
  controls.update();
}

function say(text: string): void {
  byId('notice').textContent = text;
  byId('notice').hidden = false;
}

let down = new Vector2();
canvas.addEventListener('pointerdown', (event) => (down = new Vector2(event.clientX, event.clientY)));
canvas.addEventListener('click', (event) => {
  if (down.distanceTo(new Vector2(event.clientX, event.clientY)) > 4) return;
  const found = pick(event.clientX, event.clientY);
  if (found) tell(found).catch((error: unknown) => say(String(error)));
});
byId('search').addEventListener('submit', (event) => {
  event.preventDefault();
  const text = byId<HTMLInputElement>('wanted').value.trim();
  if (text) find(text).catch((error: unknown) => say(String(error)));
});
byId('close').addEventListener('click', () => (byId('panel').hidden = true));
addEventListener('resize', resize);

const page = {
  camera, controls, pick, Vector3,
  /** What is shown and what is on its way. */
  get state() {
    const shown = tiles?.group.children ?? [];
    const count = tiles ? counted(tiles) : { downloading: 0, parsing: 0 };
    return { files: shown.length, tiles: [...new Set(shown.map(tileOf))].sort(), waiting: count.downloading + count.parsing, failed };
  },
};
(window as unknown as { cityx: typeof page }).cityx = page;
resize();
open().then(frame).catch((error: unknown) => say(String(error)));
