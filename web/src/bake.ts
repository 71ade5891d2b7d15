// SPDX-License-Identifier: GPL-3.0-or-later
// The data of the page, which python/leaflight/export/page_data.py writes.

import { arrived, DAMAGED, pause, readBody } from './body';
import { Failure } from './failure';
import type { Framing } from './framing';

export type Vector = [number, number, number];
export type Stops = [number, Vector][];

// Texels of a texture of bricks, from the first to the last voxel.
export interface BrickData {
  texels: Vector;
  active: number; // block: a bit for each texel, lowest bit first
  brick: Vector; // texels of a brick, including shared layers
  bricks: Vector;
  table: number; // block: position of each brick in the texture
  textureBricks: Vector;
}

// Layers of texels on the cap of a cut are stacked along z, above the texels themselves.
export interface LightData extends BrickData {
  layers: [number, number, number]; // number; code in the middle of the first, and their step
  front: number; // blocks: radiance times the exposure
  back: number | null;
}

export interface DirectData extends BrickData {
  front: number[]; // blocks: levels of two light points per byte
  back: number[] | null;
  codeRange: [number, number]; // codes of the volume at visibility codes 1 and 253
  points: number[][]; // as in DirectLight.light_points of the core
  lights: number[]; // number of each one's lamp, or -1
  indexToFrame: number[]; // 4 x 4, by rows
}

export interface VolumeData {
  name: string;
  dims: Vector; // voxels along x, y, z
  indexToWorld: number[]; // 4 x 4, by rows
  isovalues: [number, number]; // isovalues in data units at common isovalues 0 and 1
  values: number; // block: codes; a value is offset + scale * code
  bits: 8 | 16;
  masked: boolean;
  smoothNormals: number; // standard deviation in voxels; number of capping layers
  layers: number;
  offset: number;
  scale: number;
  light: LightData;
  direct: DirectData | null; // null: texels hold all light, not only indirect light
  backIs: 'baked' | 'dark' | 'local';
  albedo: Stops;
  emission: Stops;
  texture: TextureData | null;
  cuts: CutsData | null;
}

// Flat cuts, which lowered the values to a ramp (python/leaflight/volume/cuts.py).
export interface CutsData {
  range: [number, number]; // codes at a cut, and a voxel inside
  slabs: number[][]; // three for each cut: unit normal and offset
  halfWidths: number[];
  keeps: number[]; // of each cut, 1: the inside of its slabs; -1: the outside
}

// Colors that multiply the albedo.
export interface TextureData {
  nodes: Vector; // along x, y, z
  colors: number; // block: sRGB bytes
  fromIndex: number[]; // 4 x 4, by rows: from index positions of the volume to 0..1
  margin: Vector; // by which they are valid below 0 and above 1
  nearest: boolean;
}

// The colors and values of a texture (python/leaflight/scene/color_bar.py).
export interface ColorBar {
  title: string;
  stops: [number, string][]; // share of the bar, sRGB color as six hexadecimal digits
  ticks: [number, string][]; // share of the bar, text
}

export interface WallData {
  name: string;
  isOfRoom: boolean;
  albedo: Vector;
  emission: Vector;
  vertices: number; // blocks
  triangles: number;
  light: WallLightData | null; // null: shaded locally
}

export interface WallLightData {
  between: number; // two coarser vertices for each vertex
  // Radiance times the exposure of the front and the back. indirect: light of the coarser vertices
  // at each node. unshadowed: direct light by each lamp, and by all other emitters.
  indirect: (number | null)[];
  unshadowed: (number | null)[][];
  // sets: set of light points of each vertex. least, greatest: codes by point and vertex;
  // isosurfaces between them block the light. Closed isosurfaces have no least code. weights: light
  // by point and vertex, negative on the back.
  sets: number;
  least: number | null;
  greatest: number;
  weights: number;
}

export interface WallsData {
  nodes: number[]; // common isovalues of indirect light
  tints: number[][][]; // colors of each set's light points
  lights: number[]; // lamps of these points, as in DirectData
  meshes: WallData[];
}

// The material preset of one isosurface (python/leaflight/looks.py), with linear colors.
export interface NamedLook {
  name: string;
  color: Vector; // albedo
  gloss: number; // weight of a clear coat, 0..1
  roughness: number; // roughness of the coat
  background: Vector | null;
}

export interface Header {
  format: number;
  title: string;
  isovalueRange: [number, number]; // common isovalues
  isovalue: number;
  exposure: number;
  stops: number; // further stops of exposure
  unbaked: number; // brightness of white backs that were not baked
  camera: Framing;
  bounds: [Vector, Vector];
  volumes: VolumeData[];
  walls: WallsData;
  // Lamps with variable strengths: linear colors, and the growth of indirect light with each lamp,
  // relative to the rest (python/leaflight/bake/relit.py).
  lights: { lamps: { name: string; color: Vector; share: Vector }[]; others: Vector };
  lamps: number[][]; // for local shading: number of the lamp, and a row of lamps.py
  ambient: Vector;
  headlight: boolean;
  histogram: { counts: number[]; width: number }; // width of a bin as a share of the isovalue range
  step: number; // step between isovalues of the controls
  unit: string; // unit of lengths, '' if unknown
  unitLength: number; // units of length per unit of the world
  isPatient: boolean; // world axes point to a patient's right, front and up
  colorMaps: Record<string, string[]>; // name, then sRGB colors as six hexadecimal digits
  colorBars: ColorBar[];
  looks: Record<string, NamedLook>;
  about: [string, string][];
  blocks: [number, number, number][]; // first byte, bytes, inflated bytes
}

const FORMAT = 8;

const READ_SHARE = 0.4; // share of reading the file in the work

// Type of a progress report: the finished share of the work, 0..1, and the name of the step.
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

  // Returns the bake once its data are read.
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

// Returns the numbers of a block, `size` bytes each, in this machine's byte order.
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

// Bytes of equal significance are stored together.
function fromPlanes(planes: Uint8Array, size: number): Uint8Array<ArrayBuffer> {
  const count = planes.length / size;
  const bytes = new Uint8Array(planes.length);
  for (let plane = 0; plane < size; ++plane) {
    const first = plane * count;
    for (let i = 0, at = plane; i < count; ++i, at += size) bytes[at] = planes[first + i];
  }
  return bytes;
}

// Returns the color of a ramp at an isovalue in data units.
export function rampAt(stops: Stops, isovalue: number): Vector {
  const next = stops.findIndex(([at]) => at > isovalue);
  if (next === 0 || stops.length === 1) return stops[0][1];
  if (next < 0) return stops[stops.length - 1][1];
  const [[low, from], [high, to]] = [stops[next - 1], stops[next]];
  const share = (isovalue - low) / (high - low);
  return from.map((x, k) => x + share * (to[k] - x)) as Vector;
}
