// SPDX-License-Identifier: GPL-3.0-or-later
// Isovalues as the controls have them: within the isovalue range, by the steps of the bake, as text.

export interface Steps {
  isovalueRange: [number, number]; // common isovalues
  step: number; // a power of ten
}

function clamped(isovalue: number, { isovalueRange: [low, high] }: Steps): number {
  return Math.min(high, Math.max(low, isovalue));
}

// The nearest isovalue that the controls can choose.
export function onGrid(isovalue: number, steps: Steps): number {
  const rounded = Math.round(isovalue / steps.step) * steps.step;
  return clamped(Number(rounded.toFixed(decimals(steps))), steps);
}

export function textOf(isovalue: number, steps: Steps): string {
  return isovalue.toFixed(decimals(steps));
}

function decimals({ step }: Steps): number {
  return Math.min(20, Math.max(0, Math.round(-Math.log10(step))));
}
