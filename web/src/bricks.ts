// SPDX-License-Identifier: GPL-3.0-or-later
// The active texels of a grid in a texture of bricks. Neighbors share layers of texels, and bricks
// without active texels are left out (python/leaflight/export/light_bricks.py).

import * as three from 'three';

import type { Bake, BrickData, Vector } from './bake';
import { integerTexture } from './volume_textures';

export interface Bricks {
  table: three.Data3DTexture; // position of each brick in the texture
  // Numbers of active texels, repeated for each brick that holds them, and their positions.
  from: Uint32Array;
  to: Uint32Array;
}

// Texels along each axis of a texture. Layers are stacked along z.
export function textureSize(data: BrickData, layers = 1): Vector {
  const [x, y, z] = data.brick.map((n, a) => n * data.textureBricks[a]);
  return [x, y, z * layers];
}

export async function bricksOf(bake: Bake, data: BrickData): Promise<Bricks> {
  const places = await bake.block(data.table, 1);
  const active = await bake.block(data.active, 1);
  const before = counts(active);
  const [nx, ny, nz] = data.texels;
  const [bx, by, bz] = data.brick;
  const [sx, sy, sz] = textureSize(data);
  const from = new Uint32Array(sx * sy * sz);
  const to = new Uint32Array(sx * sy * sz);
  let count = 0;
  let entry = 0;
  for (let k = 0; k < data.bricks[2]; ++k) {
    for (let j = 0; j < data.bricks[1]; ++j) {
      for (let i = 0; i < data.bricks[0]; ++i, entry += 4) {
        if (places[entry + 3] === 0) continue;
        const low = [i * (bx - 1), j * (by - 1), k * (bz - 1)];
        const first = [places[entry] * bx, places[entry + 1] * by, places[entry + 2] * bz];
        for (let z = 0; z < Math.min(bz, nz - low[2]); ++z) {
          for (let y = 0; y < Math.min(by, ny - low[1]); ++y) {
            const row = ((low[2] + z) * ny + low[1] + y) * nx + low[0];
            const place = ((first[2] + z) * sy + first[1] + y) * sx + first[0];
            for (let x = 0; x < Math.min(bx, nx - low[0]); ++x) {
              const byte = active[(row + x) >> 3];
              const bit = (row + x) & 7;
              if (((byte >> bit) & 1) === 0) continue;
              from[count] = before[(row + x) >> 3] + ones(byte & ((1 << bit) - 1));
              to[count++] = place + x;
            }
          }
        }
      }
    }
  }
  return {
    table: integerTexture(places, data.bricks, three.RGBAIntegerFormat),
    from: from.subarray(0, count),
    to: to.subarray(0, count),
  };
}

// Returns the number of active texels before each byte.
function counts(active: Uint8Array): Uint32Array {
  const before = new Uint32Array(active.length);
  for (let i = 1; i < active.length; ++i) before[i] = before[i - 1] + ones(active[i - 1]);
  return before;
}

// Returns the number of ones in a byte.
function ones(byte: number): number {
  let count = 0;
  for (let rest = byte; rest !== 0; rest &= rest - 1) ++count;
  return count;
}
