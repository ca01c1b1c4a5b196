/** Paths and areas that are drawn on the ground, for sentences to speak of. */

import type { Vector3 } from 'three';
import { byId } from './dom';
import type { Marks } from './marks';
import type { Drawn } from './types';

// Words by which a sentence means what is drawn; those of `cityx.projects.drawn`.
const SPOKEN = new RegExp(
  String.raw`\b(along|on|beside|by|in|inside|within|into|at|around|through|across|over)\s+` +
  String.raw`((this|the drawn)\s+(path|line|way|route|curve|area|place|polygon|shape)\b|this(?=\s*($|[,.;:!?]|and\b|then\b|but\b)))`, 'i',
);
const HERE = /\bhere\b/i;
const MOST = 500; // points

export class Sketch {
  drawing: '' | 'path' | 'area' = '';
  private kind: 'path' | 'area' = 'path';
  private points: Vector3[] = [];

  constructor(
    private readonly marks: Marks, private readonly drawn: () => void, private readonly notice: (text: string, ms: number) => void,
  ) {
    for (const kind of ['path', 'area'] as const) {
      byId(kind).addEventListener('click', () => (this.drawing === kind ? this.stop() : this.begin(kind)));
    }
    byId('undraw').addEventListener('click', () => this.clear());
  }

  private begin(kind: 'path' | 'area'): void {
    this.clear();
    this.drawing = this.kind = kind;
    this.told();
    this.notice(`Click the ${kind === 'path' ? 'path' : 'corners of the area'} on the ground; the button again, or Escape, ends it.`, 6000);
  }

  /** Draw no further; what is drawn stays. */
  stop(): void {
    this.drawing = '';
    this.told();
  }

  clear(): void {
    this.points = [];
    this.drawing = '';
    this.told();
  }

  add(point: Vector3): void {
    if (this.points.length < MOST) this.points.push(point.clone());
    this.told();
  }

  private told(): void {
    for (const kind of ['path', 'area']) byId(kind).setAttribute('aria-pressed', String(this.drawing === kind));
    byId('undraw').hidden = !this.points.length;
    this.marks.way('drawn', this.points, this.kind === 'area');
    byId<HTMLInputElement>('sentence').placeholder = !this.points.length
      ? 'Change it: make the church 5 m higher'
      : this.kind === 'path' ? 'Such as: put benches along this' : 'Such as: plant ten limes in this area';
    this.drawn();
  }

  /** What a sentence speaks of: undefined if of nothing that is drawn, null if that is missing. */
  spokenOf(text: string): Drawn | undefined | null {
    const enough = this.points.length >= (this.kind === 'area' ? 3 : 2);
    if (!SPOKEN.test(text) && !(enough && HERE.test(text))) return undefined;
    if (!enough) return null;
    return { points: this.points.map((point) => [point.x, -point.z]), area: this.kind === 'area' };
  }
}
