// SPDX-License-Identifier: GPL-3.0-or-later
// The lit surroundings: their light at vertices, linear between nodes of the leaf coordinate.

import * as three from 'three';

import type { Bake, Header, WallData } from './bake';
import { addColors, colorWords } from './colors';
import type { Look } from './look';
import display from './shaders/display.glsl';
import precision from './shaders/precision.glsl';
import fragment from './shaders/wall.frag.glsl';
import vertex from './shaders/wall.vert.glsl';

export class Wall {
  readonly mesh: three.Mesh<three.BufferGeometry, three.RawShaderMaterial>;
  private readonly lights: { attribute: three.BufferAttribute; packed: Uint32Array | null }[];
  private shown = NaN;

  static async of(bake: Bake, data: WallData): Promise<Wall> {
    const light = async (number: number | null) =>
      number === null ? null : colorWords(await bake.block(number, 1));
    return new Wall(
      bake.header,
      data,
      new Float32Array((await bake.block(data.vertices, 4)).buffer),
      new Uint32Array((await bake.block(data.triangles, 4)).buffer),
      [await light(data.outer), await light(data.inner)],
    );
  }

  private constructor(
    header: Header,
    private readonly data: WallData,
    vertices: Float32Array,
    triangles: Uint32Array,
    packed: (Uint32Array | null)[],
  ) {
    const geometry = new three.BufferGeometry();
    geometry.setAttribute('position', new three.BufferAttribute(vertices, 3));
    geometry.setIndex(new three.BufferAttribute(triangles, 1));
    this.lights = packed.map((each, side) => {
      const attribute = new three.BufferAttribute(new Float32Array(vertices.length), 3);
      geometry.setAttribute(side === 0 ? 'outerLight' : 'innerLight', attribute);
      return { attribute, packed: each };
    });
    const [low, high] = header.bounds;
    const material = new three.RawShaderMaterial({
      glslVersion: three.GLSL3,
      vertexShader: vertex,
      fragmentShader: [precision, display, fragment].join('\n'),
      side: three.DoubleSide,
      uniforms: {
        isOfRoom: { value: data.isOfRoom },
        middle: { value: low.map((x, a) => 0.5 * (x + high[a])) },
        worldEye: { value: null },
        worldToClip: { value: null },
        gain: { value: 1 },
      },
    });
    this.mesh = new three.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
  }

  show(look: Look, camera: three.Camera): void {
    const { uniforms } = this.mesh.material;
    this.mesh.visible = look.showsWalls && !look.countsFetches;
    uniforms.worldEye.value = camera.getWorldPosition(new three.Vector3());
    uniforms.worldToClip.value = new three.Matrix4().multiplyMatrices(
      camera.projectionMatrix,
      camera.matrixWorldInverse,
    );
    uniforms.gain.value = 2 ** look.stops;
    if (this.mesh.visible && look.isovalue !== this.shown) this.light(look.isovalue);
  }

  private light(c: number): void {
    const { nodes } = this.data;
    const next = nodes.findIndex((node) => node > c);
    const low = Math.min(next < 0 ? nodes.length : Math.max(next, 1), nodes.length - 1) - 1;
    const share = (c - nodes[low]) / (nodes[low + 1] - nodes[low]);
    for (const { attribute, packed } of this.lights) {
      if (packed === null) continue;
      const colors = attribute.array as Float32Array;
      colors.fill(0);
      addColors(colors, packed, low * attribute.count, 1 - share);
      addColors(colors, packed, (low + 1) * attribute.count, share);
      attribute.needsUpdate = true;
    }
    this.shown = c;
  }
}
