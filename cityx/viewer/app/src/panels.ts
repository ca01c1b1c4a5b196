/** The panel beside the city: an object, the report, layers, light, and what else there is to choose. */

import { byId, el, link, table, words } from './dom';
import { ORIGINS } from './city';
import type { Coloring } from './paints';
import { WEATHERS, type Air } from './sky';
import type { Details, Found, Report, SceneInfo } from './types';

export interface Acts {
  flyTo(id: string, place?: [number, number] | null): void;
  select(id: string): void;
  remove(id: string): void;
  recolor(id: string, color: string): void;
  move(id: string, east: number, north: number): void;
  change(text: string): void;
  setHidden(layer: string, hidden: boolean): void;
  setColoring(coloring: Coloring): void;
  setAir(air: Air): void;
  /** Make a weather that of the city, as an edit. */
  keepAir(air: Air): void;
  setCut(height: number | null): void;
  measure(on: boolean): void;
  isMeasuring(): boolean;
  download(what: 'glb' | 'geojson' | 'picture' | 'camera' | 'tour'): void;
  places(ids: string[]): Promise<Record<string, [number, number]>>;
}

const MOST_IDS = 40; // links of one check
const WET = 0.05; // of wetness per mm of rain an hour that is added, as `cityx.edit.air` has it
const WHITE = 0.5; // of lying snow per mm of water an hour that falls as snow

export class Panels {
  private readonly panel = byId('panel');
  private readonly content = byId('content');
  open = '';
  closed: () => void = () => {};
  /** What had the focus when a panel was opened by the keyboard. */
  private from: HTMLElement | null = null;

  constructor(private readonly acts: Acts, public live: boolean) {
    byId('close').addEventListener('click', () => this.close());
  }

  close(): void {
    this.panel.hidden = true;
    this.open = '';
    this.from?.focus();
    this.from = null;
    this.closed();
  }

  private show(name: string, ...parts: (Node | string | null)[]): void {
    const asked = document.activeElement;
    const byKey = asked instanceof HTMLElement && asked.matches('button:focus-visible, input:focus-visible');
    const opened = this.panel.hidden && byKey;
    this.open = name;
    this.panel.hidden = false;
    if (opened) {
      this.from = asked;
      byId('close').focus();
    }
    this.content.replaceChildren(...parts.filter((part): part is Node | string => part !== null));
  }

  /** Tell of an object; `row` is what the scene itself knows of it. */
  object(id: string, row: { layer: string; prototype: string; owner: string }, told: Details | null, why = ''): void {
    const title = told?.name || (told ? told.kind : words(row.prototype || row.layer));
    const parts: (Node | null)[] = [el('h2', {}, title)];
    if (told?.name) parts.push(el('p', { class: 'soft' }, told.kind));
    parts.push(el('p', { class: 'mono' }, id));
    if (row.owner) parts.push(el('p', {}, 'belongs to ', link(row.owner, () => this.acts.select(row.owner))));
    if (why) parts.push(el('p', { class: 'soft' }, why));
    if (told) parts.push(...this.known(told));
    parts.push(el('div', { class: 'row' },
      el('button', { type: 'button', click: () => this.acts.flyTo(id, told?.place ?? null) }, 'Fly there'),
      el('button', { type: 'button', click: () => void navigator.clipboard?.writeText(id) }, 'Copy id'),
    ));
    if (this.live) parts.push(this.touching(id));
    this.show('object', ...parts);
  }

  /** What can be done with an object by hand. */
  private touching(id: string): Node {
    const color = el('input', { type: 'color', value: '#b03a2e', 'aria-label': 'Colour' });
    const metres = (name: string): HTMLInputElement =>
      el('input', { type: 'number', value: '0', step: 'any', class: 'metres', 'aria-label': `Metres to the ${name}` });
    const [east, north] = [metres('east'), metres('north')];
    return el('div', { role: 'group', 'aria-label': 'Change it' },
      el('h3', {}, 'Change it'),
      el('div', { class: 'row' }, color,
        el('button', { type: 'button', click: () => this.acts.recolor(id, color.value) }, 'Recolour'),
        el('button', { type: 'button', click: () => this.acts.remove(id) }, 'Delete')),
      el('form', { class: 'row', submit: (event) => {
        event.preventDefault();
        this.acts.move(id, east.valueAsNumber || 0, north.valueAsNumber || 0);
      } }, 'East', east, 'north', north, el('button', { type: 'submit' }, 'Move, m')),
      el('p', { class: 'soft' }, 'Or drag it in the scene; Escape, or a second finger, leaves it where it was.'));
  }

  private known(told: Details): (Node | null)[] {
    const section = (name: string, rows: [string, string][]): Node[] =>
      rows.length ? [el('h3', {}, name), table(rows)] : [];
    const facts = Object.entries(told.facts).map(([key, value]): [string, string] => [words(key), plain(value)]);
    const owns = Object.entries(told.owns).map(([key, value]): [string, string] => [words(key), String(value)]);
    const made: [string, string][] = told.made_by.map(({ action, args }) => [
      action, Object.entries(args).map(([key, value]) => `${key} = ${plain(value)}`).join(', ') || 'as it is',
    ]);
    if (told.generator) made.unshift(['generator', told.generator]);
    const origin: [string, string][] = [];
    if (told.source) origin.push(['source', told.source]);
    if (told.licence) origin.push(['licence', told.licence]);
    return [
      ...told.checks.map((check) => el('p', { class: check.ok ? 'soft' : 'bad' },
        `${words(check.check)}: ${check.value}, ${check.bound} ${check.limit}. ${check.meaning}`)),
      ...told.failures.map((failure) => el('p', { class: 'bad' }, `${failure.action}: ${failure.error}`)),
      ...section('What it is', facts),
      ...section('Tags of the map', Object.entries(told.tags)),
      ...section('Where it is from', origin),
      ...section('What made it', made),
      ...section('What belongs to it', owns),
    ];
  }

  found(text: string, total: number, objects: Found[], said: string, candidates: string[]): void {
    const list = el('ul', {}, ...objects.map((item) => el('li', {},
      link(item.name || item.id, () => this.acts.flyTo(item.id, item.place ?? null)),
      ' ', el('span', { class: 'soft' }, `${words(item.kind)}`))));
    const more = candidates.map((name) => el('li', {}, link(name, () => this.acts.select(name.split(' ')[0] ?? name))));
    this.show('found',
      el('h2', {}, `"${text}"`),
      el('p', { class: 'soft' }, said || `${total} found${total > objects.length ? `, ${objects.length} listed` : ''}`),
      list, more.length ? el('ul', {}, ...more) : null);
  }

  report(report: Report): void {
    const checks = Object.entries(report.checks ?? {});
    const failed = checks.filter(([, check]) => !check.ok);
    const rows = [...failed, ...checks.filter(([, check]) => check.ok)].map(([name, check]) => {
      const row = el('li', {}, el('span', { class: check.ok ? 'good' : 'bad' }, check.ok ? '✓ ' : '✗ '),
        el('span', { title: check.meaning }, `${words(name)}: ${check.value} `),
        el('span', { class: 'soft' }, `${check.bound} ${check.limit}`));
      if (check.ids?.length) row.append(el('div', { class: 'row' }, ...this.links(check.ids)));
      return row;
    });
    const goals = (report.goals ?? []).map((goal) => el('li', {},
      el('span', { class: goal.met === false ? 'bad' : 'good' }, goal.met === false ? '✗ ' : goal.met ? '✓ ' : '? '),
      goal.goal, ' ', el('span', { class: 'soft' }, goal.evidence)));
    const failures = (report.failures ?? []).map((failure) => el('li', {},
      link(failure.action, () => this.acts.flyTo(failure.id)), ' ', el('span', { class: 'soft' }, failure.error)));
    const counts = Object.entries(report.counts ?? {}).map(([key, value]): [string, string] => [words(key), value.toLocaleString()]);
    this.show('report',
      el('h2', {}, 'Report'),
      el('p', {}, `${checks.length} checks, ${failed.length} not met.`),
      el('h3', {}, 'Asked for'), el('ul', {}, ...goals),
      failures.length ? el('h3', {}, 'Could not be built') : null, el('ul', {}, ...failures),
      el('h3', {}, 'Checks'), el('ul', {}, ...rows),
      el('h3', {}, 'Counts'), table(counts));
  }

  private links(ids: string[]): Node[] {
    const shown = ids.slice(0, MOST_IDS).map((id) => link(id.slice(0, 8), () => this.acts.flyTo(id)));
    return ids.length > shown.length ? [...shown, el('span', { class: 'soft' }, `and ${ids.length - shown.length} more`)] : shown;
  }

  layers(names: string[], hidden: Set<string>, coloring: Coloring): void {
    const colors: Coloring[] = ['natural', 'class', 'instance', 'height', 'provenance'];
    const choice = el('select', { change: (event) => {
      const chosen = (event.target as HTMLSelectElement).value as Coloring;
      byId('legend').hidden = chosen !== 'provenance';
      this.acts.setColoring(chosen);
    } },
      ...colors.map((name) => el('option', { value: name, selected: name === coloring }, name)));
    const boxes = names.map((name) => el('label', {},
      el('input', { type: 'checkbox', checked: !hidden.has(name),
        change: (event) => this.acts.setHidden(name, !(event.target as HTMLInputElement).checked) }),
      words(name)));
    const cut = el('input', { type: 'range', min: '0', max: '120', value: '120', step: '0.5',
      input: (event) => {
        const value = Number((event.target as HTMLInputElement).value);
        this.acts.setCut(value >= 120 ? null : value);
      } });
    const legend = el('p', { id: 'legend', hidden: coloring !== 'provenance' },
      ...['a map', 'a rule', 'an edit', 'a library'].flatMap((name, which) => [
        el('span', { class: 'swatch', style: `background: #${ORIGINS[which]?.getHexString() ?? ''}` }), `${name} `]));
    this.show('layers', el('h2', {}, 'Layers'), el('label', {}, 'Colours', choice), legend,
      el('label', {}, 'Cut at height', cut), ...boxes);
  }

  light(air: Air): void {
    const now = { ...air };
    const shown: (() => void)[] = []; // some numbers follow others
    const slider = (name: string, value: () => number, low: number, high: number, step: number, take: (value: number) => void): Node => {
      const told = el('output', {});
      const input = el('input', { type: 'range', min: String(low), max: String(high), step: String(step), 'aria-label': name,
        input: () => {
          take(Number(input.value));
          shown.forEach((show) => show());
          this.acts.setAir({ ...now });
        } });
      shown.push(() => {
        input.value = String(value());
        told.textContent = String(Math.round(value() * 100) / 100);
      });
      shown.at(-1)?.();
      return el('label', {}, name, told, input);
    };
    const weathers = Object.keys(WEATHERS).map((name) => el('button', { type: 'button', click: () => {
      Object.assign(now, WEATHERS[name]);
      this.acts.setAir({ ...now });
      this.light(now);
    } }, name));
    this.show('light', el('h2', {}, 'Hour and weather'),
      slider('Hour', () => now.hour, 0, 24, 0.1, (value) => (now.hour = value)),
      slider('Clouds', () => now.cloud, 0, 1, 0.05, (value) => (now.cloud = value)),
      slider('Sight, km', () => Math.min(now.visibility / 1000, 40), 0.1, 40, 0.1, (value) => (now.visibility = value * 1000)),
      slider('Rain, mm/h', () => now.rain, 0, 30, 0.5, (value) => {
        now.wetness = clamped(now.wetness + WET * (value - now.rain));
        now.rain = value;
      }),
      slider('Wetness', () => now.wetness, 0, 1, 0.05, (value) => (now.wetness = value)),
      slider('Snow, mm/h', () => now.snowfall, 0, 5, 0.1, (value) => {
        now.snow = clamped(now.snow + WHITE * (value - now.snowfall));
        now.snowfall = value;
      }),
      slider('Lying snow', () => now.snow, 0, 1, 0.05, (value) => (now.snow = value)),
      el('div', { class: 'row' }, ...weathers),
      el('p', { class: 'soft' }, 'This page alone shows it so. The same for the city:'),
      el('p', { class: 'mono' }, `cityx render DIR --time ${clockOf(now.hour)}`),
      this.live ? el('div', { class: 'row' },
        el('button', { type: 'button', click: () => this.acts.change(`set the time to ${clockOf(now.hour)}`) }, 'Keep this hour'),
        el('button', { type: 'button', click: () => this.acts.keepAir(now) }, 'Keep this weather')) : null);
  }

  more(scene: SceneInfo, told: [string, string][]): void {
    const button = (text: string, click: () => void): Node => el('button', { type: 'button', click }, text);
    const measuring = el('button', { type: 'button', 'aria-pressed': String(this.acts.isMeasuring()), click: (event) => {
      const on = !this.acts.isMeasuring();
      this.acts.measure(on);
      (event.currentTarget as HTMLElement).setAttribute('aria-pressed', String(on));
    } }, 'Measure');
    this.show('more', el('h2', {}, scene.name || 'City'),
      el('h3', {}, 'Take with you'),
      el('div', { class: 'row' }, button('Picture', () => this.acts.download('picture')),
        button('Camera file', () => this.acts.download('camera')), button('GLB', () => this.acts.download('glb')),
        button('GeoJSON', () => this.acts.download('geojson')),
        button('Tour, 24 pictures', () => this.acts.download('tour'))),
      el('p', { class: 'soft' }, 'GLB and GeoJSON are of what is selected, or of all.'),
      el('h3', {}, 'Tools'), el('div', { class: 'row' }, measuring),
      el('h3', {}, 'About'),
      table([['latitude', scene.frame.latitude.toFixed(6)], ['longitude', scene.frame.longitude.toFixed(6)],
        ['level of detail', String(scene.lod)], ['seed', String(scene.seed)], ['revision', String(scene.revision)],
        ['hash', el('span', { class: 'mono' }, scene.hash.slice(0, 16))], ...told]),
      el('h3', {}, 'Keys'),
      el('p', {}, 'W A S D or arrows move, Q and E go down and up, Shift hurries, Escape lets go of a selection.'),
      el('h3', {}, 'Licences'),
      ...scene.attribution.map((text) => el('p', {}, text)),
      el('p', {}, el('a', { href: 'licences.txt', target: '_blank', rel: 'noopener' }, 'CityX and the packages of this page')));
  }
}

function clamped(share: number): number {
  return Math.round(Math.min(Math.max(share, 0), 1) * 1000) / 1000;
}

function plain(value: unknown): string {
  if (typeof value === 'number') return String(Math.round(value * 1000) / 1000);
  if (Array.isArray(value)) return value.map(plain).join(', ');
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  return typeof value === 'string' ? value : JSON.stringify(value);
}

export function clockOf(hour: number): string {
  const minutes = Math.round(hour * 60) % 1440;
  return `${String(Math.floor(minutes / 60)).padStart(2, '0')}:${String(minutes % 60).padStart(2, '0')}`;
}
