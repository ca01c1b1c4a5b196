/** What the server, or a static site, tells of a city. */

export interface Environment {
  sun_elevation: number;
  sun_azimuth: number;
  hour: number;
  day: number;
  weather: string;
  cloud_cover: number;
  visibility: number;
  wetness: number;
  snow: number;
  rain: number;
  snowfall: number;
  wind: number;
  wind_from: number;
  night_lights: number;
  work_lights: number;
  shop_lights: number;
  lamps: number;
}

export interface ChunkInfo {
  name: string;
  group: string;
  cell: [number, number];
  /** West, south, bottom, east, north, top; metres, z up. */
  box: [number, number, number, number, number, number];
  triangles: number;
  layers: string[];
}

export interface PackInfo {
  name: string;
  kind: string;
  beyond: number;
}

export interface SceneInfo {
  version: number;
  live: boolean;
  revision: number;
  /** By which a page goes on with the next server of the folder. */
  secret?: string;
  /** Whether a simulation runs, and nothing can be changed. */
  simulated?: boolean;
  hash: string;
  name: string;
  lod: number;
  seed: number;
  frame: { latitude: number; longitude: number; projection: string };
  extent: [number, number, number, number];
  attribution: string[];
  environment: Environment;
  moment: number;
  movement: string;
  /** What traffic lights show; "" where no signal rules a pole, absent in older sites. */
  lamps?: string;
  paints: string;
  packs: PackInfo[];
  chunks: ChunkInfo[];
}

export interface FailedCheck {
  check: string;
  ok: boolean;
  value: number | string;
  limit: number;
  bound: string;
  meaning: string;
}

export interface Details {
  id: string;
  kind: string;
  name: string;
  layers: string[];
  owner: string;
  owns: Record<string, number>;
  facts: Record<string, unknown>;
  tags: Record<string, string>;
  source: string;
  licence: string;
  generator: string;
  made_by: { action: string; args: Record<string, unknown> }[];
  failures: { action: string; error: string }[];
  checks: FailedCheck[];
  place?: [number, number] | null;
}

export interface Found {
  id: string;
  name: string;
  layer: string;
  kind: string;
  place?: [number, number] | null;
}

export interface Answer {
  how: string;
  total: number;
  objects: Found[];
  message?: string;
  candidates?: string[];
}

export interface Report {
  checks?: Record<string, FailedCheck & { ids?: string[] }>;
  goals?: { goal: string; met: boolean | null; evidence: string }[];
  failures?: { id: string; action: string; error: string }[];
  counts?: Record<string, number>;
  notes?: string[];
}

export interface Reply {
  status: 'ok' | 'rejected' | 'failed' | 'accepted';
  code: string;
  message: string;
  state_rev: number;
  changed: string[];
  warnings: string[];
  job_id: string;
  data: Record<string, unknown>;
}

/** What a simulation is like after a step. */
export interface Running {
  task: string;
  episode: number;
  time: number;
  /** Of the signals, seconds. */
  clock: number;
  paused: boolean;
  done: boolean;
  speed: number;
  agents: number;
  /** Kind; x, y, z; heading; length, width, height, metres a second. */
  movers: [string, number, number, number, number, number, number, number, number][];
  route: [number, number][];
  completion: number;
  reward: number;
  rays: { height: number; metres: number[] };
  events: Happened[];
}

export interface Happened {
  number: number;
  time: number;
  episode: number;
  event: string;
  object: string;
  place: [number, number];
  over: boolean;
}

/** Where objects are from: a map, a rule, an edit, a library. */
export interface Provenance {
  origins: string[];
  ids: Record<string, string[]>;
  layers: Record<string, number>;
}

export interface GeoJson {
  type: 'FeatureCollection';
  features: { type: 'Feature'; id: string; geometry: unknown; properties: unknown }[];
  attribution: string[];
}

/** A path, or the edge of an area, that a sentence speaks of; metres east and north. */
export interface Drawn {
  points: [number, number][];
  area: boolean;
}

export interface News {
  revision: number;
  folder: number[];
  busy: boolean;
}
