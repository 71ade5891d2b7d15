// SPDX-License-Identifier: GPL-3.0-or-later
// Colors with a shared exponent, in the planes of python/leaflight/export/shared_exponent.py.

import type { Vector } from './bake';

export function colorWords(planes: Uint8Array): Uint32Array<ArrayBuffer> {
  const count = planes.length / 4;
  const words = new Uint32Array(count);
  for (let i = 0; i < count; ++i) {
    const green = planes[i];
    const red = (planes[count + i] + green) & 255;
    const blue = (planes[2 * count + i] + green) & 255;
    const high = planes[3 * count + i];
    words[i] =
      ((high >> 3) << 27) |
      (blue << 18) | ((high & 4) << 24) |
      (green << 9) | ((high & 2) << 16) |
      red | ((high & 1) << 8); // prettier-ignore
  }
  return words;
}

// Adds shares of such colors by channel, starting at the first one.
export function addColors(
  colors: Float32Array,
  words: Uint32Array,
  first: number,
  [red, green, blue]: Vector,
): void {
  for (let i = 0, at = 0; at < colors.length; ++i) {
    const word = words[first + i];
    const scale = 2 ** ((word >>> 27) - 24);
    colors[at++] += red * scale * (word & 511);
    colors[at++] += green * scale * ((word >>> 9) & 511);
    colors[at++] += blue * scale * ((word >>> 18) & 511);
  }
}
