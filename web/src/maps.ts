// SPDX-License-Identifier: GPL-3.0-or-later
// The maps of direct light as textures (python/leaflight/export/visibility_levels.py).

import * as three from 'three';

import type { Bake, DirectData, Vector, VolumeData } from './bake';
import { bricksOf, textureSize } from './bricks';
import { factorAt } from './lamps';
import { type Codes, extremes, integerTexture } from './volume_textures';

const POINTS_A_TEXEL = 8; // two per byte, four bytes

function groupsOf(direct: DirectData): number {
  return Math.ceil(direct.points.length / POINTS_A_TEXEL);
}

export function layersOf(direct: DirectData): number {
  return groupsOf(direct) * (direct.back === null ? 1 : 2);
}

export interface MapTextures {
  maps: three.Data3DTexture;
  mapTable: three.Data3DTexture;
  mapRanges: three.Data3DTexture;
  lightPoints: three.DataTexture;
}

export async function mapTextures(
  bake: Bake,
  volume: VolumeData,
  direct: DirectData,
  codes: Codes,
): Promise<MapTextures> {
  const { table, from, to } = await bricksOf(bake, direct);
  const size = textureSize(direct, layersOf(direct));
  const levels = new Uint8Array(4 * size[0] * size[1] * size[2]);
  const layer = levels.length / layersOf(direct);
  for (const [side, blocks] of [direct.front, direct.back ?? []].entries()) {
    for (const [pair, block] of blocks.entries()) {
      const pairs = await bake.block(block, 1);
      const first = (side * groupsOf(direct) + (pair >> 2)) * layer + (pair & 3);
      for (let i = 0; i < to.length; ++i) levels[first + 4 * to[i]] = pairs[from[i]];
    }
  }
  return {
    maps: integerTexture(levels, size, three.RGBAIntegerFormat),
    mapTable: table,
    mapRanges: rangesTexture(volume, direct, codes),
    lightPoints: pointsTexture(direct.points),
  };
}

export function mapUniforms(direct: DirectData): Record<string, unknown> {
  const indexToFrame = new three.Matrix4();
  indexToFrame.set(...(direct.indexToFrame as Parameters<three.Matrix4['set']>));
  return {
    mapTexels: direct.texels,
    mapBrick: direct.brick,
    mapBricks: direct.bricks,
    mapDepth: textureSize(direct)[2],
    codeRange: new three.Vector2(...direct.codeRange),
    indexToFrame,
  };
}

// A texture with four texels for each light point.
function pointsTexture(points: number[][]): three.DataTexture {
  const rows = new Float32Array(points.flat());
  const texture = new three.DataTexture(rows, 4, points.length, three.RGBAFormat, three.FloatType);
  texture.needsUpdate = true;
  return texture;
}

// Scales the light points of lamps relative to the bake.
export function light(texture: three.DataTexture, direct: DirectData, factors: Vector[]): void {
  const rows = texture.image.data as Float32Array;
  direct.points.forEach((point, p) => {
    factorAt(factors, direct.lights[p]).forEach((factor, k) => {
      rows[16 * p + 8 + k] = factor * point[8 + k];
    });
  });
  texture.needsUpdate = true;
}

// A texture of the least and the greatest visibility code around each texel.
function rangesTexture(
  { dims, masked }: VolumeData,
  { texels, codeRange: [low, high] }: DirectData,
  codes: Codes,
): three.Data3DTexture {
  const codeOf = (value: number) => 1 + (value - low) * (252 / (high - low));
  const count = codes instanceof Uint8Array ? 256 : 65536;
  const [floors, ceilings] = [new Uint8ClampedArray(count), new Uint8ClampedArray(count)];
  for (let value = 0; value < count; ++value) {
    floors[value] = Math.min(Math.floor(codeOf(value)), 254);
    ceilings[value] = Math.min(Math.ceil(codeOf(value)), 254);
  }
  const known = masked ? codes.map((code) => (code === count - 1 ? 0 : code)) : codes;
  const spans = texels.map((number, axis) => {
    const width = (dims[axis] - 1) / (number - 1);
    return Array.from({ length: number }, (_, texel): [number, number] => [
      Math.max(0, Math.floor((texel - 1) * width)),
      Math.min(dims[axis], Math.ceil((texel + 1) * width) + 1),
    ]);
  });
  const about = extremes({ low: codes, high: known, dims }, spans);
  const ranges = new Uint8Array(2 * about.low.length);
  for (let i = 0; i < about.low.length; ++i) {
    ranges[2 * i] = floors[about.low[i]];
    ranges[2 * i + 1] = ceilings[about.high[i]];
  }
  return integerTexture(ranges, texels, three.RGIntegerFormat);
}
