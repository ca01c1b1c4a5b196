/** Marks in the scene: what is selected, what changed, what was measured. */

import {
  BufferGeometry, Color, Group, Line, LineBasicMaterial, MeshBasicMaterial, Vector3, type Mesh,
} from 'three';

export class Marks {
  readonly group = new Group();
  private readonly kinds = new Map<string, Group>();
  private readonly lines = new Map<string, Line>();

  /** Show some meshes in one colour over the city. */
  set(kind: 'selected' | 'changed' | 'found' | 'ghost', meshes: Mesh[]): void {
    this.clear(kind);
    const shown = new Group();
    const material = new MeshBasicMaterial({
      color: COLORS[kind], transparent: true, opacity: 0.45, depthWrite: false, polygonOffset: true,
      polygonOffsetFactor: -2, polygonOffsetUnits: -2, fog: false,
    });
    for (const mesh of meshes) {
      mesh.material = material;
      mesh.renderOrder = 10;
      shown.add(mesh);
    }
    this.kinds.set(kind, shown);
    this.group.add(shown);
  }

  clear(kind: string): void {
    const held = this.kinds.get(kind);
    if (!held) return;
    this.group.remove(held);
    for (const mesh of held.children as Mesh[]) mesh.geometry.dispose();
    this.kinds.delete(kind);
  }

  /** Show the meshes of a kind elsewhere, metres to the east and to the north. */
  shift(kind: string, east: number, north: number): void {
    this.kinds.get(kind)?.position.set(east, 0, -north);
  }

  has(kind: string): boolean {
    return this.kinds.has(kind);
  }

  /** Show a way that is measured or drawn; a closed one goes round an area. */
  way(kind: 'measured' | 'drawn' | 'moved', points: Vector3[], closed = false): void {
    const older = this.lines.get(kind);
    if (older) {
      this.group.remove(older);
      older.geometry.dispose();
      this.lines.delete(kind);
    }
    if (!points.length) return;
    const raised = points.map((point) => point.clone().add(new Vector3(0, 0.15, 0)));
    if (closed && raised.length > 2 && raised[0]) raised.push(raised[0].clone());
    const material = new LineBasicMaterial({ color: kind === 'drawn' ? 0xff4fd8 : 0xffe066, depthTest: false, fog: false });
    const line = new Line(new BufferGeometry().setFromPoints(raised), material);
    line.renderOrder = 20;
    line.frustumCulled = false;
    this.lines.set(kind, line);
    this.group.add(line);
  }
}

const COLORS: Record<string, Color> = {
  selected: new Color(0x2f9bff), changed: new Color(0xffb020), found: new Color(0x35d08a),
  ghost: new Color(0xff4fd8),
};
