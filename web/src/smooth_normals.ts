// SPDX-License-Identifier: GPL-3.0-or-later
// Smoothed values, whose gradients are the normals of isosurfaces, as in
// python/leaflight/volume/smoothing.py.

import type { VolumeData } from './bake';
import type { Codes } from './volume_textures';

const REACH = 3; // cutoff radius in standard deviations
const NO_DATA = 65535;

// Codes of smooth values per code of the volume.
export function smoothPerCode(bits: 8 | 16): number {
  return bits === 8 ? 256 : 1;
}

// Returns codes of 16 bits. Missing data stay missing, and capping layers keep their values.
export function smoothCodes(codes: Codes, data: VolumeData): Codes {
  const perCode = smoothPerCode(data.bits);
  const isKnown = (code: number) => !(data.masked && code === NO_DATA);
  const blur = (share: (code: number) => number) =>
    blurred(
      Float32Array.from(codes, (code) => (isKnown(code) ? share(code) : 0)),
      data,
    );
  const sums = blur((code) => code);
  const weights = data.masked ? blur(() => 1) : null;
  const isInLayer = layerTest(data);
  return Uint16Array.from(codes, (code, i) => {
    if (!isKnown(code)) return NO_DATA;
    if (isInLayer(i)) return perCode * code;
    return Math.round((perCode * sums[i]) / (weights ? weights[i] : 1));
  });
}

function layerTest({ dims, layers }: VolumeData): (voxel: number) => boolean {
  return (voxel) =>
    layers > 0 &&
    dims.some((count) => {
      const at = voxel % count;
      voxel = Math.floor(voxel / count);
      return at < layers || at >= count - layers;
    });
}

function blurred(values: Float32Array, { dims, smoothNormals, layers }: VolumeData): Float32Array {
  const reach = Math.ceil(REACH * smoothNormals);
  const weights = Array.from({ length: 2 * reach + 1 }, (_, k) =>
    Math.exp(-0.5 * ((k - reach) / smoothNormals) ** 2),
  );
  const total = weights.reduce((sum, weight) => sum + weight, 0);
  let stride = 1;
  for (const count of dims) {
    const next = new Float32Array(values.length);
    for (let i = 0; i < values.length; ++i) {
      const at = Math.floor(i / stride) % count;
      let sum = 0;
      for (let k = -reach; k <= reach; ++k) {
        const other = Math.min(Math.max(at + k, layers), count - 1 - layers);
        sum += weights[k + reach] * values[i + (other - at) * stride];
      }
      next[i] = sum / total;
    }
    values = next;
    stride *= count;
  }
  return values;
}
