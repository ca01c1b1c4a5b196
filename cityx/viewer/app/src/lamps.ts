/** Traffic lights: what each pole shows at a moment, by the signal plan of the city. */

export interface LampsFile {
  /** Seconds of a cycle, of its changes, and the number of a state from each on. */
  heads: { cycle: number; times: number[]; states: number[] }[];
  /** By id of a pole: the heads that it shows to vehicles, and the one that it shows to people or -1. */
  poles: Record<string, [number[], number]>;
}

/** To vehicles one more than a state of `cityx.city.signals`, to people 1 for waiting, 2 for walking; 0 if not known. */
export type Lit = [number, number];

const RED = 1;
const [GREEN, YIELDING] = [4, 5];
// What is shown, from little to much: off, red, red and yellow, yellow, green; green that yields before green.
const RANK = [0, 1, 2, 3, 5, 4];

export class Lamps {
  /** What poles show by their ids. */
  lit = new Map<string, Lit>();
  private last = '';

  constructor(private readonly file: LampsFile) {}

  /** Show a moment, seconds since the tracks begin; whether any lamp is other than before. */
  at(moment: number): boolean {
    const states = this.file.heads.map(({ cycle, times, states: own }) => {
      const within = moment - Math.floor(moment / cycle) * cycle + 1e-9;
      return own[times.filter((time) => time <= within).length - 1] ?? 0;
    });
    const told = states.join();
    if (told === this.last) return false;
    this.last = told;
    for (const [id, [heads, walk]] of Object.entries(this.file.poles)) {
      const shown = heads.map((head) => states[head] ?? 0).reduce((most, each) => (rank(each) > rank(most) ? each : most), -1);
      const go = states[walk] === GREEN || states[walk] === YIELDING;
      const walks = walk < 0 ? shown === RED : go; // crossings without a head are walked while nobody drives
      this.lit.set(id, [shown + 1, walk < 0 && shown < 0 ? 0 : walks ? 2 : 1]);
    }
    return true;
  }
}

const rank = (state: number): number => RANK[state] ?? -1;
