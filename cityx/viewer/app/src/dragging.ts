/** Dragging: the selected thing follows the hand as a ghost, and is moved by an edit when it is let go. */

import { Plane, Vector3, type Mesh, type Ray } from 'three';
import { byId } from './dom';
import type { Marks } from './marks';

export interface Hand {
  /** What lies under a place on the page, or as near to it as a finger is broad, if it may be dragged. */
  grab(x: number, y: number, broad?: number): { id: string; point: Vector3 } | null;
  /** What shows a thing. */
  meshes(id: string): Mesh[];
  ray(x: number, y: number): Ray;
  /** Have it moved by metres to the east and to the north; ends when that is done or refused. */
  move(id: string, east: number, north: number): Promise<void>;
  /** A press that did not move it. */
  click(x: number, y: number): void;
  drawn(): void;
}

const FAR_PX = 5; // from where it was pressed, above which it is a drag
const FINGER_PX = 12; // to each side of where a finger is told to be
const ABOVE_PX = 56; // of the tip over a finger, which would hide it
const LEAST = 0.05; // metres
const FURTHEST = 2000; // metres that a look at the horizon may take it

interface Held {
  id: string;
  pointer: number;
  at: Vector3;
  x: number;
  y: number;
  begun: boolean;
  east: number;
  north: number;
}

export class Dragging {
  private held: Held | null = null;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly marks: Marks, private readonly hand: Hand) {
    // Before the camera hears of it: what takes hold of the thing leaves the camera where it is.
    const first = { capture: true };
    canvas.addEventListener('pointerdown', (event) => this.press(event), first);
    canvas.addEventListener('pointermove', (event) => this.follow(event), first);
    canvas.addEventListener('pointerup', (event) => this.release(event), first);
    canvas.addEventListener('pointercancel', () => this.letGo(), first);
    canvas.addEventListener('lostpointercapture', () => this.letGo(), first);
  }

  /** Whether a thing is in the hand. */
  get active(): boolean {
    return this.held?.begun ?? false;
  }

  private press(event: PointerEvent): void {
    if (this.held) {
      this.letGo(); // a second finger turns or comes nearer
      return;
    }
    if (event.button !== 0 || !event.isPrimary) return;
    const hit = this.hand.grab(event.clientX, event.clientY, event.pointerType === 'touch' ? FINGER_PX : 0);
    if (!hit) return;
    event.stopImmediatePropagation();
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.held = { id: hit.id, pointer: event.pointerId, at: hit.point, x: event.clientX, y: event.clientY, begun: false, east: 0, north: 0 };
  }

  private follow(event: PointerEvent): void {
    const { held } = this;
    if (!held || event.pointerId !== held.pointer) return;
    event.stopImmediatePropagation();
    if (!held.begun && Math.hypot(event.clientX - held.x, event.clientY - held.y) <= FAR_PX) return;
    if (!held.begun) {
      held.begun = true;
      this.marks.set('ghost', this.hand.meshes(held.id));
      this.canvas.classList.add('dragging');
    }
    const ray = this.hand.ray(event.clientX, event.clientY);
    const to = ray.intersectPlane(new Plane(new Vector3(0, 1, 0), -held.at.y), new Vector3());
    if (to && to.distanceTo(held.at) < FURTHEST) {
      held.east = Math.round((to.x - held.at.x) * 100) / 100;
      held.north = Math.round((held.at.z - to.z) * 100) / 100;
      this.marks.shift('ghost', held.east, held.north);
      this.marks.way('moved', [held.at, held.at.clone().add(new Vector3(held.east, 0, -held.north))]);
    }
    const tip = byId('tip');
    tip.textContent = wayText(held.east, held.north);
    tip.style.left = `${Math.min(event.clientX + 14, innerWidth - 200)}px`;
    tip.style.top = `${Math.max(event.clientY + (event.pointerType === 'touch' ? -ABOVE_PX : 14), 0)}px`;
    tip.hidden = false;
    this.hand.drawn();
  }

  private release(event: PointerEvent): void {
    const { held } = this;
    if (!held || event.pointerId !== held.pointer) return;
    event.stopImmediatePropagation();
    this.held = null;
    if (!held.begun) {
      this.hand.click(event.clientX, event.clientY);
      return;
    }
    byId('tip').hidden = true;
    this.canvas.classList.remove('dragging');
    if (Math.hypot(held.east, held.north) < LEAST) this.clear();
    // The ghost stands where the thing is to be until the city tells that it is there, or not.
    else void this.hand.move(held.id, held.east, held.north).finally(() => this.clear());
  }

  /** Leave the thing where it was. */
  letGo(): boolean {
    const { held } = this;
    if (!held) return false;
    this.held = null;
    byId('tip').hidden = true;
    this.canvas.classList.remove('dragging');
    this.clear();
    return held.begun;
  }

  private clear(): void {
    if (this.held) return; // another is in the hand by now
    this.marks.clear('ghost');
    this.marks.way('moved', []);
    this.hand.drawn();
  }
}

/** Say how far and where something is moved. */
export function wayText(east: number, north: number): string {
  const part = (metres: number, one: string, other: string): string => `${Math.abs(metres).toFixed(2)} m ${metres < 0 ? other : one}`;
  return `${part(east, 'east', 'west')}, ${part(north, 'north', 'south')}`;
}
