/** Where the city comes from: a server with a token, or the files of a static site. */

import type { LampsFile } from './lamps';
import type { Answer, Details, Found, GeoJson, News, Provenance, Reply, Report, Running, SceneInfo } from './types';

const NAMES_ALONE =
  'Nothing has this name. A static site finds names, ids and addresses; words such as "buildings over 30 m" need cityx view.';

export class Refused extends Error {}

const OTHER = 'Another program answers where the city was; open the address that cityx view printed last.';
const hex = (byte: number): string => byte.toString(16).padStart(2, '0');
const WAIT_MS = 1500; // before a server that is gone is asked again

export class Source {
  /** Bytes that came over the wire, by the name of the file. */
  readonly sizes = new Map<string, number>();
  live = true;
  private token: string;
  /** Held in memory alone: see `cityx.viewer.resuming`. */
  private secret = '';
  /** Whether the server was gone, so that another may answer in its place. */
  private lost = false;
  private readonly key = `cityx token of ${location.host}`;
  private names: [string, string, string, string, [number, number] | null][] | null = null;

  constructor() {
    const given = new URLSearchParams(location.hash.slice(1)).get('token');
    if (given) {
      sessionStorage.setItem(this.key, given);
      history.replaceState(null, '', location.pathname + location.search);
    }
    this.token = given ?? sessionStorage.getItem(this.key) ?? '';
  }

  async scene(): Promise<SceneInfo> {
    const scene = (await (await this.ask('scene.json')).json()) as SceneInfo;
    this.live = scene.live;
    this.secret = scene.secret ?? '';
    return scene;
  }

  async bytes(name: string, signal?: AbortSignal): Promise<ArrayBuffer> {
    const answer = await this.ask(name, signal ? { signal } : {});
    const data = await answer.arrayBuffer();
    this.sizes.set(name, data.byteLength);
    return data;
  }

  async lamps(name: string): Promise<LampsFile> {
    return (await (await this.ask(`lamps/${name}.json`)).json()) as LampsFile;
  }

  async report(): Promise<Report> {
    return (await (await this.ask('report.json')).json()) as Report;
  }

  async provenance(): Promise<Provenance> {
    return (await (await this.ask('provenance.json')).json()) as Provenance;
  }

  /** The map of the city. */
  async layout(): Promise<GeoJson> {
    return (await (await this.ask('layout.geojson')).json()) as GeoJson;
  }

  async details(id: string): Promise<Details> {
    if (this.live) return (await (await this.ask(`objects/${id}`)).json()) as Details;
    const held = (await (await this.ask(`objects/${id.slice(0, 2)}.json`)).json()) as Record<string, Details>;
    const found = held[id];
    if (!found) throw new Refused('Nothing more is known of it.');
    return found;
  }

  async find(text: string): Promise<Answer> {
    if (this.live) return (await (await this.ask(`find?text=${encodeURIComponent(text)}`)).json()) as Answer;
    this.names ??= (await (await this.ask('names.json')).json()) as NonNullable<typeof this.names>;
    const wanted = text.trim().toLowerCase();
    const objects: Found[] = [];
    for (const [id, name, layer, kind, place] of this.names) {
      if (id === wanted || name.toLowerCase().includes(wanted)) objects.push({ id, name, layer, kind, place });
    }
    const message = objects.length ? {} : { message: NAMES_ALONE };
    return { how: 'name', total: objects.length, objects: objects.slice(0, 200), ...message };
  }

  async places(ids: string[]): Promise<Record<string, [number, number]>> {
    if (this.live) {
      const asked = encodeURIComponent(ids.slice(0, 300).join(','));
      return (await (await this.ask(`places?ids=${asked}`)).json()) as Record<string, [number, number]>;
    }
    const found: Record<string, [number, number]> = {};
    for (const id of ids.slice(0, 50)) {
      const place = (await this.details(id).catch(() => null))?.place;
      if (place) found[id] = place;
    }
    return found;
  }

  /** Call a tool and wait for its job, telling each line of progress. */
  async call(
    tool: string,
    given: Record<string, unknown>,
    said: (line: string, job: string) => void = () => {},
  ): Promise<Reply> {
    let reply = await this.post(tool, given);
    while (reply.status === 'accepted') {
      said(reply.message, reply.job_id);
      reply = await this.post('job_wait', { job_id: reply.job_id, seconds: 2 });
    }
    return reply;
  }

  private async post(tool: string, given: Record<string, unknown>): Promise<Reply> {
    const body = JSON.stringify(given);
    return (await (await this.ask(`tools/${tool}`, { method: 'POST', body })).json()) as Reply;
  }

  /** Listen for news until the page goes; a server that is gone is asked again. */
  listen(heard: (news: News) => void, state: (there: boolean, why: string) => void): Promise<void> {
    return this.stream('events', heard, state);
  }

  /** Look on at a simulation. */
  watch(seen: (running: Running) => void): Promise<void> {
    return this.stream('simulation', seen, () => {});
  }

  async steer(how: { paused?: boolean; speed?: number }): Promise<void> {
    await this.ask('simulation', { method: 'POST', body: JSON.stringify(how) });
  }

  private async stream<T>(
    name: string, heard: (news: T) => void, state: (there: boolean, why: string) => void,
  ): Promise<void> {
    for (;;) {
      try {
        const answer = await this.ask(name);
        state(true, '');
        const reader = answer.body?.pipeThrough(new TextDecoderStream()).getReader();
        let text = '';
        for (;;) {
          const part = await reader?.read();
          if (!part || part.done) break;
          text += part.value;
          const items = text.split('\n\n');
          text = items.pop() ?? '';
          for (const item of items) {
            if (item.startsWith('data: ')) heard(JSON.parse(item.slice(6)) as T);
          }
        }
        this.lost = true;
        state(false, 'The server is gone; the page waits for it.');
      } catch (error) {
        const refused = error instanceof Refused;
        state(false, refused ? error.message : 'The server is gone; the page waits for it.');
      }
      await new Promise((done) => setTimeout(done, WAIT_MS));
    }
  }

  /** What a request for the city carries. */
  headers(): Record<string, string> {
    return this.token ? { Authorization: `Bearer ${this.token}` } : {};
  }

  /** Go on with a server that proves that it is the next one of the folder, with its token. */
  private async resume(): Promise<void> {
    const nonce = Array.from(crypto.getRandomValues(new Uint8Array(24)), hex).join('');
    let told: { proof: string; challenge: string };
    try {
      told = (await (await fetch(`prove?nonce=${nonce}`)).json()) as typeof told;
    } catch {
      throw new Error('The server does not answer.');
    }
    if (told.proof !== (await this.proof('server', nonce))) throw new Refused(OTHER);
    const body = JSON.stringify({ challenge: told.challenge, proof: await this.proof('page', told.challenge) });
    const answer = await fetch('resume', { method: 'POST', body });
    if (!answer.ok) throw new Refused(OTHER);
    this.token = ((await answer.json()) as { token: string }).token;
    sessionStorage.setItem(this.key, this.token);
    this.lost = false;
  }

  private async proof(who: string, nonce: string): Promise<string> {
    const bytes = new TextEncoder();
    const how = { name: 'HMAC', hash: 'SHA-256' };
    const key = await crypto.subtle.importKey('raw', bytes.encode(this.secret), how, false, ['sign']);
    const signed = await crypto.subtle.sign('HMAC', key, bytes.encode(`${who} ${nonce}`));
    return Array.from(new Uint8Array(signed), hex).join('');
  }

  async ask(name: string, how: RequestInit = {}): Promise<Response> {
    if (this.lost && this.secret) await this.resume();
    const headers = this.headers();
    let answer: Response;
    try {
      answer = await fetch(name, { ...how, headers });
    } catch (error) {
      if (error instanceof DOMException) throw error;
      this.lost = true;
      throw new Error('The server does not answer.');
    }
    if (!answer.ok) {
      const told = (await answer.json().catch(() => null)) as Reply | null;
      throw new Refused(told?.message ?? `${name}: the server answers ${answer.status}.`);
    }
    return answer;
  }
}
