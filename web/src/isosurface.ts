// SPDX-License-Identifier: GPL-3.0-or-later
// The isosurfaces of one volume: a box whose fragments trace rays.

import * as three from 'three';

import {
  type Bake,
  type CutsData,
  type Header,
  type LightData,
  type TextureData,
  type Vector,
  type VolumeData,
  rampAt,
} from './bake';
import { bricksOf, textureSize } from './bricks';
import { colorsOf } from './color_maps';
import { colorWords } from './colors';
import { light, mapTextures, mapUniforms } from './maps';
import coat from './shaders/coat.glsl';
import cuts from './shaders/cuts.glsl';
import direct from './shaders/direct.glsl';
import display from './shaders/display.glsl';
import gradient from './shaders/gradient.glsl';
import fragment from './shaders/isosurface.frag.glsl';
import vertex from './shaders/isosurface.vert.glsl';
import lamps from './shaders/lamps.glsl';
import shading from './shaders/light.glsl';
import precision from './shaders/precision.glsl';
import trace from './shaders/trace.glsl';
import { factorsOf, indirectFactor, lampUniforms, lampVectors } from './lamps';
import { clipPlane, type Lamp, type Look, MOST_SHOWN, type Shown } from './look';
import { albedoOf, coatOf } from './looks';
import { smoothCodes, smoothPerCode } from './smooth_normals';
import { type Codes, given, integerTexture, quads, volumeTextures } from './volume_textures';

const NO_DATA = 65535;

// World directions: through the lower left corner of the picture, and from pixel to pixel.
export interface Rays {
  corner: three.Vector3;
  right: three.Vector3;
  up: three.Vector3;
}

// Outputs of the shader, as numbered in isosurface.frag.glsl.
export enum Result {
  Picture,
  Fetches,
  Distances,
}

export class Isosurface {
  readonly mesh: three.Mesh<three.BufferGeometry, three.RawShaderMaterial>;
  private readonly indexToWorld = new three.Matrix4();
  private readonly worldToIndex: three.Matrix4;
  private readonly waysToIndex: three.Matrix3;
  private lit: Lamp[] | null = null;

  static async of(bake: Bake, data: VolumeData): Promise<Isosurface> {
    const bytes = await bake.block(data.values, data.bits === 8 ? 1 : 2);
    const codes = data.bits === 8 ? bytes : new Uint16Array(bytes.buffer);
    const textures = {
      ...volumeTextures(codes, data.dims),
      ...normalTextures(codes, data),
      ...(await lightTextures(bake, data.light)),
      ...(data.texture && (await colorTexture(bake, data.texture))),
      ...(data.direct && (await mapTextures(bake, data, data.direct, codes))),
    };
    return new Isosurface(bake.header, data, textures);
  }

  private constructor(
    private readonly header: Header,
    private readonly data: VolumeData,
    textures: Record<string, three.Texture>,
  ) {
    this.indexToWorld.copy(matrixOf(data.indexToWorld));
    this.worldToIndex = this.indexToWorld.clone().invert();
    this.waysToIndex = new three.Matrix3().setFromMatrix4(this.worldToIndex);
    const last = data.dims.map((n) => n - 1) as Vector;
    const lights = data.direct ? [coat, direct] : [];
    const material = new three.RawShaderMaterial({
      glslVersion: three.GLSL3,
      vertexShader: vertex,
      fragmentShader: [precision, trace, display, cuts, gradient, lamps, ...lights, shading, fragment].join('\n'),
      defines: {
        ...(data.direct && { DIRECT: '' }),
        ...(data.smoothNormals > 0 && { SMOOTH_NORMALS: '' }),
        ...(data.texture && { TEXTURE: '' }),
        ...(data.cuts && { CUTS: data.cuts.keeps.length }),
      },
      side: three.BackSide,
      transparent: true,
      blending: three.CustomBlending,
      blendSrc: three.OneFactor,
      blendDst: three.OneMinusSrcAlphaFactor,
      uniforms: uniformsOf(header, data, textures, this.indexToWorld, this.worldToIndex),
    });
    const box = new three.BoxGeometry(...last).translate(...(last.map((x) => 0.5 * x) as Vector));
    this.mesh = new three.Mesh(box, material);
    this.mesh.frustumCulled = false;
    this.mesh.matrixAutoUpdate = false;
    this.mesh.matrix.copy(this.indexToWorld);
    this.mesh.renderOrder = 1;
  }

  // Returns the isovalue, in data units, at a common isovalue.
  isovalueAt(c: number): number {
    const [low, high] = this.data.isovalues;
    return low + c * (high - low);
  }

  show(look: Look, camera: three.Camera, rays: Rays, result: Result): void {
    const { uniforms } = this.mesh.material;
    const code = (c: number) => (this.isovalueAt(c) - this.data.offset) / this.data.scale;
    const { isosurfaces } = look;
    // Uniform arrays have a place for each possible isosurface.
    const shown = Array.from({ length: MOST_SHOWN }, (_, k) => isosurfaces[k] ?? isosurfaces[0]);
    const own = shown.map(({ isovalue }) => this.isovalueAt(isovalue));
    uniforms.count.value = isosurfaces.length;
    uniforms.isovalues.value = shown.map(({ isovalue }) => code(isovalue));
    uniforms.opacities.value = shown.map(({ opacity }) => opacity);
    uniforms.coats.value = shown.flatMap(({ colors }) => coatOf(colors, this.header));
    uniforms.isLocal.value = look.isLocal;
    uniforms.gain.value = 2 ** look.stops;
    uniforms.albedo.value = own.flatMap((c) => rampAt(this.data.albedo, c));
    uniforms.emission.value = own.flatMap((c) => rampAt(this.data.emission, c));
    const eye = camera.getWorldPosition(new three.Vector3());
    uniforms.worldEye.value = eye;
    uniforms.eye.value = eye.clone().applyMatrix4(this.worldToIndex);
    for (const name of ['corner', 'right', 'up'] as const) {
      uniforms[name].value = rays[name].clone().applyMatrix3(this.waysToIndex);
    }
    uniforms.indexToClip.value = new three.Matrix4()
      .multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse)
      .multiply(this.indexToWorld);
    uniforms.clip.value = this.clipPlane(look);
    uniforms.slices.value = look.slices.map((share, axis) => this.slicePlane(axis, share));
    uniforms.colors.value = colorsOf(look.sliceColors, this.header).flat();
    uniforms.tint.value = shown.flatMap((each) => this.tint(each));
    if (look.lamps !== this.lit) this.light(look.lamps);
    uniforms.result.value = result;
    this.mesh.material.blending = result === Result.Picture ? three.CustomBlending : three.NoBlending;
  }

  private light(lamps: Lamp[]): void {
    const { uniforms } = this.mesh.material;
    const factors = factorsOf(lamps, this.header);
    uniforms.lamps.value = lampVectors(this.header, factors);
    uniforms.indirectFactor.value = indirectFactor(factors, this.header);
    const { direct } = this.data;
    if (direct) light(uniforms.lightPoints.value as three.DataTexture, direct, factors);
    this.lit = lamps;
  }

  private clipPlane(look: Look): three.Vector4 {
    if (look.clip === null) return new three.Vector4();
    const { normal, distance } = clipPlane(look.clip, this.header.bounds);
    return this.planeInIndex(normal, distance);
  }

  private slicePlane(axis: number, share: number | null): three.Vector4 {
    if (share === null) return new three.Vector4();
    const [low, high] = this.header.bounds.map((point) => point[axis]);
    const normal: Vector = [0, 0, 0];
    normal[axis] = 1;
    return this.planeInIndex(normal, low + share * (high - low));
  }

  private planeInIndex(normal: Vector, distance: number): three.Vector4 {
    const plane = new three.Vector4(...normal, -distance);
    return plane.applyMatrix4(this.indexToWorld.clone().transpose());
  }

  // Returns the factor of another albedo on the light of an isosurface without emission.
  private tint(shown: Shown): Vector {
    const isovalue = this.isovalueAt(shown.isovalue);
    const [low, high] = this.header.isovalueRange;
    const color = albedoOf(shown.colors, (shown.isovalue - low) / (high - low), this.header);
    if (color === null || rampAt(this.data.emission, isovalue).some((x) => x > 0)) return [1, 1, 1];
    const albedo = rampAt(this.data.albedo, isovalue);
    return color.map((x, k) => (albedo[k] > 0 ? x / albedo[k] : 0)) as Vector;
  }
}

function uniformsOf(
  header: Header,
  data: VolumeData,
  textures: Record<string, three.Texture>,
  indexToWorld: three.Matrix4,
  worldToIndex: three.Matrix4,
): Record<string, three.IUniform> {
  const [layers, firstLayer, layerStep] = data.light.layers;
  const [nx, ny, stacked] = data.light.texels;
  const texels = [nx, ny, stacked / (layers + 1)];
  const texelScale = texels.map((n, a) => (n - 1) / (data.dims[a] - 1));
  const isovalueRange = header.isovalueRange.map((c) => {
    const [low, high] = data.isovalues;
    return (low + c * (high - low) - data.offset) / data.scale;
  });
  const constant = {
    ...textures,
    dims: data.dims,
    noData: data.masked ? NO_DATA : -1,
    smoothPerCode: smoothPerCode(data.bits),
    brick: data.light.brick,
    bricks: data.light.bricks,
    texelScale: new three.Vector3(...texelScale),
    layers,
    layerCodes: new three.Vector2(firstLayer, layerStep),
    layerHeight: texels[2],
    textureScale: new three.Vector3(...textureSize(data.light).map((n) => 1 / n)),
    ...(data.direct && mapUniforms(data.direct)),
    ...(data.texture && {
      toPigment: matrixOf(data.texture.fromIndex),
      pigmentMargin: new three.Vector3(...data.texture.margin),
    }),
    ...(data.cuts && cutUniforms(data.cuts)),
    backHasMaps: data.direct !== null && data.direct.back !== null,
    backIs: ['baked', 'dark', 'local'].indexOf(data.backIs),
    indexToWorld,
    normalToWorld: new three.Matrix3().setFromMatrix4(worldToIndex).transpose(),
    unbaked: header.unbaked,
    isovalueRange: new three.Vector2(...isovalueRange),
  };
  const varying = [
    'count', 'isovalues', 'opacities', 'coats', 'isLocal', 'gain', 'albedo', 'emission',
    'worldEye', 'eye', 'corner', 'right', 'up', 'indexToClip', 'clip', 'slices', 'colors', 'tint',
    'indirectFactor', 'result',
  ]; // prettier-ignore
  return Object.fromEntries([
    ...Object.entries(lampUniforms(header)),
    ...Object.entries(constant).map(([name, value]) => [name, { value }]),
    ...varying.map((name) => [name, { value: null }]),
  ]) as Record<string, three.IUniform>;
}

function cutUniforms(data: CutsData): Record<string, unknown> {
  const { range, slabs, halfWidths, keeps } = data;
  return { cutRange: new three.Vector2(...range), slabs: slabs.flat(), halfWidths, keeps };
}

function normalTextures(codes: Codes, data: VolumeData): Record<string, three.Texture> {
  if (!(data.smoothNormals > 0)) return {};
  const smooth = smoothCodes(codes, data);
  const values = quads(smooth, data.dims);
  return { smoothValues: integerTexture(values, data.dims, three.RGBAIntegerFormat) };
}

// Returns a matrix from numbers by rows.
function matrixOf(numbers: number[]): three.Matrix4 {
  return new three.Matrix4().set(...(numbers as Parameters<three.Matrix4['set']>));
}

async function colorTexture(bake: Bake, data: TextureData): Promise<Record<string, three.Texture>> {
  const colors = await bake.block(data.colors, 1);
  const texels = new Uint8Array((4 * colors.length) / 3);
  for (let i = 0; 3 * i < colors.length; ++i) texels.set(colors.subarray(3 * i, 3 * i + 3), 4 * i);
  const texture = new three.Data3DTexture(texels, ...data.nodes);
  texture.internalFormat = 'SRGB8_ALPHA8';
  texture.minFilter = texture.magFilter = data.nearest ? three.NearestFilter : three.LinearFilter;
  return { pigment: given(texture) };
}

interface LightTextures {
  table: three.Data3DTexture;
  front: three.Data3DTexture;
  back: three.Data3DTexture;
}

async function lightTextures(bake: Bake, data: LightData): Promise<LightTextures> {
  const { table, from, to } = await bricksOf(bake, data);
  const side = async (block: number) => {
    const words = colorWords(await bake.block(block, 1));
    const size = textureSize(data);
    const texels = new Uint32Array(size[0] * size[1] * size[2]);
    for (let i = 0; i < to.length; ++i) texels[to[i]] = words[from[i]];
    const texture = new three.Data3DTexture(texels, ...size);
    texture.format = three.RGBFormat;
    texture.type = three.UnsignedInt5999Type;
    texture.internalFormat = 'RGB9_E5';
    texture.minFilter = three.LinearFilter;
    texture.magFilter = three.LinearFilter;
    return given(texture);
  };
  const front = await side(data.front);
  return { table, front, back: data.back === null ? front : await side(data.back) };
}
