// SPDX-License-Identifier: GPL-3.0-or-later
// The values of a volume as textures for ray tracing.

import * as three from 'three';

import type { Vector } from './bake';

export type Codes = Uint8Array<ArrayBuffer> | Uint16Array<ArrayBuffer>;

const FINE = 4; // cells per side of a brick of `bounds`; four make a coarse one

export interface VolumeTextures {
  values: three.Data3DTexture;
  bounds: three.Data3DTexture;
  coarseBounds: three.Data3DTexture;
}

export function volumeTextures(codes: Codes, dims: Vector): VolumeTextures {
  const fine = brickBounds({ low: codes, high: codes, dims }, FINE, 1);
  const coarse = brickBounds(fine, FINE, 0);
  return {
    values: integerTexture(quads(codes, dims), dims, three.RGBAIntegerFormat),
    bounds: boundsTexture(fine),
    coarseBounds: boundsTexture(coarse),
  };
}

// Packs each voxel with its next ones in x and y, so that two fetches read all corners of a cell.
export function quads(codes: Codes, [nx, ny, nz]: Vector): Codes {
  const result = sameKind(codes, 4 * codes.length);
  let at = 0;
  for (let z = 0; z < nz; ++z) {
    for (let y = 0; y < ny; ++y) {
      const row = (z * ny + y) * nx;
      const next = y + 1 < ny ? row + nx : row;
      for (let x = 0; x < nx; ++x) {
        const right = x + 1 < nx ? x + 1 : x;
        result[at++] = codes[row + x];
        result[at++] = codes[row + right];
        result[at++] = codes[next + x];
        result[at++] = codes[next + right];
      }
    }
  }
  return result;
}

interface Bounds {
  low: Codes;
  high: Codes;
  dims: Vector;
}

// Returns the least and the greatest of `step` cells along each axis; cells share voxels.
function brickBounds(of: Bounds, side: number, shared: 0 | 1): Bounds {
  const spans = of.dims.map((n) =>
    Array.from({ length: Math.max(1, Math.ceil((n - shared) / side)) }, (_, k): Span => [
      k * side,
      Math.min((k + 1) * side + shared, n),
    ]),
  );
  return extremes(of, spans);
}

// The range excludes the last index.
type Span = [number, number];

// Returns the least and the greatest of spans along each axis.
export function extremes(of: Bounds, spans: Span[][]): Bounds {
  let { low, high } = of;
  const dims: Vector = [...of.dims];
  let stride = 1;
  for (let axis = 0; axis < 3; ++axis) {
    const n = dims[axis];
    const count = spans[axis].length;
    const outer = low.length / (n * stride);
    const newLow = sameKind(low, outer * count * stride);
    const newHigh = sameKind(high, outer * count * stride);
    for (let o = 0; o < outer; ++o) {
      for (let k = 0; k < count; ++k) {
        const [first, end] = spans[axis][k];
        for (let i = 0; i < stride; ++i) {
          let least = Infinity;
          let most = -Infinity;
          for (let j = first; j < end; ++j) {
            const at = (o * n + j) * stride + i;
            if (low[at] < least) least = low[at];
            if (high[at] > most) most = high[at];
          }
          newLow[(o * count + k) * stride + i] = least;
          newHigh[(o * count + k) * stride + i] = most;
        }
      }
    }
    low = newLow;
    high = newHigh;
    dims[axis] = count;
    stride *= count;
  }
  return { low, high, dims };
}

function boundsTexture({ low, high, dims }: Bounds): three.Data3DTexture {
  const pairs = sameKind(low, 2 * low.length);
  low.forEach((value, i) => {
    pairs[2 * i] = value;
    pairs[2 * i + 1] = high[i];
  });
  return integerTexture(pairs, dims, three.RGIntegerFormat);
}

export function integerTexture(
  data: Codes,
  [nx, ny, nz]: Vector,
  format: three.PixelFormat,
): three.Data3DTexture {
  const texture = new three.Data3DTexture(data, nx, ny, nz);
  const isByte = data instanceof Uint8Array;
  texture.format = format;
  texture.type = isByte ? three.UnsignedByteType : three.UnsignedShortType;
  const channels = format === three.RGBAIntegerFormat ? 'RGBA' : 'RG';
  texture.internalFormat = `${channels}${isByte ? '8' : '16'}UI` as three.PixelFormatGPU;
  texture.unpackAlignment = 1;
  return given(texture);
}

// A texture for the graphics card only; its copy here is freed.
export function given(texture: three.Data3DTexture): three.Data3DTexture {
  texture.onUpdate = () => {
    texture.image.data = null;
  };
  texture.needsUpdate = true;
  return texture;
}

function sameKind(codes: Codes, length: number): Codes {
  return codes instanceof Uint8Array ? new Uint8Array(length) : new Uint16Array(length);
}
