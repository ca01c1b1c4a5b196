/** What the page shows as meshes that any reader of glTF knows: one for each material. */

import { BufferAttribute, BufferGeometry, Group, InstancedMesh, Mesh, MeshStandardMaterial, type Object3D } from 'three';
import type { Section } from './merging';
import type { Paints } from './paints';

/** Return the merged meshes under some objects apart by their materials; what is hidden is left out. */
export function exported(roots: Object3D[], paints: Paints): Group {
  const found = new Group();
  const materials = new Map<string, MeshStandardMaterial>();
  for (const root of roots) {
    root.updateMatrixWorld(true);
    root.traverseVisible((node) => {
      if (!(node instanceof Mesh) || (node instanceof InstancedMesh && !node.count)) return;
      const { sections } = node.geometry.userData as { sections?: Section[] };
      if (sections) found.add(...apart(node, sections, (name) => material(name, paints, materials)));
    });
  }
  return found;
}

function apart(mesh: Mesh, sections: Section[], material: (name: string) => MeshStandardMaterial): Mesh[] {
  const from = mesh.geometry;
  const shared: Record<string, BufferAttribute> = {
    position: from.getAttribute('position') as BufferAttribute, uv: from.getAttribute('uv') as BufferAttribute,
    normal: normals(from.getAttribute('normal') as BufferAttribute),
    color: colors(from.getAttribute('paint') as BufferAttribute),
  };
  return sections.map(({ material: name, first, count }) => {
    const geometry = new BufferGeometry();
    for (const [kind, attribute] of Object.entries(shared)) geometry.setAttribute(kind, attribute);
    geometry.setIndex(new BufferAttribute((from.index?.array ?? new Uint16Array()).slice(first, first + count), 1));
    let made = new Mesh(geometry, material(name));
    if (mesh instanceof InstancedMesh) {
      const rows = new InstancedMesh(geometry, material(name), mesh.count);
      rows.instanceMatrix.array.set(mesh.instanceMatrix.array.subarray(0, mesh.count * 16));
      made = rows;
    }
    made.name = mesh.name || name;
    mesh.matrixWorld.decompose(made.position, made.quaternion, made.scale);
    return made;
  });
}

function normals(packed: BufferAttribute): BufferAttribute {
  const made = new Float32Array(packed.count * 3);
  for (let at = 0; at < packed.count; at++) {
    const [x, y, z] = [packed.getX(at), packed.getY(at), packed.getZ(at)];
    const length = Math.hypot(x, y, z) || 1;
    made.set([x / length, y / length, z / length], at * 3);
  }
  return new BufferAttribute(made, 3);
}

function colors(paint: BufferAttribute): BufferAttribute {
  const made = new Uint8Array(paint.array as Uint8Array);
  for (let at = 3; at < made.length; at += 4) made[at] = 255; // the layer
  return new BufferAttribute(made, 4, true);
}

/** A material of the city for texture places that count whole tiles. */
function material(name: string, paints: Paints, known: Map<string, MeshStandardMaterial>): MeshStandardMaterial {
  let found = known.get(name);
  if (!found) {
    found = paints.weathered(name);
    found.name = name;
    found.vertexColors = true;
    for (const kind of ['map', 'normalMap', 'roughnessMap', 'metalnessMap'] as const) {
      const picture = found[kind]?.clone();
      if (!picture) continue;
      picture.repeat.set(1, 1);
      found[kind] = picture;
    }
    known.set(name, found);
  }
  return found;
}
