// SPDX-License-Identifier: GPL-3.0-or-later
// The lamps of local shading, as uniforms of lamps.glsl.

import * as three from 'three';

import type { Header } from './bake';

const MOST_NUMBERS = 48; // of vectors: three for each of 16 lamps

export function lampUniforms(header: Header): Record<string, three.IUniform> {
  const lamps = header.lamps.flatMap((row) =>
    [0, 4, 8].map((k) => new three.Vector4().fromArray(row, k)),
  );
  while (lamps.length < MOST_NUMBERS) lamps.push(new three.Vector4());
  return {
    ambient: { value: header.ambient },
    lampCount: { value: header.headlight ? -1 : header.lamps.length },
    lamps: { value: lamps },
    exposure: { value: header.exposure },
  };
}
