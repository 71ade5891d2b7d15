// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the state of the page into the fragment of its link, and reads it.

import type { Header, Vector } from './bake';
import { GRAY } from './color_maps';
import { onGrid } from './isovalues';
import { bakedLamps } from './lamps';
import { type Lamp, type Look, MOST_SHOWN, type Shown, type Slices } from './look';

export interface Viewpoint {
  position: Vector;
  target: Vector;
  up: Vector;
}

export interface State {
  look: Look;
  viewpoint: Viewpoint;
}

const DIGITS = 6;
export const STRONGEST = 4; // factor on a lamp's strength in the bake

export function toLink({ look, viewpoint }: State): string {
  const numbers = (...values: number[]) =>
    values.map((value) => Number(value.toPrecision(DIGITS))).join(',');
  const fields: [string, string | null][] = [
    // Values of all isosurfaces, separated by commas.
    ['isovalue', numbers(...look.isosurfaces.map(({ isovalue }) => isovalue))],
    ['opacity', isOpaque(look) ? null : numbers(...look.isosurfaces.map(({ opacity }) => opacity))],
    ['colors', isOfBake(look) ? null : look.isosurfaces.map(({ colors }) => colors ?? '').join(',')],
    ['local', look.isLocal ? '1' : null],
    ['walls', look.showsWalls ? null : '0'],
    ['clip', look.clip === null ? null : numbers(look.clip.from, look.clip.share)],
    ['slices', look.slices.every((place) => place === null) ? null : slicesText(look.slices)],
    ['slicecolors', look.sliceColors === GRAY ? null : look.sliceColors],
    ['exposure', numbers(look.stops)],
    ['lamps', look.lamps.every(isAsBaked) ? null : look.lamps.map(lampText).join(',')],
    ['camera', numbers(...viewpoint.position, ...viewpoint.target, ...viewpoint.up)],
  ];
  return fields.flatMap(([name, value]) => (value === null ? [] : [`${name}=${value}`])).join('&');
}

// Reads the state from a link. Missing or invalid fields keep the given state.
export function fromLink(link: string, { look, viewpoint }: State, header: Header): State {
  const fields = new URLSearchParams(link.replace(/^#/, ''));
  const numbers = (name: string, count: number): number[] | null => {
    const found = (fields.get(name) ?? '').split(',').map((text) => (text === '' ? NaN : Number(text)));
    return found.length === count && found.every(Number.isFinite) ? found : null;
  };
  const one = (name: string, low: number, high: number): number | null => {
    const found = numbers(name, 1);
    return found && Math.min(high, Math.max(low, found[0]));
  };
  const clip = numbers('clip', 2);
  const sliceColors = fields.get('slicecolors') ?? '';
  const camera = numbers('camera', 9);
  return {
    look: {
      isosurfaces: isosurfacesOf(fields, header) ?? look.isosurfaces,
      isLocal: fields.get('local') === '1',
      showsWalls: fields.get('walls') !== '0',
      clip: clip && [0, 1, 2, 3, 4, 5].includes(clip[0]) ? { from: clip[0], share: share(clip[1]) } : null,
      slices: slicesOf(fields.get('slices')),
      sliceColors: sliceColors in header.colorMaps ? sliceColors : GRAY,
      stops: one('exposure', -4, 4) ?? look.stops,
      lamps: lampsOf(fields.get('lamps'), header) ?? bakedLamps(header),
    },
    viewpoint: camera && isViewpoint(camera) ? viewpointOf(camera) : viewpoint,
  };
}

function isOpaque({ isosurfaces }: Look): boolean {
  return isosurfaces.every(({ opacity }) => opacity === 1);
}

function isOfBake({ isosurfaces }: Look): boolean {
  return isosurfaces.every(({ colors }) => colors === null);
}

function isosurfacesOf(fields: URLSearchParams, header: Header): Shown[] | null {
  const list = (name: string) => fields.get(name)?.split(',') ?? [];
  const [opacities, colors] = [list('opacity'), list('colors')];
  const number = (text: string | undefined) => (text ? Number(text) : NaN);
  const shown = list('isovalue').map((text, k) => {
    const [isovalue, opacity, key] = [number(text), number(opacities[k]), colors[k] ?? ''];
    return {
      isovalue: Number.isFinite(isovalue) ? onGrid(isovalue, header) : NaN,
      opacity: Number.isFinite(opacity) ? share(opacity) : 1,
      colors: key in header.looks || key in header.colorMaps ? key : null,
    };
  });
  const isValid = shown.length > 0 && shown.every(({ isovalue }) => Number.isFinite(isovalue));
  return isValid ? shown.slice(0, MOST_SHOWN) : null;
}

function isAsBaked({ strength, color }: Lamp): boolean {
  return strength === 1 && color === null;
}

// The text is 0.5,ffd8a0 or, with the color of the bake, 0.5,
function lampText({ strength, color }: Lamp): string {
  return `${Number(strength.toPrecision(DIGITS))},${color ?? ''}`;
}

function lampsOf(text: string | null, header: Header): Lamp[] | null {
  const fields = (text ?? '').split(',');
  const lamps = header.lights.lamps.map((_, k) => {
    const [strength, color] = [fields[2 * k], fields[2 * k + 1]];
    const number = strength ? Number(strength) : NaN;
    if (!Number.isFinite(number) || !/^([\da-f]{6})?$/.test(color)) return null;
    return { strength: Math.min(STRONGEST, Math.max(0, number)), color: color || null };
  });
  return fields.length === 2 * lamps.length && lamps.every((lamp) => lamp !== null) ? lamps : null;
}

function slicesText(slices: Slices): string {
  return slices.map((place) => (place === null ? '' : Number(place.toPrecision(DIGITS)))).join(',');
}

function slicesOf(text: string | null): Slices {
  const places = (text ?? '').split(',').map((place) => (place === '' ? NaN : Number(place)));
  return [0, 1, 2].map((a) => (Number.isFinite(places[a]) ? share(places[a]) : null)) as Slices;
}

function share(value: number): number {
  return Math.min(1, Math.max(0, value));
}

function viewpointOf(numbers: number[]): Viewpoint {
  const [position, target, up] = [0, 3, 6].map((k) => numbers.slice(k, k + 3) as Vector);
  return { position, target, up };
}

// Returns true if the camera has a direction that is not its upright axis.
function isViewpoint(numbers: number[]): boolean {
  const { position, target, up } = viewpointOf(numbers);
  const [x, y, z] = position.map((place, a) => place - target[a]);
  const across = Math.hypot(y * up[2] - z * up[1], z * up[0] - x * up[2], x * up[1] - y * up[0]);
  return across > 1e-9 * Math.hypot(x, y, z) * Math.hypot(...up) && Math.hypot(...up) > 0;
}
