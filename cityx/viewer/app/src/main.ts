/** The page: a city to fly and walk through, to ask and to change. */

import {
  BasicShadowMap, Plane, PCFShadowMap, Scene, SRGBColorSpace, NeutralToneMapping, Vector3, WebGLRenderer, type Mesh,
} from 'three';
import type { GLTF } from 'three/addons/loaders/GLTFLoader.js';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { Eye, type Way } from './camera';
import { City, type Hit } from './city';
import { Dragging, wayText } from './dragging';
import { byId, el, save, words } from './dom';
import { exported } from './exporting';
import { Lamps } from './lamps';
import { Marks } from './marks';
import { Movement } from './movement';
import { clockOf, Panels, type Acts } from './panels';
import { Simulation } from './simulation';
import { Sketch } from './sketch';
import { airOf, Sky } from './sky';
import { Source } from './source';
import type { Details, GeoJson, News, Reply, Report, SceneInfo } from './types';

const SETTLE_MS = 120; // after a movement before instances are chosen anew
const CHANGED_MS = 6000; // that a change is marked
const HOVER_MS = 120;
const SLOW_MS = 90; // of a frame, above which less is drawn
const FAST_MS = 24;
const [FINEST, COARSEST] = [1.3, 6]; // pixels below which an instance is not drawn
const [MOST, MOST_PLAIN] = [1_000_000, 160_000]; // triangles of a view
const SOFT = 0.5; // of the pixels, along an edge, while a slow machine moves
const STILL_MS = 350;
const LOADING_MS = 800; // at least between two pictures of a slow machine while it loads
const RENEWS_MS = 2000; // at most without a picture while a slow machine loads what changed
const LOADING_SHARE = 4; // of the time of a picture that passes between them: the city is what is waited for
const MOST_MARKED = 300;
const [MODELS, MODELS_PLAIN] = [200, 60]; // metres within which movers show as their models
const FALLING_MS = 400; // between two pictures of a slow machine on which only rain or snow moves

class Page {
  readonly source = new Source();
  readonly city = new City(this.source);
  readonly scene = new Scene();
  readonly marks = new Marks();
  readonly renderer: WebGLRenderer;
  /** Whether the machine has no graphics card, and less is drawn. */
  readonly plain: boolean;
  readonly eye: Eye;
  readonly panels: Panels;
  readonly sketch: Sketch;
  readonly dragging: Dragging;
  told!: SceneInfo;
  sky!: Sky;
  movement: Movement | null = null;
  lamps: Lamps | null = null;
  simulation: Simulation | null = null;
  selected = '';
  frames = 0;
  frameMs = 0;
  private lastMs = 0; // of the last picture
  private lampsName = '';
  private gone = '';
  private models: GLTF | null = null;
  private moment = 0;
  private playing = false;
  private dirty = true;
  private stale = true; // instances are those of another place
  private movedAt = 0;
  private last = performance.now();
  private drawnAt = 0;
  private measured: Vector3[] = [];
  private measuring = false;
  private job = '';
  private cut: Plane | null = null;
  private down = { x: 0, y: 0 };
  private shown = Promise.resolve();
  private news = '';
  private renewing = -Infinity; // since when what changed is on its way

  constructor() {
    const canvas = byId<HTMLCanvasElement>('view');
    this.plain = isSoftware();
    this.city.paints.plain = this.plain;
    if (this.plain) this.city.rows.least = FINEST * 2; // rather less at first than slowly
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.plain, powerPreference: 'high-performance' });
    this.renderer.outputColorSpace = SRGBColorSpace;
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = this.plain ? BasicShadowMap : PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.renderer.localClippingEnabled = true;
    this.eye = new Eye(canvas);
    this.panels = new Panels(this.acts(), true);
    this.scene.add(this.city.group, this.marks.group);
    const drawn = (): void => void (this.dirty = true);
    this.sketch = new Sketch(this.marks, drawn, (text, ms) => this.notice(text, ms));
    this.dragging = new Dragging(canvas, this.marks, {
      grab: (x, y, broad) => this.grab(x, y, broad),
      meshes: (id) => this.outlines(id),
      ray: (x, y) => this.eye.ray(x, y).ray,
      move: (id, east, north) => this.moveBy(id, east, north),
      click: (x, y) => void this.click(x, y),
      drawn,
    });
    this.city.changed = () => this.refresh();
    this.city.standing = () => {
      this.sharpen(false);
      this.choose();
      this.renderer.shadowMap.needsUpdate = true;
      this.draw();
      this.reach('shown');
    };
    this.city.movers = (file) => {
      this.models = file;
      this.movement?.addModels(file, this.city.paints);
      this.dirty = true;
    };
    this.city.failed = (what) => this.notice(what);
    this.eye.moved = () => {
      this.movedAt = performance.now();
      this.stale = this.dirty = true;
    };
    this.eye.ground = (from) => this.groundUnder(from);
  }

  async start(): Promise<void> {
    this.controls();
    addEventListener('resize', () => this.resize());
    this.resize();
    try {
      this.told = await this.source.scene();
    } catch (error) {
      this.notice(`The city cannot be shown: ${error instanceof Error ? error.message : error}`);
      return;
    }
    this.panels.live = this.told.live && !this.told.simulated;
    byId('desk').hidden = !this.panels.live;
    document.title = `${this.told.name || 'City'} · CityX`;
    byId('name').textContent = this.told.name || 'City';
    byId('credits').textContent = this.told.attribution.join(' · ');
    this.sky = new Sky(this.scene, this.told, this.plain);
    this.eye.overview(this.told.extent, this.middle());
    this.renderer.setAnimationLoop((now) => this.frame(now));
    this.shown = this.load().then(() => {}, (error: unknown) =>
      this.notice(`The city cannot be shown: ${error instanceof Error ? error.message : String(error)}`));
    await this.shown;
    this.reach('ready');
    if (this.told.simulated) this.simulate();
    if (this.told.live) void this.source.listen((news) => this.heard(news), (there, why) => this.tellServer(there, why));
  }

  /** Say that the server is gone; once it is there again, that alone is taken back. */
  private tellServer(there: boolean, why: string): void {
    if (!there) this.notice((this.gone = why));
    else if (byId('notice').textContent === this.gone) this.notice('');
  }

  private simulate(): void {
    const simulation = new Simulation(this.source, {
      drawn: () => (this.dirty = true),
      follow: (from, to) => this.eye.follow(from, to),
      goTo: (id, place) => void this.flyTo(id, place),
    });
    this.simulation = simulation;
    if (this.movement) this.movement.group.visible = false; // recorded traffic is elsewhere
    byId('time').hidden = true;
    this.scene.add(simulation.group);
    void this.source.watch((running) => {
      simulation.show(running);
      this.showLamps(running.clock);
    });
  }

  private middle(): number {
    const heights = this.told.chunks.filter((chunk) => chunk.group === 'buildings').map((chunk) => chunk.box[2]);
    return heights.length ? Math.min(...heights) : 0;
  }

  /** Load what the page was told of. */
  private async load(): Promise<{ came: string[]; went: string[] } | void> {
    this.light();
    const news = await this.city.show(this.told, this.eye.position);
    await this.loadLamps();
    if (this.told.movement && !this.movement) await this.loadMovement();
    this.refresh();
    return news;
  }

  private async loadLamps(): Promise<void> {
    const name = this.told.lamps ?? '';
    if (name === this.lampsName) return;
    try {
      this.lamps = name ? new Lamps(await this.source.lamps(name)) : null;
    } catch (error) {
      this.notice(`It is not known what traffic lights show: ${error instanceof Error ? error.message : error}`, 8000);
      return;
    }
    this.lampsName = name;
    if (this.lamps) this.showLamps(this.movement ? this.moment : this.told.moment);
    else this.city.rows.showLamps(new Map());
  }

  private showLamps(moment: number): void {
    if (!this.lamps?.at(moment)) return;
    this.city.rows.showLamps(this.lamps.lit);
    this.dirty = true;
  }

  private async loadMovement(): Promise<void> {
    try {
      this.movement = new Movement(await this.source.bytes(`tracks/${this.told.movement}.bin`), this.plain ? MODELS_PLAIN : MODELS,
        this.city.paints, !this.plain);
    } catch {
      return;
    }
    this.scene.add(this.movement.group);
    if (this.models) this.movement.addModels(this.models, this.city.paints);
    const slider = byId<HTMLInputElement>('moment');
    slider.max = String(this.movement.duration);
    byId('time').hidden = false;
    this.setMoment(this.told.moment);
  }

  setMoment(moment: number): void {
    this.moment = moment;
    byId<HTMLInputElement>('moment').value = String(moment);
    byId('clock').textContent = `${moment.toFixed(1)} s`;
    this.movement?.at(moment);
    if (this.movement && !this.plain) this.renderer.shadowMap.needsUpdate = true; // theirs go along
    this.showLamps(moment);
    this.dirty = true;
  }

  // Frames

  private frame(now: number): void {
    const seconds = Math.min((now - this.last) / 1000, 0.2);
    this.last = now;
    const moving = this.eye.step(seconds, now);
    if (this.playing && this.movement) this.setMoment((this.moment + seconds) % this.movement.duration);
    this.fall(seconds, now);
    if (this.stale && (!moving || now - this.movedAt > SETTLE_MS || this.frames % 6 === 0)) this.choose();
    this.sharpen(moving || this.playing || now - this.movedAt < STILL_MS);
    if (this.plain && this.waits && !this.city.chunks.size) return; // an empty picture would only take time
    const apart = Math.max(LOADING_MS, this.lastMs * LOADING_SHARE);
    if (!this.dirty || (this.plain && this.city.pending && now - this.drawnAt < apart)) return;
    if (this.plain && !moving && now - this.renewing < RENEWS_MS) return; // the change itself is waited for
    this.draw();
    this.drawnAt = performance.now();
  }

  /** Let rain and snow fall, where they do and the user has nothing against it. */
  private fall(seconds: number, now: number): void {
    if (!this.sky.air.rain && !this.sky.air.snowfall) return;
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    const seen = this.sky.falling.step(still ? 0 : seconds, this.eye.position, this.middle(), this.renderer.domElement.height);
    if (seen && !still && (!this.plain || now - this.drawnAt > FALLING_MS)) this.dirty = true;
  }

  /** Draw once, whatever changed. */
  draw(): void {
    const begun = performance.now();
    this.renderer.render(this.scene, this.eye.camera);
    if (this.plain) this.waitForPixels();
    const spent = performance.now() - begun;
    this.lastMs = spent;
    this.frameMs = this.frameMs ? this.frameMs * 0.8 + spent * 0.2 : spent;
    this.frames++;
    this.dirty = false;
    this.adapt();
    this.tellPlace();
  }

  /** Wait until a machine without a graphics card has drawn: nothing else says how long it takes. */
  private waitForPixels(): void {
    const context = this.renderer.getContext();
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /** Draw less where frames take long, more where there is time. */
  private adapt(): void {
    if (this.frames % 4 && this.lastMs < SLOW_MS * 2) return; // what is far too slow does not wait
    const rows = this.city.rows;
    const before = rows.least;
    if (this.frameMs > SLOW_MS) rows.least = Math.min(Math.max(rows.least, FINEST) * 1.35, COARSEST);
    else if (this.frameMs < FAST_MS) rows.least = Math.max(rows.least / 1.2, FINEST);
    rows.coarse = rows.least / FINEST;
    if (rows.least !== before) this.stale = true;
  }

  /** Whether ground and buildings are still to come. */
  private get waits(): boolean {
    return !document.body.dataset['state'];
  }

  /** Draw fewer pixels while a slow machine moves or loads, all of them when it stands. */
  private sharpen(moving: boolean): void {
    const full = this.plain ? 1 : Math.min(devicePixelRatio, 2);
    const loads = this.plain && (this.waits || this.city.pending > 0);
    const wanted = loads || (moving && this.frameMs > SLOW_MS) ? full * SOFT : full;
    if (this.renderer.getPixelRatio() === wanted) return;
    this.renderer.setPixelRatio(wanted);
    this.dirty = true;
  }

  private choose(): void {
    this.city.update(this.eye.camera, this.renderer.domElement.height, this.plain ? MOST_PLAIN : MOST);
    this.movement?.from(this.eye.camera);
    this.stale = false;
    this.dirty = true;
  }

  private refresh(): void {
    this.stale = this.dirty = true;
    if (!this.city.pending || !this.plain) this.renderer.shadowMap.needsUpdate = true;
    this.tellPlace();
  }

  private light(): void {
    const [west, south, east, north] = this.told.extent;
    const focus = new Vector3((west + east) / 2, 0, -(south + north) / 2);
    const reach = Math.min(Math.hypot(east - west, north - south) / 2, 700);
    this.sky.light(this.renderer, this.told.environment, focus, reach, this.city.coloring === 'natural');
    this.renderer.shadowMap.needsUpdate = true;
    this.dirty = true;
  }

  private resize(): void {
    this.renderer.setPixelRatio(this.plain ? SOFT : Math.min(devicePixelRatio, 2)); // see `sharpen`
    this.renderer.setSize(innerWidth, innerHeight, false);
    this.eye.camera.aspect = innerWidth / innerHeight;
    this.eye.camera.updateProjectionMatrix();
    this.stale = this.dirty = true;
  }

  private groundUnder(from: Vector3): number | null {
    const caster = this.eye.ray(0, 0);
    caster.ray.origin.set(from.x, from.y + 0.5, from.z);
    caster.ray.direction.set(0, -1, 0);
    return this.city.raycast(caster.ray)?.point.y ?? null;
  }

  private tellPlace(): void {
    const { x, y, z } = this.eye.position;
    const { latitude, longitude } = this.told.frame;
    const north = latitude - z / 111_320;
    const east = longitude + x / (111_320 * Math.cos((latitude * Math.PI) / 180));
    const missing = this.city.missing.size ? `${this.city.missing.size} parts missing · ` : '';
    const loading = missing + (this.city.pending ? `loading ${this.city.pending} · ` : '');
    byId('where').textContent =
      `${loading}${north.toFixed(5)}, ${east.toFixed(5)} · x ${x.toFixed(1)} y ${(-z).toFixed(1)} z ${y.toFixed(1)} m`;
  }

  // Picking

  /** What lies under a place on the page. */
  pick(x: number, y: number): (Hit & { kind?: string }) | null {
    if (this.stale) this.choose();
    const { ray } = this.eye.ray(x, y);
    const hit = this.city.raycast(ray);
    const mover = this.simulation ? null : this.movement?.raycast(ray, hit?.distance ?? Infinity);
    if (mover) return { ...mover, owner: '', layer: mover.kind, prototype: mover.look };
    return hit;
  }

  private async click(x: number, y: number): Promise<void> {
    const hit = this.pick(x, y);
    if (this.sketch.drawing) {
      if (hit) this.sketch.add(hit.point);
      return;
    }
    if (this.measuring) {
      if (hit) this.addMeasure(hit.point);
      return;
    }
    if (!hit?.id) {
      this.deselect();
      return;
    }
    await this.tell(hit.id, hit);
  }

  private async tell(id: string, row: { layer: string; prototype: string; owner: string }): Promise<void> {
    this.selected = id;
    this.marks.set('selected', this.outlines(id));
    this.dirty = true;
    this.panels.object(id, row, null, 'asking ...');
    let told: Details | null = null;
    let why = '';
    try {
      told = await this.source.details(id);
    } catch (error) {
      why = error instanceof Error ? error.message : String(error);
    }
    if (this.selected === id) this.panels.object(id, row, told, why);
  }

  /** The thing that is selected, if it lies under a place on the page and can be dragged. */
  private grab(x: number, y: number, broad = 0): { id: string; point: Vector3 } | null {
    if (!this.panels.live || !this.selected || this.sketch.drawing || this.measuring) return null;
    const around = broad ? [0, 1, 2, 3, 4, 5, 6, 7].map((side) => (side * Math.PI) / 4) : [];
    const places = [[x, y], ...around.map((turn) => [x + broad * Math.cos(turn), y + broad * Math.sin(turn)])];
    for (const [east = x, south = y] of places) {
      const hit = this.pick(east, south);
      const own = hit && (hit.id === this.selected || hit.owner === this.selected);
      // Streets and land are edited otherwise: a drag that begins on them moves the camera.
      if (own && (hit.prototype || hit.layer === 'buildings')) return { id: this.selected, point: hit.point };
    }
    return null;
  }

  private outlines(id: string): Mesh[] {
    const found = this.city.outlines(new Set([id]));
    return found.length ? found : this.movement?.outline(id) ?? [];
  }

  /** Have an object moved; why it cannot be is said where one looks. */
  async moveBy(id: string, east: number, north: number): Promise<void> {
    const reply = await this.act(`move ${id}: ${wayText(east, north)}`, 'edit/move-v1', { objects: [id], offset: [east, north] });
    if (reply && reply.status !== 'ok') this.notice(`It stays where it was: ${reply.message}`, 8000);
    if (this.selected === id) this.marks.set('selected', this.outlines(id));
    this.dirty = true;
  }

  private deselect(): void {
    this.sketch.stop();
    this.selected = '';
    this.marks.clear('selected');
    this.marks.clear('found');
    if (this.panels.open === 'object') this.panels.close();
    this.dirty = true;
  }

  private addMeasure(point: Vector3): void {
    if (this.measured.length === 2) this.measured = [];
    this.measured.push(point);
    this.marks.way('measured', this.measured);
    this.dirty = true;
    const [one, two] = this.measured;
    if (!one || !two) {
      this.notice('Click where the measure ends.', 4000);
      return;
    }
    const flat = Math.hypot(two.x - one.x, two.z - one.z);
    this.notice(`${one.distanceTo(two).toFixed(2)} m, ${flat.toFixed(2)} m in plan, ${(two.y - one.y).toFixed(2)} m up`, 12_000);
  }

  // News and changes

  private heard(news: News): void {
    const told = `${news.revision} ${news.folder.join(' ')}`;
    if (told === this.news) return;
    this.news = told;
    this.shown = this.shown.then(() => this.renew()).catch(() => {});
  }

  /** Load what is other than before; what changed is marked. */
  private async renew(): Promise<void> {
    const before = this.told;
    const told = await this.source.scene();
    this.told = told;
    if (told.hash === before.hash) return;
    const known = this.city.ids();
    if (JSON.stringify(told.environment) !== JSON.stringify(before.environment)) this.sky.air = airOf(told.environment);
    if (told.movement !== before.movement && this.movement) {
      this.scene.remove(this.movement.group);
      this.movement = null;
      byId('time').hidden = true;
    }
    this.marks.clear('selected');
    this.renewing = performance.now();
    const news = await this.load().finally(() => (this.renewing = -Infinity));
    if (this.city.coloring === 'provenance') this.askProvenance();
    this.seen = { hash: told.hash, came: news?.came ?? [], at: performance.now() };
    const fresh = [...this.city.ids()].filter((id) => !known.has(id));
    if (fresh.length && fresh.length <= MOST_MARKED) this.mark(new Set(fresh));
  }

  /** Milliseconds from the call of the page to its first picture of the city, and to the whole of it. */
  readonly reached: Record<string, number> = {};

  private reach(state: 'shown' | 'ready'): void {
    if (document.body.dataset['state'] === 'ready' || this.reached[state]) return;
    document.body.dataset['state'] = state;
    this.reached[state] = performance.now();
  }

  /** What the last change brought, for tests and benchmarks. */
  seen: { hash: string; came: string[]; at: number } = { hash: '', came: [], at: 0 };

  private mark(ids: Set<string>): void {
    if (!ids.size || ids.size > MOST_MARKED) return;
    this.marks.set('changed', this.city.outlines(ids));
    this.dirty = true;
    setTimeout(() => {
      this.marks.clear('changed');
      this.dirty = true;
    }, CHANGED_MS);
  }

  /** Carry a sentence out and tell how it went; what is drawn goes with a sentence that speaks of it. */
  async change(text: string): Promise<Reply | null> {
    const drawn = this.sketch.spokenOf(text);
    if (drawn === null) {
      this.notice('Draw a path or an area first, so that it is known what "this" is.', 6000);
      return null;
    }
    const reply = await this.carryOut(text, 'run_brief', { text, ...(drawn ? { drawn } : {}) });
    if (!reply) byId<HTMLInputElement>('sentence').value = text;
    if (drawn && reply?.status === 'ok') this.sketch.clear();
    return reply;
  }

  /** Run one action on the city, through the same gate as sentences. */
  act(told: string, name: string, args: Record<string, unknown>): Promise<Reply | null> {
    return this.carryOut(told, 'action_call', { name, args });
  }

  private async carryOut(told: string, tool: string, given: Record<string, unknown>): Promise<Reply | null> {
    this.say(`› ${told}`);
    const line = this.say('…', 'soft');
    this.busy(true);
    try {
      const reply = await this.source.call(tool, given, (said, job) => {
        this.job = job;
        line.textContent = said;
      });
      const warnings = reply.warnings.map((warning) => warning.replace(/ changed, \d+ are named; scene_diff.*/, ' changed.'));
      line.textContent = [reply.message, ...warnings].join('\n');
      line.className = reply.status === 'ok' ? 'good' : 'bad';
      if (reply.status === 'ok') {
        await this.shown;
        this.mark(new Set(reply.changed.filter((id) => /^[0-9a-f]{16}$/.test(id))));
      } else if (reply.code === 'CLARIFY') {
        const ids = new Set(reply.message.match(/\b[0-9a-f]{16}\b/g) ?? []);
        if (ids.size) this.marks.set('found', this.city.outlines(ids));
        this.dirty = true;
      }
      return reply;
    } catch (error) {
      line.textContent = `${error instanceof Error ? error.message : error} Nothing was lost.${tool === 'run_brief' ? ' The sentence is in the box again.' : ''}`;
      line.className = 'bad';
      return null;
    } finally {
      this.busy(false);
    }
  }

  private busy(on: boolean): void {
    byId('cancel').hidden = !on;
    for (const id of ['send', 'undo', 'redo']) byId<HTMLButtonElement>(id).disabled = on;
  }

  private say(text: string, kind = ''): HTMLParagraphElement {
    const box = byId('said');
    const line = el('p', { class: kind }, text);
    box.append(line);
    byId('hush').hidden = false;
    while (box.children.length > 12) box.firstChild?.remove();
    box.scrollTop = box.scrollHeight;
    return line;
  }

  notice(text: string, ms = 0): void {
    const box = byId('notice');
    box.textContent = text;
    box.hidden = !text;
    if (ms) setTimeout(() => box.textContent === text && (box.hidden = true), ms);
  }

  // Choices

  private acts(): Acts {
    return {
      flyTo: (id, place) => void this.flyTo(id, place),
      select: (id) => void this.flyTo(id).then(() => this.tell(id, { layer: '', prototype: '', owner: '' })),
      change: (text) => void this.change(text),
      remove: (id) => void this.change(`remove ${id}`).then((reply) => reply?.status === 'ok' && this.deselect()),
      move: (id, east, north) => void this.moveBy(id, east, north),
      recolor: (id, color) => void this.act(`recolour ${id}`, 'edit/recolor-v1', { objects: [id], color: parseInt(color.slice(1), 16) }),
      setHidden: (layer, hidden) => this.city.setHidden(layer, hidden),
      setColoring: (coloring) => {
        this.city.setColoring(coloring);
        this.light();
        if (coloring === 'provenance') this.askProvenance();
      },
      setAir: (air) => {
        this.sky.air = air;
        this.light();
      },
      keepAir: ({ cloud, visibility, wetness, snow, rain, snowfall }) =>
        void this.act('keep this weather', 'background/conditions-v1', { cloud, visibility, wetness, snow_cover: snow, rain, snowfall }),
      setCut: (height) => {
        this.cut = height === null ? null : new Plane(new Vector3(0, -1, 0), height);
        this.renderer.clippingPlanes = this.cut ? [this.cut] : [];
        this.dirty = true;
      },
      measure: (on) => {
        this.measuring = on;
        this.measured = [];
        this.marks.way('measured', []);
        this.dirty = true;
        this.notice(on ? 'Click where the measure begins.' : '', 4000);
      },
      isMeasuring: () => this.measuring,
      download: (what) => void this.download(what),
      places: (ids) => this.source.places(ids),
    };
  }

  private askProvenance(): void {
    this.source.provenance().then((told) => this.city.setProvenance(told),
      (error: unknown) => this.notice(`It is not known where objects are from: ${String(error)}`, 8000));
  }

  async flyTo(id: string, place?: [number, number] | null): Promise<void> {
    this.selected = id;
    const meshes = this.city.outlines(new Set([id]));
    this.marks.set('selected', meshes);
    const spot = spotOf(meshes) ?? this.city.rows.placeOf(id);
    if (spot) {
      this.eye.goTo(spot, 70);
      return;
    }
    const known = place ?? (await this.source.places([id]).catch(() => ({}) as Record<string, [number, number]>))[id];
    if (known) this.eye.goTo(new Vector3(known[0], this.middle(), -known[1]), 80);
    else this.notice(`It is not known where ${id} is.`, 5000);
  }

  async find(text: string): Promise<void> {
    try {
      const answer = await this.source.find(text);
      this.panels.found(text, answer.total, answer.objects, answer.message ?? '', answer.candidates ?? []);
      this.marks.set('found', this.city.outlines(new Set(answer.objects.map((item) => item.id))));
      this.dirty = true;
      const [first] = answer.objects;
      if (first && answer.total === 1) await this.flyTo(first.id, first.place ?? null);
    } catch (error) {
      this.panels.found(text, 0, [], error instanceof Error ? error.message : String(error), []);
    }
  }

  private async download(what: 'glb' | 'geojson' | 'picture' | 'camera' | 'tour'): Promise<void> {
    const name = (this.told.name || 'city').replace(/[^\w-]+/g, '_');
    const { width, height } = this.renderer.domElement;
    if (what === 'picture') save(`${name}.png`, await this.picture());
    if (what === 'camera') save(`${name}_camera.json`, new Blob([JSON.stringify(this.eye.record('page', width, height), null, 1)]));
    if (what === 'tour') await this.tour(name);
    if (what === 'geojson') await this.geojson(name);
    if (what === 'glb') {
      const meshes = this.selected ? this.city.outlines(new Set([this.selected])) : [];
      const root = meshes.length ? meshes : exported([this.city.group], this.city.paints);
      const data = (await new GLTFExporter().parseAsync(root, { binary: true, onlyVisible: true })) as ArrayBuffer;
      save(`${name}${meshes.length ? `_${this.selected}` : ''}.glb`, new Blob([data], { type: 'model/gltf-binary' }));
    }
  }

  private picture(): Promise<Blob> {
    this.choose();
    this.draw();
    return new Promise((done, failed) =>
      this.renderer.domElement.toBlob((blob) => (blob ? done(blob) : failed(new Error('no picture'))), 'image/png'));
  }

  /** Save pictures of one turn round the point that is looked at. */
  private async tour(name: string): Promise<void> {
    const aim = this.eye.controls.target.clone();
    const off = this.eye.position.clone().sub(aim);
    for (let at = 0; at < 24; at++) {
      this.eye.camera.position.copy(aim).add(off.clone().applyAxisAngle(new Vector3(0, 1, 0), (at / 24) * 2 * Math.PI));
      this.eye.controls.update();
      save(`${name}_${String(at).padStart(2, '0')}.png`, await this.picture());
    }
  }

  /** Save the map, or of it what is selected; a thing that is on no map is a point. */
  private async geojson(name: string): Promise<void> {
    let record: GeoJson;
    try {
      record = await this.source.layout();
      if (this.selected) {
        const held = record.features.filter((feature) => feature.id === this.selected);
        record.features = held.length ? held : [await this.pointOf(this.selected)];
      }
    } catch (error) {
      this.notice(`There is no GeoJSON to be had: ${error instanceof Error ? error.message : error}`, 8000);
      return;
    }
    const file = this.selected ? `${name}_${this.selected}` : name;
    save(`${file}.geojson`, new Blob([JSON.stringify(record, null, 1)], { type: 'application/geo+json' }));
  }

  private async pointOf(id: string): Promise<GeoJson['features'][number]> {
    const told = await this.source.details(id);
    const { latitude, longitude } = this.told.frame;
    const [east, north] = told.place ?? [0, 0];
    const point = [longitude + east / (111_320 * Math.cos((latitude * Math.PI) / 180)), latitude + north / 111_320];
    return { type: 'Feature', id, geometry: { type: 'Point', coordinates: point }, properties: told };
  }

  private async report(): Promise<void> {
    const report: Report = await this.source.report().catch(() => ({}));
    this.panels.report(report);
  }

  // The bar, the boxes and the mouse

  private controls(): void {
    const ways = byId('ways');
    for (const way of ['orbit', 'walk', 'fly'] as Way[]) {
      ways.append(el('button', { type: 'button', 'aria-pressed': String(way === 'orbit'), click: (event) => {
        for (const each of ways.children) if (each.hasAttribute('aria-pressed')) each.setAttribute('aria-pressed', 'false');
        (event.currentTarget as HTMLElement).setAttribute('aria-pressed', 'true');
        this.eye.setWay(way);
        this.renderer.domElement.focus();
      } }, words(way[0]?.toUpperCase() + way.slice(1))));
    }
    ways.append(
      el('button', { type: 'button', click: () => this.eye.plan(this.told.extent) }, 'Plan'),
      el('button', { type: 'button', click: () => this.eye.overview(this.told.extent, this.middle()) }, 'Whole'),
    );
    const tool = (text: string, click: () => void): HTMLButtonElement => el('button', { type: 'button', click }, text);
    byId('tools').append(
      tool('Layers', () => this.panels.layers(this.city.layers(), this.city.hidden, this.city.coloring)),
      tool('Light', () => this.panels.light(this.sky.air)),
      tool('Report', () => void this.report()),
      tool('More', () => this.panels.more(this.told, [
        ['chunks', String(this.city.chunks.size)], ['instances drawn', this.city.rows.drawn.toLocaleString()],
        ['draw calls', String(this.renderer.info.render.calls)],
        ['triangles', this.renderer.info.render.triangles.toLocaleString()],
        ['frame', `${this.frameMs.toFixed(0)} ms`],
      ])),
    );
    byId('search').addEventListener('submit', (event) => {
      event.preventDefault();
      const text = byId<HTMLInputElement>('wanted').value.trim();
      if (text) void this.find(text);
    });
    const sentence = byId<HTMLInputElement>('sentence');
    byId('edit').addEventListener('submit', (event) => {
      event.preventDefault();
      const text = sentence.value.trim();
      if (!text) return;
      sentence.value = '';
      void this.change(text);
    });
    byId('hush').addEventListener('click', () => {
      byId('said').replaceChildren();
      byId('hush').hidden = true;
    });
    byId('undo').addEventListener('click', () => void this.change('undo'));
    byId('redo').addEventListener('click', () => void this.change('redo'));
    byId('cancel').addEventListener('click', () => void this.source.call('job_cancel', { job_id: this.job }));
    byId('play').addEventListener('click', () => {
      this.playing = !this.playing;
      byId('play').textContent = this.playing ? '❚❚' : '▶';
    });
    byId('moment').addEventListener('input', (event) => this.setMoment(Number((event.target as HTMLInputElement).value)));
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape' && !this.dragging.letGo()) this.deselect();
    });
    this.pointing();
  }

  private pointing(): void {
    const canvas = this.renderer.domElement;
    const tip = byId('tip');
    let waits = 0;
    canvas.addEventListener('pointerdown', (event) => {
      // A second finger turns, comes nearer or lets go: what either of them ends with is no click.
      this.down = event.isPrimary ? { x: event.clientX, y: event.clientY } : { x: Infinity, y: Infinity };
      canvas.focus({ preventScroll: true });
    });
    canvas.addEventListener('pointerup', (event) => {
      const far = Math.hypot(event.clientX - this.down.x, event.clientY - this.down.y) > 5;
      if (!far && event.button === 0) void this.click(event.clientX, event.clientY);
    });
    canvas.addEventListener('pointerleave', () => (tip.hidden = true));
    canvas.addEventListener('pointermove', (event) => {
      clearTimeout(waits);
      tip.hidden = true;
      if (event.buttons || event.pointerType === 'touch') return;
      waits = setTimeout(() => {
        const hit = this.pick(event.clientX, event.clientY);
        canvas.classList.toggle('draggable', this.grab(event.clientX, event.clientY) !== null);
        if (!hit?.id) return;
        tip.replaceChildren(words(hit.prototype || hit.layer), ' ', el('span', { class: 'mono soft' }, hit.id.slice(0, 8)));
        tip.style.left = `${Math.min(event.clientX + 14, innerWidth - 200)}px`;
        tip.style.top = `${event.clientY + 14}px`;
        tip.hidden = false;
      }, HOVER_MS);
    });
  }
}

function spotOf(meshes: Mesh[]): Vector3 | null {
  const spot = new Vector3();
  let count = 0;
  for (const mesh of meshes) {
    mesh.geometry.computeBoundingBox();
    const index = mesh.geometry.index;
    const place = mesh.geometry.getAttribute('position');
    if (!index) continue;
    const point = new Vector3();
    for (let at = 0; at < index.count; at += Math.max(1, Math.floor(index.count / 60))) {
      spot.add(point.fromBufferAttribute(place, index.getX(at)).applyMatrix4(mesh.matrix));
      count++;
    }
  }
  return count ? spot.divideScalar(count) : null;
}

/** Whether the machine draws without a graphics card; ?look=plain or ?look=full says otherwise. */
function isSoftware(): boolean {
  const asked = new URLSearchParams(location.search).get('look');
  if (asked) return asked === 'plain';
  const context = document.createElement('canvas').getContext('webgl2');
  const told = context?.getExtension('WEBGL_debug_renderer_info');
  const name = context && told ? String(context.getParameter(told.UNMASKED_RENDERER_WEBGL)) : '';
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

const page = new Page();
Object.assign(window, { cityx: page, clockOf });
void page.start();
