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
  const numbers = ranks(await bake.block(data.active, 1), data.texels);
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
              if (numbers[row + x] === 0) continue;
              from[count] = numbers[row + x] - 1;
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

// Returns the number of active texels up to each active texel, and 0 for the others.
function ranks(active: Uint8Array, [nx, ny, nz]: Vector): Uint32Array {
  const numbers = new Uint32Array(nx * ny * nz);
  let count = 0;
  for (let i = 0; i < numbers.length; ++i) {
    if ((active[i >> 3] >> (i & 7)) & 1) numbers[i] = ++count;
  }
  return numbers;
}
