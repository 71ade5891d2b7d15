// SPDX-License-Identifier: GPL-3.0-or-later
// The bake in the page, as python/leaflight/export/page_data.py wrote it.

import { arrived, DAMAGED, pause, readBody } from './body';
import { Failure } from './failure';
import type { Framing } from './framing';

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
  front: number; // blocks: radiance times the exposure
  back: number | null;
}

export interface DirectData extends BrickData {
  front: number[]; // blocks: levels of two light points each
  back: number[] | null;
  codeRange: [number, number]; // codes of the volume at visibility codes 1 and 253
  points: number[][]; // as DirectLight.light_points of the core lists them
  lights: number[]; // of each, the number of the lamp that it belongs to, or -1
  indexToFrame: number[]; // 4 x 4, by rows
}

export interface VolumeData {
  name: string;
  dims: Vector; // voxels along x, y, z
  indexToWorld: number[]; // 4 x 4, by rows
  isovalues: [number, number]; // in data units, at common isovalues 0 and 1
  values: number; // block: codes, a value being offset + scale * code
  bits: 8 | 16;
  masked: boolean;
  smoothNormals: number; // standard deviation of a Gaussian in voxels, within so many layers
  layers: number;
  offset: number;
  scale: number;
  light: LightData;
  direct: DirectData | null; // beside which texels hold indirect light; null: they hold all
  backIs: 'baked' | 'dark' | 'local';
  albedo: Stops;
  emission: Stops;
}

export interface WallData {
  name: string;
  isOfRoom: boolean;
  albedo: Vector;
  emission: Vector;
  vertices: number; // blocks
  triangles: number;
  light: WallLightData | null; // null: it is shaded by lamps alone
}

export interface WallLightData {
  between: number; // of each vertex, two coarser ones
  // Radiance times the exposure of the front and the back. indirect: of the coarser vertices at
  // each node; unshadowed: direct light by each lamp, and by all other emitters.
  indirect: (number | null)[];
  unshadowed: (number | null)[][];
  // sets: the set of light points of each vertex. least, greatest: codes by point and vertex;
  // isosurfaces between them block the light. weights: the light by point and vertex, negative on
  // the back. Closed isosurfaces have no least code.
  sets: number;
  least: number | null;
  greatest: number;
  weights: number;
}

export interface WallsData {
  nodes: number[]; // common isovalues of indirect light
  tints: number[][][]; // of each set's light points
  lights: number[]; // of these points, as DirectData has them
  meshes: WallData[];
}

// The material preset of one isosurface (python/leaflight/looks.py), with linear colors.
export interface NamedLook {
  name: string;
  color: Vector; // albedo
  gloss: number; // 0..1, the weight of a clear coat
  roughness: number; // of the coat
  background: Vector | null;
}

export interface Header {
  format: number;
  title: string;
  isovalueRange: [number, number]; // common isovalues
  isovalue: number;
  exposure: number;
  stops: number; // of exposure beside it
  unbaked: number; // brightness of white backs that were not baked
  camera: Framing;
  bounds: [Vector, Vector];
  volumes: VolumeData[];
  walls: WallsData;
  // Lamps whose strengths may be changed: linear colors, and by how much indirect light grows with
  // each, beside that of all others (python/leaflight/bake/relit.py).
  lights: { lamps: { name: string; color: Vector; share: Vector }[]; others: Vector };
  lamps: number[][]; // of local shading: the number of its lamp, and a row of lamps.py
  ambient: Vector;
  headlight: boolean;
  histogram: { counts: number[]; width: number }; // of a bin, as a share of the isovalue range
  step: number; // between isovalues that are chosen
  unit: string; // of lengths, '' where it is not known
  unitLength: number; // how many of them a unit of the world measures
  isPatient: boolean; // the world's axes are towards a patient's right, front and up
  colorMaps: Record<string, string[]>; // the name, then sRGB colors as six hexadecimal digits
  looks: Record<string, NamedLook>;
  about: [string, string][];
  blocks: [number, number, number][]; // first byte, bytes, bytes when inflated
}

const FORMAT = 6;

const READ_SHARE = 0.4; // of the work, to read the file

// How much of the work is done, 0..1, and the step that goes on, as words.
export type Report = (share: number, step: string) => void;

export class Bake {
  private inflated = 0;
  private readonly all: number;

  private constructor(
    readonly header: Header,
    private readonly body: Uint8Array,
    private readonly report: Report,
  ) {
    this.all = header.blocks.reduce((sum, [, , whole]) => sum + whole, 0);
  }

  // As soon as it has arrived.
  static async header(): Promise<Header> {
    const text = (await arrived('leaflight-header'))?.textContent;
    let header: Header;
    try {
      header = JSON.parse(text ?? '') as Header;
    } catch {
      throw new Failure(DAMAGED);
    }
    if (header.format !== FORMAT) {
      throw new Failure('This page holds a bake of another version: export it again.');
    }
    return header;
  }

  static async read(header: Header, report: Report): Promise<Bake> {
    const bytes = Math.max(0, ...header.blocks.map(([first, length]) => first + length));
    const body = await readBody(bytes, (share) => {
      report(READ_SHARE * share, 'Reading the file');
    });
    return new Bake(header, body, report);
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
    this.inflated += whole;
    this.report(READ_SHARE + (1 - READ_SHARE) * (this.inflated / this.all), 'Unpacking');
    await pause();
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

// The color of a ramp at an isovalue, in data units.
export function rampAt(stops: Stops, isovalue: number): Vector {
  const next = stops.findIndex(([at]) => at > isovalue);
  if (next === 0 || stops.length === 1) return stops[0][1];
  if (next < 0) return stops[stops.length - 1][1];
  const [[low, from], [high, to]] = [stops[next - 1], stops[next]];
  const share = (isovalue - low) / (high - low);
  return from.map((x, k) => x + share * (to[k] - x)) as Vector;
}
