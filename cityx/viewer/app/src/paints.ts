/** Materials of the city: one file of them, with textures, for all chunks and packs. */

import { Color, DoubleSide, FrontSide, LinearSRGBColorSpace, MeshLambertMaterial, MeshStandardMaterial } from 'three';
import type { GLTF } from 'three/addons/loaders/GLTFLoader.js';

/** Which look a mesh is shown in. */
export type Coloring = 'natural' | 'class' | 'instance' | 'height' | 'provenance';

/** Shares of lit rooms: homes, work, shops; and whether lamps are on. */
export const lights = { rooms: { value: [0, 0, 0] as [number, number, number] }, lamps: { value: 0 } };

const LAMP_STRENGTH = 4;

export type Shown = MeshStandardMaterial | MeshLambertMaterial;

export class Paints {
  /** Whether surfaces are shown without gloss and relief, as a machine without a graphics card can. */
  plain = false;
  /** Materials that the tint of a row leaves as they are. */
  readonly untinted = new Set<string>();
  private readonly known = new Map<string, Shown>();
  private readonly base = new Map<string, MeshStandardMaterial>();

  /** Take the materials of a file; those in use keep their identity. */
  async read(file: GLTF): Promise<void> {
    const told = file.scene.userData as { materials?: string[]; untinted?: string[] };
    const names = told.materials ?? [];
    told.untinted?.forEach((name) => this.untinted.add(name));
    await Promise.all(
      names.map(async (name, number) => {
        const made = (await file.parser.getDependency('material', number)) as MeshStandardMaterial;
        made.name = name;
        this.base.set(name, made);
        for (const [key, held] of this.known) {
          if (key.slice(0, key.indexOf('|')) === name) this.adopt(held, made);
        }
      }),
    );
  }

  private adopt(held: Shown, made: MeshStandardMaterial): void {
    held.color.copy(made.color);
    held.emissiveIntensity = made.emissiveIntensity;
    if (held instanceof MeshStandardMaterial) {
      held.roughness = made.roughness;
      held.metalness = made.metalness;
    }
  }

  /** Return a material by name, in the variant that a mesh needs. */
  get(name: string, vertexColors: boolean, rooms: boolean): Shown {
    const key = `${name}|${vertexColors}|${rooms}`;
    let found = this.known.get(key);
    if (!found) {
      const base = this.base.get(name) ?? new MeshStandardMaterial({ color: 0x999999, roughness: 0.8 });
      found = this.plain ? plainly(base) : base.clone();
      found.name = name;
      found.vertexColors = vertexColors;
      found.side = base.side === DoubleSide ? DoubleSide : FrontSide;
      if (found.map) found.map.anisotropy = this.plain ? 1 : 4;
      if (rooms) lightRooms(found);
      else if (found.emissive.getHex() !== 0) lightLamps(found);
      this.known.set(key, found);
    }
    return found;
  }
}

function plainly(base: MeshStandardMaterial): MeshLambertMaterial {
  const { color, map, emissive, emissiveIntensity, transparent, opacity, alphaTest, depthWrite } = base;
  const made = new MeshLambertMaterial({
    color, map, emissive, emissiveIntensity, transparent, opacity, alphaTest, depthWrite,
  });
  if (base.metalness > 0.5) made.color.multiplyScalar(0.6); // what it mirrors is darker than itself
  return made;
}

function lightRooms(material: Shown): void {
  material.onBeforeCompile = (shader) => {
    shader.uniforms['roomShares'] = lights.rooms;
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute vec2 room;\nvarying vec2 vRoom;')
      .replace('#include <begin_vertex>', '#include <begin_vertex>\nvRoom = room;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', '#include <common>\nuniform vec3 roomShares;\nvarying vec2 vRoom;')
      .replace(
        '#include <emissivemap_fragment>',
        `#include <emissivemap_fragment>
        float share = vRoom.x < 0.5 ? roomShares.x : vRoom.x < 1.5 ? roomShares.y : roomShares.z;
        if (vRoom.y < share) totalEmissiveRadiance += vec3(1.0, 0.72, 0.38) * (0.7 + 1.3 * fract(vRoom.y * 37.0));`,
      );
  };
  material.customProgramCacheKey = () => 'rooms';
}

function lightLamps(material: Shown): void {
  material.onBeforeCompile = (shader) => {
    shader.uniforms['lampsOn'] = lights.lamps;
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', '#include <common>\nuniform float lampsOn;')
      .replace(
        '#include <emissivemap_fragment>',
        `#include <emissivemap_fragment>\n totalEmissiveRadiance *= lampsOn * ${LAMP_STRENGTH.toFixed(1)};`,
      );
  };
  material.customProgramCacheKey = () => 'lamps';
}

/** A colour for a name or an id, always the same one. */
export function colorOf(text: string, into = new Color()): Color {
  let hash = 2166136261;
  for (let at = 0; at < text.length; at++) hash = Math.imul(hash ^ text.charCodeAt(at), 16777619);
  const hue = ((hash >>> 8) % 360) / 360;
  return into.setHSL(hue, 0.55, 0.35 + ((hash >>> 3) % 25) / 100, LinearSRGBColorSpace);
}
