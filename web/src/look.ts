// SPDX-License-Identifier: GPL-3.0-or-later
// What is shown, as plain data: the interface changes it, the view draws it.

import type { Header, Vector } from './bake';

export interface Look {
  isovalue: number; // leaf coordinates
  second: number | null; // of the transparent isosurface in front
  opacity: number; // its share, 0..1
  isLocal: boolean;
  showsWalls: boolean;
  clip: { normal: Vector; distance: number } | null; // what is below the distance is left out
  stops: number; // of exposure, beside the bake's
  countsFetches: boolean;
}

export function firstLook(header: Header): Look {
  return {
    isovalue: header.isovalue,
    second: null,
    opacity: 0.35,
    isLocal: false,
    showsWalls: true,
    clip: null,
    stops: 0,
    countsFetches: false,
  };
}
