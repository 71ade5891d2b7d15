// SPDX-License-Identifier: GPL-3.0-or-later
// The displayed state as plain data: the interface changes it, the view draws it, the link saves
// it.

import type { Header, Vector } from './bake';
import { GRAY } from './color_maps';
import { onGrid } from './isovalues';
import { bakedLamps } from './lamps';

// A clipping plane. side: number of an end of an axis of the bounds: lower and upper of x, y and z.
export interface Clip {
  from: number;
  share: number; // share of the axis that is cut away, 0..1
}

// One of the isosurfaces that are shown together.
export interface Shown {
  isovalue: number; // a common isovalue
  opacity: number; // 0..1
  colors: string | null; // key of a look or a color map; null: albedo of the bake
}

export const MOST_SHOWN = 8; // MOST of light.glsl

export interface Look {
  isosurfaces: Shown[]; // the first has the main slider and lights the walls
  isLocal: boolean;
  showsWalls: boolean;
  clip: Clip | null;
  slices: Slices;
  sliceColors: string; // of slices and cuts: key of a color map, or GRAY
  stops: number; // further stops of exposure
  lamps: Lamp[]; // those of header.lights
}

export interface Lamp {
  strength: number; // factor on the strength in the bake
  color: string | null; // six hexadecimal digits of sRGB; null: color of the bake
}

// Slices across the axes of the bounds: position of each as a share, 0..1; null for none.
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

// Adds an isosurface: translucent, in front of the others.
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
