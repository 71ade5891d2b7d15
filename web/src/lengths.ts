// SPDX-License-Identifier: GPL-3.0-or-later
// Lengths in the world, as text.

// Returns the largest of 1, 2 and 5 times a power of ten that is not above a length.
export function roundLength(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  const digit = [5, 2, 1].find((times) => times * power <= most * (1 + 1e-9)) ?? 1;
  return Number((digit * power).toPrecision(1));
}

export function lengthText(length: number, unit: string, digits = 4): string {
  return `${Number(length.toPrecision(digits))}${unit === '' ? ' units of the file' : ` ${unit}`}`;
}
