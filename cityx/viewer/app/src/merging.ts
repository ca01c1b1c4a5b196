/** Meshes of several materials made one, whose vertices tell their paint. */

import { BufferAttribute, BufferGeometry, Vector3, type Material, type Mesh, type TypedArray } from 'three';
import type { Paint, Paints } from './paints';

/** Steps of texture places in files. */
const PER_TILE = 256;

/**
 * The triangles of one material in a merged mesh; `userData.sections` of its geometry lists them,
 * and `userData.large` tells how many corners come before those of small triangles.
 */
export interface Section {
  material: string;
  /** First corner and number of corners. */
  first: number;
  count: number;
}

export interface Merged {
  geometry: BufferGeometry;
  /** Where its places count from. */
  origin: Vector3;
  /** Row of the property table, by vertex; empty where there is none. */
  feature: Uint32Array;
  double: boolean;
  clear: boolean;
}

/**
 * Merge meshes: all that are opaque, and all that light comes through.
 *
 * `placed` says whether places are those of the world, about a middle, or the numbers of the file;
 * triangles of a smaller area than `least` come after all others.
 */
export function mergedOf(meshes: Mesh[], paints: Paints, placed: boolean, least = 0): Merged[] {
  const kinds = new Map<boolean, { mesh: Mesh; paint: Paint }[]>();
  for (const mesh of meshes) {
    const paint = paints.paint((mesh.material as Material).name);
    kinds.set(paint.clear, [...(kinds.get(paint.clear) ?? []), { mesh, paint }]);
  }
  return [...kinds].map(([clear, own]) => merge(own, clear, placed, least));
}

function merge(own: { mesh: Mesh; paint: Paint }[], clear: boolean, placed: boolean, least: number): Merged {
  const vertices = own.reduce((sum, { mesh }) => sum + (mesh.geometry.getAttribute('position')?.count ?? 0), 0);
  const corners = own.reduce((sum, { mesh }) => sum + (mesh.geometry.index?.count ?? 0), 0);
  const position = new Float32Array(vertices * 3);
  const normal = new Int8Array(vertices * 4);
  const uv = new Float32Array(vertices * 2);
  const paint = new Uint8Array(vertices * 4).fill(255);
  const featured = own.some(({ mesh }) => mesh.geometry.hasAttribute('_feature_id_0'));
  const feature = new Uint32Array(featured ? vertices : 0);
  const index = vertices < 65535 ? new Uint16Array(corners) : new Uint32Array(corners);
  const sections: Section[] = [];
  const small: { material: string; corners: number[] }[] = [];
  const point = new Vector3();
  const origin = placed && own[0] ? middleOf(own[0].mesh) : new Vector3();
  let [vertex, corner] = [0, 0];
  for (const { mesh, paint: { layer } } of own) {
    const { geometry } = mesh;
    const from = { place: geometry.getAttribute('position'), normal: geometry.getAttribute('normal'),
      uv: geometry.getAttribute('uv'), color: geometry.getAttribute('color'), feature: geometry.getAttribute('_feature_id_0') };
    for (let at = 0; at < from.place.count; at++) {
      const to = vertex + at;
      point.fromBufferAttribute(from.place, at);
      if (placed) point.applyMatrix4(mesh.matrixWorld).sub(origin);
      point.toArray(position, to * 3);
      if (from.normal) for (let axis = 0; axis < 3; axis++) normal[to * 4 + axis] = Math.round(from.normal.getComponent(at, axis) * 127);
      if (from.uv) {
        uv[to * 2] = from.uv.getX(at) / PER_TILE;
        uv[to * 2 + 1] = from.uv.getY(at) / PER_TILE;
      }
      if (from.color) for (let axis = 0; axis < 3; axis++) paint[to * 4 + axis] = Math.round(from.color.getComponent(at, axis) * 255);
      paint[to * 4 + 3] = layer;
      if (from.feature) feature[to] = from.feature.getX(at);
    }
    const given = geometry.index?.array as TypedArray | undefined;
    const begun = corner;
    const material = (mesh.material as Material).name;
    const left: number[] = [];
    for (let at = 0; at < (given?.length ?? 0); at += 3) {
      const [a, b, c] = [(given?.[at] ?? 0) + vertex, (given?.[at + 1] ?? 0) + vertex, (given?.[at + 2] ?? 0) + vertex];
      if (least && areaOf(position, a, b, c) < least) left.push(a, b, c);
      else {
        index[corner++] = a;
        index[corner++] = b;
        index[corner++] = c;
      }
    }
    sections.push({ material, first: begun, count: corner - begun });
    small.push({ material, corners: left });
    vertex += from.place.count;
  }
  const large = corner;
  for (const { material, corners: left } of small) {
    if (!left.length) continue;
    index.set(left, corner);
    sections.push({ material, first: corner, count: left.length });
    corner += left.length;
  }
  const made = new BufferGeometry();
  made.setAttribute('position', new BufferAttribute(position, 3));
  made.setAttribute('normal', new BufferAttribute(normal, 4, true));
  made.setAttribute('uv', new BufferAttribute(uv, 2));
  made.setAttribute('paint', new BufferAttribute(paint, 4, true));
  made.setIndex(new BufferAttribute(index, 1));
  made.computeBoundingSphere();
  made.userData['sections'] = sections.filter((section) => section.count);
  made.userData['large'] = large;
  return { geometry: made, origin, feature, double: own.some((each) => each.paint.double), clear };
}

function areaOf(place: Float32Array, a: number, b: number, c: number): number {
  const at = (corner: number, axis: number): number => place[corner * 3 + axis] ?? 0;
  const [ux, uy, uz] = [at(b, 0) - at(a, 0), at(b, 1) - at(a, 1), at(b, 2) - at(a, 2)];
  const [vx, vy, vz] = [at(c, 0) - at(a, 0), at(c, 1) - at(a, 1), at(c, 2) - at(a, 2)];
  return Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
}

function middleOf(mesh: Mesh): Vector3 {
  mesh.geometry.computeBoundingSphere();
  const middle = mesh.geometry.boundingSphere?.center.clone() ?? new Vector3();
  return middle.applyMatrix4(mesh.matrixWorld).round();
}
