// SPDX-License-Identifier: GPL-3.0-or-later
// The bake in the page, as core/leaflight/export/page_data.py wrote it.

import { Failure } from './failure';

export type Vector = [number, number, number];
export type Stops = [number, Vector][];

// Texels of a texture of bricks, from the first voxel to the last.
export interface BrickData {
  texels: Vector;
  active: number; // block: a bit for each texel, the lowest one first
  brick: Vector; // texels of a brick, with the layers that it shares
  bricks: Vector;
  table: number; // block: where each brick is in the texture
  textureBricks: Vector;
}

export interface LightData extends BrickData {
  outer: number; // blocks: radiance times the exposure
  inner: number | null;
}

export interface DirectData extends BrickData {
  outer: number[]; // blocks: levels of two light points each
  inner: number[] | null;
  points: number[][]; // as DirectLight.light_points of the core lists them
  indexToFrame: number[]; // 4 x 4, by rows
}

export interface VolumeData {
  name: string;
  dims: Vector; // voxels along x, y, z
  indexToWorld: number[]; // 4 x 4, by rows
  isovalues: [number, number]; // in data units, at leaf coordinates 0 and 1
  values: number; // block: codes, a value being offset + scale * code
  bits: 8 | 16;
  masked: boolean;
  offset: number;
  scale: number;
  light: LightData;
  direct: DirectData | null; // beside which texels hold indirect light; null: they hold all
  innerIs: 'baked' | 'dark' | 'local';
  albedo: Stops;
  emission: Stops;
}

export interface WallData {
  name: string;
  isOfRoom: boolean;
  vertices: number; // blocks
  triangles: number;
  between: number; // of each vertex, two coarser ones
  // Of the front and the back, radiance times the exposure: indirect light of the coarser vertices
  // at each node, and direct light if nothing stood in its way.
  indirect: (number | null)[];
  unshadowed: (number | null)[];
  // Of each vertex its set of light points, and by point and vertex the greatest code on the way
  // and how much light comes by it, negative on the back.
  sets: number;
  greatest: number;
  weights: number;
}

export interface WallsData {
  nodes: number[]; // leaf coordinates of indirect light
  tints: number[][][]; // of each set's light points
  meshes: WallData[];
}

export interface Header {
  format: number;
  title: string;
  window: [number, number]; // leaf coordinates
  isovalue: number;
  exposure: number;
  camera: { position: Vector; target: Vector; up: Vector; angle: number };
  bounds: [Vector, Vector];
  volumes: VolumeData[];
  walls: WallsData;
  lamps: number[][]; // as lamps.py lists them
  ambient: Vector;
  headlight: boolean;
  histogram: number[];
  about: [string, string][];
  blocks: [number, number, number][]; // first byte, bytes, bytes when inflated
}

const FORMAT = 2;
const DAMAGED = 'The data in this page are damaged or not whole: fetch or export it again.';

export class Bake {
  private constructor(
    readonly header: Header,
    private readonly body: Uint8Array,
  ) {}

  // Of the elements of the page, or of bake.bin beside it.
  static async read(): Promise<Bake> {
    const text = document.getElementById('leaflight-header')?.textContent;
    let header: Header;
    try {
      header = JSON.parse(text ?? '') as Header;
    } catch {
      throw new Failure(DAMAGED);
    }
    if (header.format !== FORMAT) {
      throw new Failure('This page holds a bake of another version: export it again.');
    }
    const body = document.getElementById('leaflight-body');
    return new Bake(header, body ? decoded(body.textContent) : await fetched('bake.bin'));
  }

  // The numbers of a block, `size` bytes each, in the order of this machine.
  async block(number: number, size: 1 | 2 | 4): Promise<Uint8Array<ArrayBuffer>> {
    const [first, length, whole] = this.header.blocks[number];
    let planes: Uint8Array;
    try {
      const inflated = new Blob([this.body.slice(first, first + length)])
        .stream()
        .pipeThrough(new DecompressionStream('deflate'));
      planes = new Uint8Array(await new Response(inflated).arrayBuffer());
    } catch {
      throw new Failure(DAMAGED);
    }
    if (planes.length !== whole) throw new Failure(DAMAGED);
    return fromPlanes(planes, size);
  }
}

// Bytes of like significance were written side by side.
function fromPlanes(planes: Uint8Array, size: number): Uint8Array<ArrayBuffer> {
  const count = planes.length / size;
  const bytes = new Uint8Array(planes.length);
  for (let plane = 0; plane < size; ++plane) {
    const first = plane * count;
    for (let i = 0, at = plane; i < count; ++i, at += size) bytes[at] = planes[first + i];
  }
  return bytes;
}

// Not in all browsers yet.
interface FromBase64 {
  fromBase64?: (text: string) => Uint8Array;
}

// Of base64, by parts, since a string of all bytes would take twice the memory.
function decoded(text: string): Uint8Array {
  try {
    const whole = (Uint8Array as FromBase64).fromBase64?.(text);
    if (whole) return whole;
  } catch {
    throw new Failure(DAMAGED);
  }
  const part = 1 << 20; // a multiple of four characters
  const bytes = new Uint8Array(Math.floor((text.length * 3) / 4));
  let at = 0;
  try {
    for (let first = 0; first < text.length; first += part) {
      const binary = atob(text.slice(first, first + part));
      for (let i = 0; i < binary.length; ++i) bytes[at++] = binary.charCodeAt(i);
    }
  } catch {
    throw new Failure(DAMAGED);
  }
  return bytes.subarray(0, at);
}

async function fetched(name: string): Promise<Uint8Array> {
  try {
    const answer = await fetch(name);
    if (!answer.ok) throw new Error(answer.statusText);
    return new Uint8Array(await answer.arrayBuffer());
  } catch {
    throw new Failure(
      `The file ${name} beside this page cannot be read: put both on a web server, ` +
        'or export one file.',
    );
  }
}

// The color of a ramp at an isovalue, in data units.
export function rampAt(stops: Stops, isovalue: number): Vector {
  const next = stops.findIndex(([at]) => at > isovalue);
  if (next === 0 || stops.length === 1) return stops[0][1];
  if (next < 0) return stops[stops.length - 1][1];
  const [[low, from], [high, to]] = [stops[next - 1], stops[next]];
  const share = (isovalue - low) / (high - low);
  return from.map((x, k) => x + share * (to[k] - x)) as Vector;
}
