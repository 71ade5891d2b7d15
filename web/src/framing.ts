// SPDX-License-Identifier: GPL-3.0-or-later
// The first position of the camera (python/leaflight/stills/first_view.py).

import type { Vector } from './bake';

export interface Framing {
  target: Vector;
  back: Vector; // unit vector from the target to the viewer
  up: Vector;
  half: Vector; // half extents to the right, up and towards the viewer
  angle: number; // angle of view across the shorter side, in degrees
  filled: number; // share of the picture that the isosurface fills
}

export function positionOf(framing: Framing, width: number, height: number): Vector {
  const { target, back, half, angle, filled } = framing;
  const tangent = Math.tan((0.5 * angle * Math.PI) / 180) / Math.min(width, height);
  const distance = half[2] + Math.max(half[0] / width, half[1] / height) / tangent / filled;
  return target.map((x, a) => x + distance * back[a]) as Vector;
}
