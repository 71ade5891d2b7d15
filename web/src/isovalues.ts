// SPDX-License-Identifier: GPL-3.0-or-later
// Isovalues of the controls, as numbers and text: within the isovalue range, by its steps.

export interface Steps {
  isovalueRange: [number, number]; // common isovalues
  step: number; // a power of ten
}

export function clamped(isovalue: number, { isovalueRange: [low, high] }: Steps): number {
  return Math.min(high, Math.max(low, isovalue));
}

// Returns the nearest isovalue that the controls can choose.
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
