// SPDX-License-Identifier: GPL-3.0-or-later
// Color maps: those of the header, and gray.

import type { Header, Vector } from './bake';

export const GRAY = 'GRAY';
export const COLORS = 9;

export function namesOf({ colorMaps }: Header): [string, string][] {
  return Object.entries(colorMaps).map(([key, [name]]) => [key, name]);
}

// Displayed colors, 0..1. Gray has neither black nor white, which lighting uses.
export function colorsOf(key: string, { colorMaps }: Header): Vector[] {
  if (!(key in colorMaps)) {
    return Array.from({ length: COLORS }, (_, i) => {
      const gray = 0.15 + (0.7 * i) / (COLORS - 1);
      return [gray, gray, gray];
    });
  }
  const byte = (color: string, k: number) => parseInt(color.slice(2 * k, 2 * k + 2), 16) / 255;
  return colorMaps[key].slice(1).map((color) => [byte(color, 0), byte(color, 1), byte(color, 2)]);
}

// Returns the linear color at a share, 0..1, of the isovalue range.
export function linearAt(key: string, share: number, header: Header): Vector {
  const colors = colorsOf(key, header);
  const at = Math.min(1, Math.max(0, share)) * (COLORS - 1);
  const low = Math.min(Math.floor(at), COLORS - 2);
  return [0, 1, 2].map((k) => {
    const [before, after] = [colors[low][k], colors[low + 1][k]].map(linear);
    return before + (at - low) * (after - before);
  }) as Vector;
}

// Returns a linear color, 0..1, as six hexadecimal digits of sRGB.
export function digitsOf(color: Vector): string {
  const digits = color.map((share) => {
    const curve = share <= 0.0031308 ? 12.92 * share : 1.055 * share ** (1 / 2.4) - 0.055;
    return Math.round(255 * curve).toString(16).padStart(2, '0');
  }); // prettier-ignore
  return digits.join('');
}

export function linear(displayed: number): number {
  return displayed <= 0.04045 ? displayed / 12.92 : ((displayed + 0.055) / 1.055) ** 2.4;
}
