// SPDX-License-Identifier: GPL-3.0-or-later
// The displayed state as plain data: the interface changes it, the view draws it, the link saves
// it.

import type { Header, Vector } from './bake';
import { GRAY } from './color_maps';
import { onGrid } from './isovalues';
import { bakedLamps } from './lamps';

// From an end of an axis of the bounds, by its number: the lower and the upper one of x, y and z.
export interface Clip {
  from: number;
  share: number; // 0..1 of the axis, which is left out
}

// One of the isosurfaces that are shown together.
export interface Shown {
  isovalue: number; // a common isovalue
  opacity: number; // 0..1
  colors: string | null; // key of a named look or of a color map, null for the albedo of the bake
}

export const MOST_SHOWN = 8; // MOST of light.glsl

export interface Look {
  isosurfaces: Shown[]; // the first is that of the main slider, whose light the walls have
  isLocal: boolean;
  showsWalls: boolean;
  clip: Clip | null;
  slices: Slices;
  sliceColors: string; // of slices and of what is cut open: a color map's key, or GRAY
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
    isosurfaces: [{ isovalue: onGrid(header.isovalue, header), opacity: 1, colors: null }],
    isLocal: false,
    showsWalls: true,
    clip: null,
    slices: [null, null, null],
    sliceColors: GRAY,
    stops: header.stops,
    lamps: bakedLamps(header),
  };
}

// With one more isosurface: translucent, in front of those that there are.
export function withOneMore(isosurfaces: Shown[], header: Header): Shown[] {
  const [low] = header.isovalueRange;
  const lowest = Math.min(...isosurfaces.map(({ isovalue }) => isovalue));
  const isovalue = onGrid(low + 0.25 * (lowest - low), header);
  return [...isosurfaces, { isovalue, opacity: 0.35, colors: null }];
}

// Returns the clipping plane. Points below the distance along the normal are cut away.
export function clipPlane(clip: Clip, bounds: [Vector, Vector]): { normal: Vector; distance: number } {
  const axis = clip.from >> 1;
  const sign = clip.from % 2 === 0 ? 1 : -1;
  const ends = bounds.map((point) => sign * point[axis]);
  const [near, far] = [Math.min(...ends), Math.max(...ends)];
  const normal: Vector = [0, 0, 0];
  normal[axis] = sign;
  return { normal, distance: near + clip.share * (far - near) };
}
