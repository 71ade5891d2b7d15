// SPDX-License-Identifier: GPL-3.0-or-later
// The lit surroundings, as meshes with light at their vertices.

import * as three from 'three';

import type { Bake, Header, WallData } from './bake';
import type { Look } from './look';
import display from './shaders/display.glsl';
import precision from './shaders/precision.glsl';
import fragment from './shaders/wall.frag.glsl';
import vertex from './shaders/wall.vert.glsl';
import { WallLight } from './wall_light';

export class Wall {
  readonly mesh: three.Mesh<three.BufferGeometry, three.RawShaderMaterial>;
  private readonly attributes: three.BufferAttribute[];
  private shown = NaN;

  static async of(bake: Bake, data: WallData): Promise<Wall> {
    const vertices = new Float32Array((await bake.block(data.vertices, 4)).buffer);
    const triangles = new Uint32Array((await bake.block(data.triangles, 4)).buffer);
    const light = await WallLight.of(bake, data, triangles);
    return new Wall(bake.header, data.isOfRoom, vertices, triangles, light);
  }

  private constructor(
    header: Header,
    isOfRoom: boolean,
    vertices: Float32Array,
    triangles: Uint32Array,
    private readonly lights: WallLight,
  ) {
    const geometry = new three.BufferGeometry();
    geometry.setAttribute('position', new three.BufferAttribute(vertices, 3));
    geometry.setIndex(new three.BufferAttribute(triangles, 1));
    this.attributes = ['outerLight', 'innerLight'].map((name) => {
      const attribute = new three.BufferAttribute(new Float32Array(vertices.length), 3);
      geometry.setAttribute(name, attribute);
      return attribute;
    });
    const [low, high] = header.bounds;
    const material = new three.RawShaderMaterial({
      glslVersion: three.GLSL3,
      vertexShader: vertex,
      fragmentShader: [precision, display, fragment].join('\n'),
      side: three.DoubleSide,
      uniforms: {
        isOfRoom: { value: isOfRoom },
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
    this.lights.at(
      c,
      this.attributes.map(({ array }) => array as Float32Array),
    );
    for (const attribute of this.attributes) attribute.needsUpdate = true;
    this.shown = c;
  }
}
