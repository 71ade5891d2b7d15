// SPDX-License-Identifier: GPL-3.0-or-later
// How an isosurface looks in place of the albedo of its bake: named looks and color maps.

import type { Header, NamedLook, Vector } from './bake';
import { digitsOf, linearAt, namesOf } from './color_maps';

const MATTE: [number, number] = [0, 1];

// The elements of a menu: (key, name).
export function lookNames(header: Header): [string, string][] {
  const looks = Object.entries(header.looks).map(([key, { name }]): [string, string] => [key, name]);
  return [...looks, ...namesOf(header)];
}

function named(key: string | null, { looks }: Header): NamedLook | null {
  return key !== null && key in looks ? looks[key] : null;
}

// The linear albedo at a share, 0..1, of the isovalues; null for that of the bake.
export function albedoOf(key: string | null, share: number, header: Header): Vector | null {
  if (key === null) return null;
  return named(key, header)?.color ?? linearAt(key, share, header);
}

// Gloss and roughness of the coat.
export function coatOf(key: string | null, header: Header): [number, number] {
  const look = named(key, header);
  return look === null ? MATTE : [look.gloss, look.roughness];
}

// As style sheets have it; empty for that of the page.
export function backgroundOf(key: string | null, header: Header): string {
  const background = named(key, header)?.background ?? null;
  return background === null ? '' : `#${digitsOf(background)}`;
}
