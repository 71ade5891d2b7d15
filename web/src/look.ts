// SPDX-License-Identifier: GPL-3.0-or-later
// What is shown, as plain data: the interface changes it, the view draws it, the link keeps it.

import type { Header, Vector } from './bake';
import { GRAY } from './color_maps';
import { onGrid } from './isovalues';
import { bakedLamps } from './lamps';

// From an end of an axis of the bounds, by its number: the lower and the upper one of x, y and z.
export interface Clip {
  from: number;
  share: number; // 0..1 of the axis, which is left out
}

export interface Look {
  isovalue: number; // common isovalues
  second: number | null; // of the transparent isosurface in front
  opacity: number; // its share, 0..1
  isLocal: boolean;
  showsWalls: boolean;
  clip: Clip | null;
  slices: Slices;
  sliceColors: string; // of slices and of what is cut open: a color map's key, or GRAY
  isosurfaceColors: string | null; // a color map's key, null for the albedo of the bake
  stops: number; // of exposure, beside the bake's
  lamps: Lamp[]; // those of header.lights
}

export interface Lamp {
  strength: number; // over that of the bake
  color: string | null; // sRGB, six hexadecimal digits; null for that of the bake
}

// Planes across the axes of the bounds: the share, 0..1, at which each is, null for none.
export type Slices = [number | null, number | null, number | null];

export function firstLook(header: Header): Look {
  return {
    isovalue: onGrid(header.isovalue, header),
    second: null,
    opacity: 0.35,
    isLocal: false,
    showsWalls: true,
    clip: null,
    slices: [null, null, null],
    sliceColors: GRAY,
    isosurfaceColors: null,
    stops: header.stops,
    lamps: bakedLamps(header),
  };
}

// What is below the distance along the normal is left out.
export function clipPlane(clip: Clip, bounds: [Vector, Vector]): { normal: Vector; distance: number } {
  const axis = clip.from >> 1;
  const sign = clip.from % 2 === 0 ? 1 : -1;
  const ends = bounds.map((point) => sign * point[axis]);
  const [near, far] = [Math.min(...ends), Math.max(...ends)];
  const normal: Vector = [0, 0, 0];
  normal[axis] = sign;
  return { normal, distance: near + clip.share * (far - near) };
}
