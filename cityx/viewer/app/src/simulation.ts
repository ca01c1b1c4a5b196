/** A simulation that runs on the server: who moves, the route, the rays of the agent, and what happens. */

import {
  BufferGeometry, Color, Float32BufferAttribute, Group, InstancedMesh, Line, LineBasicMaterial, LineSegments, Matrix4,
  MeshLambertMaterial, Quaternion, Vector3,
} from 'three';
import { byId, el, link, words } from './dom';
import { shapeOf } from './movement';
import type { Source } from './source';
import type { Happened, Running } from './types';

export interface Shown {
  drawn(): void;
  follow(from: Vector3 | null, to: Vector3): void;
  goTo(id: string, place: [number, number]): void;
}

const MOST = 600; // movers
const MOST_EVENTS = 40;
const UP = new Vector3(0, 1, 0);
const COLORS: Record<string, Color> = { agent: new Color(0xff3b20), person: new Color(0x3b7dff), vehicle: new Color(0xffc233) };

export class Simulation {
  readonly group = new Group();
  /** Of the last step that came. */
  last: Running | null = null;
  private readonly bodies: Record<string, InstancedMesh>;
  private readonly route: Line;
  private readonly rays: LineSegments;
  private readonly matrix = new Matrix4();
  private readonly turn = new Quaternion();
  private at: Vector3 | null = null;
  private following = true;
  private heard = 0;

  constructor(private readonly source: Source, private readonly shown: Shown) {
    this.bodies = Object.fromEntries(Object.entries({ vehicle: 'car', person: 'pedestrian' }).map(([name, kind]) => {
      const made = new InstancedMesh(shapeOf(kind), new MeshLambertMaterial(), MOST);
      made.frustumCulled = false;
      made.count = 0;
      this.group.add(made);
      return [name, made];
    }));
    const line = (color: number, opacity = 1): LineBasicMaterial =>
      new LineBasicMaterial({ color, fog: false, transparent: opacity < 1, opacity });
    this.route = new Line(new BufferGeometry(), line(0x2f9bff));
    this.rays = new LineSegments(new BufferGeometry(), line(0x39ff7a, 0.5));
    for (const each of [this.route, this.rays]) {
      each.frustumCulled = false;
      this.group.add(each);
    }
    this.controls();
    byId('running').hidden = false;
  }

  private controls(): void {
    byId('pause').addEventListener('click', () => void this.source.steer({ paused: !this.last?.paused }));
    byId('speed').addEventListener('change', (event) =>
      void this.source.steer({ speed: Number((event.target as HTMLSelectElement).value) }));
    const toggle = (id: string, take: (on: boolean) => void): void => {
      const button = byId(id);
      button.addEventListener('click', () => {
        const on = button.getAttribute('aria-pressed') !== 'true';
        button.setAttribute('aria-pressed', String(on));
        take(on);
        this.shown.drawn();
      });
    };
    toggle('follow', (on) => (this.following = on));
    toggle('sensors', (on) => (this.rays.visible = this.route.visible = on));
  }

  /** Show what a step came to. */
  show(running: Running): void {
    if (this.last && running.time < this.last.time) this.heard = 0; // another simulation
    this.last = running;
    const counts: Record<string, number> = { vehicle: 0, person: 0 };
    for (const [kind, x, y, z, heading, length, width, height] of running.movers) {
      const shape = kind === 'person' || height > 2 * length ? 'person' : 'vehicle';
      const body = this.bodies[shape];
      const row = counts[shape] ?? 0;
      if (!body || row >= MOST) continue;
      this.matrix.compose(new Vector3(x, z, -y), this.turn.setFromAxisAngle(UP, heading), new Vector3(length, height, width));
      body.setMatrixAt(row, this.matrix);
      body.setColorAt(row, COLORS[kind] ?? UNKNOWN);
      counts[shape] = row + 1;
    }
    for (const [shape, body] of Object.entries(this.bodies)) {
      body.count = counts[shape] ?? 0;
      body.instanceMatrix.needsUpdate = true;
      if (body.instanceColor) body.instanceColor.needsUpdate = true;
    }
    this.lines(running);
    const [own] = running.movers;
    if (own?.[0] === 'agent') {
      const now = new Vector3(own[1], own[3], -own[2]);
      if (this.following) this.shown.follow(this.at && this.at.distanceTo(now) < 20 ? this.at : null, now);
      this.at = now;
    }
    this.tell(running, own?.[8] ?? 0);
    this.shown.drawn();
  }

  private lines(running: Running): void {
    const [own] = running.movers;
    if (!own) return;
    const [, x, y, z, heading] = own;
    const flat = running.route.flatMap(([east, north]) => [east, z + 0.3, -north]);
    this.route.geometry.setAttribute('position', new Float32BufferAttribute(flat, 3));
    const { height, metres } = running.rays;
    const ends = metres.flatMap((reach, ray) => {
      const way = heading - (ray / metres.length) * 2 * Math.PI;
      return [x, height, -y, x + reach * Math.cos(way), height, -(y + reach * Math.sin(way))];
    });
    this.rays.geometry.setAttribute('position', new Float32BufferAttribute(ends, 3));
  }

  private tell(running: Running, speed: number): void {
    byId('told').textContent = `${running.task.replace('CityX/', '')}, episode ${running.episode}, ${running.time.toFixed(1)} s: ` +
      `${speed.toFixed(1)} m/s, ${Math.round(running.completion * 100)} % of the route` +
      (running.done ? ', ended' : running.paused ? ', paused' : '');
    byId('pause').textContent = running.done ? 'Run more' : running.paused ? 'Go on' : 'Pause';
    const list = byId('events');
    for (const event of running.events) {
      if (event.number <= this.heard) continue;
      this.heard = event.number;
      list.prepend(this.line(event));
      while (list.children.length > MOST_EVENTS) list.lastChild?.remove();
    }
  }

  private line(event: Happened): HTMLLIElement {
    const id = /^[0-9a-f]{16}$/.test(event.object) ? event.object : '';
    const good = event.event === 'goal';
    return el('li', {}, el('span', { class: 'soft' }, `${event.episode} · ${event.time.toFixed(1)} s `),
      el('span', { class: good ? 'good' : event.over ? 'bad' : '' }, words(event.event)), ' ',
      id ? link(id.slice(0, 8), () => this.shown.goTo(id, event.place)) : event.object);
  }
}

const UNKNOWN = new Color(0x888888);
