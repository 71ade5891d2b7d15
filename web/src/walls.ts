// SPDX-License-Identifier: GPL-3.0-or-later
// The walls, as meshes with light at their vertices, or shaded locally.

import * as three from 'three';

import type { Bake, Header, WallData } from './bake';
import { factorsOf, lampUniforms, lampVectors } from './lamps';
import type { Lamp, Look } from './look';
import display from './shaders/display.glsl';
import lamps from './shaders/lamps.glsl';
import precision from './shaders/precision.glsl';
import fragment from './shaders/wall.frag.glsl';
import vertex from './shaders/wall.vert.glsl';
import { WallLight } from './wall_light';

export class Wall {
  readonly mesh: three.Mesh<three.BufferGeometry, three.RawShaderMaterial>;
  private readonly attributes: three.BufferAttribute[];
  private shown = NaN; // isovalue of the current light
  private lit: Lamp[] | null = null;

  static async of(bake: Bake, data: WallData): Promise<Wall> {
    const vertices = new Float32Array((await bake.block(data.vertices, 4)).buffer);
    const triangles = new Uint32Array((await bake.block(data.triangles, 4)).buffer);
    const light = await WallLight.of(bake, data, triangles);
    return new Wall(bake.header, data, vertices, triangles, light);
  }

  private constructor(
    private readonly header: Header,
    data: WallData,
    vertices: Float32Array,
    triangles: Uint32Array,
    private readonly lights: WallLight | null,
  ) {
    const geometry = new three.BufferGeometry();
    geometry.setAttribute('position', new three.BufferAttribute(vertices, 3));
    geometry.setIndex(new three.BufferAttribute(triangles, 1));
    this.attributes = ['frontLight', 'backLight'].map((name) => {
      const attribute = new three.BufferAttribute(new Float32Array(vertices.length), 3);
      geometry.setAttribute(name, attribute);
      return attribute;
    });
    const [low, high] = header.bounds;
    geometry.computeBoundingBox();
    const center = geometry.boundingBox?.getCenter(new three.Vector3()) ?? new three.Vector3();
    const material = new three.RawShaderMaterial({
      glslVersion: three.GLSL3,
      vertexShader: vertex,
      fragmentShader: [precision, display, lamps, fragment].join('\n'),
      side: three.DoubleSide,
      uniforms: {
        ...lampUniforms(header),
        isOfRoom: { value: data.isOfRoom },
        isLocal: { value: data.light === null },
        albedo: { value: data.albedo },
        emission: { value: data.emission },
        middle: { value: low.map((x, a) => 0.5 * (x + high[a])) },
        center: { value: center },
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
    this.mesh.visible = look.showsWalls;
    uniforms.worldEye.value = camera.getWorldPosition(new three.Vector3());
    uniforms.worldToClip.value = new three.Matrix4().multiplyMatrices(
      camera.projectionMatrix,
      camera.matrixWorldInverse,
    );
    uniforms.gain.value = 2 ** look.stops;
    uniforms.isLocal.value = look.isLocal || this.lights === null;
    if (look.lamps !== this.lit) this.relight(look.lamps);
    const [{ isovalue }] = look.isosurfaces;
    if (look.showsWalls && !look.isLocal && isovalue !== this.shown) this.light(isovalue);
  }

  private relight(lamps: Lamp[]): void {
    const factors = factorsOf(lamps, this.header);
    this.mesh.material.uniforms.lamps.value = lampVectors(this.header, factors);
    this.lights?.set(lamps);
    this.lit = lamps;
    this.shown = NaN;
  }

  private light(c: number): void {
    this.lights?.at(
      c,
      this.attributes.map(({ array }) => array as Float32Array),
    );
    for (const attribute of this.attributes) attribute.needsUpdate = true;
    this.shown = c;
  }
}
