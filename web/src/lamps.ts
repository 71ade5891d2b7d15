// SPDX-License-Identifier: GPL-3.0-or-later
// The lamps at strengths that differ from the bake, and the lamps of local shading
// (python/leaflight/bake/relit.py).

import * as three from 'three';

import type { Header, Vector } from './bake';
import { digitsOf, linear } from './color_maps';
import type { Lamp } from './look';

const MOST_NUMBERS = 48; // three vectors for each of 16 lamps
const UNCHANGED: Vector = [1, 1, 1];

// Returns the lamps at the strengths of the bake.
export function bakedLamps(header: Header): Lamp[] {
  return header.lights.lamps.map(() => ({ strength: 1, color: null }));
}

// Returns the factor on the strength of each lamp in the bake, by channel. A channel that was 0
// stays 0.
export function factorsOf(lamps: Lamp[], header: Header): Vector[] {
  return lamps.map(({ strength, color }, k) => {
    if (color === null) return [strength, strength, strength];
    const baked = header.lights.lamps[k].color;
    const most = Math.max(...baked);
    return channels(color).map((x, i) => (baked[i] > 0 ? (strength * x * most) / baked[i] : 0)) as Vector;
  });
}

// Returns the factor of a lamp by its number, 1 for other emitters.
export function factorAt(factors: Vector[], lamp: number): Vector {
  return factors[lamp] ?? UNCHANGED;
}

// Returns the factor on indirect light.
export function indirectFactor(factors: Vector[], { lights }: Header): Vector {
  return lights.others.map((others, i) =>
    lights.lamps.reduce((sum, { share }, k) => sum + share[i] * factors[k][i], others),
  ) as Vector;
}

export function lampUniforms(header: Header): Record<string, three.IUniform> {
  return {
    ambient: { value: header.ambient },
    lampCount: { value: header.headlight ? -1 : header.lamps.length },
    lamps: { value: lampVectors(header, []) },
    exposure: { value: header.exposure },
  };
}

// Returns the uniforms of lamps.glsl.
export function lampVectors(header: Header, factors: Vector[]): three.Vector4[] {
  const lamps = header.lamps.flatMap(([lamp, ...row]) => {
    const [position, axis, intensity] = [0, 4, 8].map((k) => new three.Vector4().fromArray(row, k));
    intensity.multiply(new three.Vector4(...factorAt(factors, lamp), 1));
    return [position, axis, intensity];
  });
  while (lamps.length < MOST_NUMBERS) lamps.push(new three.Vector4());
  return lamps;
}

// Returns the brightest displayable color of this hue as six hexadecimal digits of sRGB.
export function hueOf(color: Vector): string {
  const most = Math.max(...color, 1e-30);
  return digitsOf(color.map((x) => Math.max(x, 0) / most) as Vector);
}

function channels(color: string): Vector {
  return [0, 2, 4].map((k) => linear(parseInt(color.slice(k, k + 2), 16) / 255)) as Vector;
}
