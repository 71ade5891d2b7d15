// SPDX-License-Identifier: GPL-3.0-or-later
// Materials that replace the albedo of the bake: named looks and color maps.

import type { Header, NamedLook, Vector } from './bake';
import { digitsOf, linearAt, namesOf } from './color_maps';

const MATTE: [number, number] = [0, 1];

// Entries of a menu: (key, name).
export function lookNames(header: Header): [string, string][] {
  const looks = Object.entries(header.looks).map(([key, { name }]): [string, string] => [key, name]);
  return [...looks, ...namesOf(header)];
}

function named(key: string | null, { looks }: Header): NamedLook | null {
  return key !== null && key in looks ? looks[key] : null;
}

// Returns the linear albedo at a share, 0..1, of the isovalue range; null for that of the bake.
export function albedoOf(key: string | null, share: number, header: Header): Vector | null {
  if (key === null) return null;
  return named(key, header)?.color ?? linearAt(key, share, header);
}

// Returns gloss and roughness of the coat.
export function coatOf(key: string | null, header: Header): [number, number] {
  const look = named(key, header);
  return look === null ? MATTE : [look.gloss, look.roughness];
}

// Returns the background as a CSS color; empty for that of the page.
export function backgroundOf(key: string | null, header: Header): string {
  const background = named(key, header)?.background ?? null;
  return background === null ? '' : `#${digitsOf(background)}`;
}
