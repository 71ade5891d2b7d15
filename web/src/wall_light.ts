// SPDX-License-Identifier: GPL-3.0-or-later
// The light of a wall at its vertices for an isosurface: indirect light between common isovalues,
// and direct light as in the core (core/src/bake/walls/mesh_direct_light.cpp).

import type { Bake, Header, Vector, WallData, WallLightData } from './bake';
import { addColors, colorWords } from './colors';
import { factorAt, factorsOf, indirectFactor } from './lamps';
import type { Lamp } from './look';

interface Blocks {
  between: Uint32Array;
  indirect: (Uint32Array | null)[];
  unshadowed: (Uint32Array | null)[][];
  sets: Uint8Array;
  least: Uint8Array | null; // null: isosurfaces are closed
  greatest: Uint8Array;
  weights: Int8Array;
}

export class WallLight {
  private readonly count: number; // number of vertices
  private readonly tints: Float32Array; // [(set * points + point) * 3 + channel]
  private readonly points: number;
  private readonly unshadowed: Float32Array[]; // light by each emitter, by side
  private whole: Float32Array[] = []; // light of each vertex's set, by side
  private indirect: Vector = [1, 1, 1]; // factor on indirect light in the bake
  private readonly edges: Uint32Array; // pairs of vertices
  private readonly terms: Uint32Array; // number of vertices in the mean of each

  static async of(bake: Bake, data: WallData, triangles: Uint32Array): Promise<WallLight | null> {
    return data.light && WallLight.read(bake, data.light, data.emission, triangles);
  }

  private static async read(
    bake: Bake,
    data: WallLightData,
    emission: Vector,
    triangles: Uint32Array,
  ): Promise<WallLight> {
    const colors = async (number: number | null) =>
      number === null ? null : colorWords(await bake.block(number, 1));
    const all = async (numbers: (number | null)[]) => {
      const words = [];
      for (const number of numbers) words.push(await colors(number));
      return words;
    };
    return new WallLight(bake.header, triangles, emission, {
      between: new Uint32Array((await bake.block(data.between, 4)).buffer),
      indirect: await all(data.indirect),
      unshadowed: [await all(data.unshadowed[0]), await all(data.unshadowed[1])],
      sets: await bake.block(data.sets, 1),
      least: data.least === null ? null : await bake.block(data.least, 1),
      greatest: await bake.block(data.greatest, 1),
      weights: new Int8Array((await bake.block(data.weights, 1)).buffer),
    });
  }

  private constructor(
    private readonly header: Header,
    triangles: Uint32Array,
    private readonly emission: Vector,
    private readonly blocks: Blocks,
  ) {
    const { tints } = header.walls;
    this.count = blocks.sets.length;
    this.points = tints[0].length;
    this.tints = new Float32Array(tints.flat(2).length);
    this.unshadowed = [0, 1].map(() => new Float32Array(3 * this.count));
    this.edges = edgesOf(triangles, this.count);
    this.terms = new Uint32Array(this.count).fill(1);
    for (const v of this.edges) ++this.terms[v];
  }

  // Changes the strengths of lamps.
  set(lamps: Lamp[]): void {
    const { tints, lights } = this.header.walls;
    const factors = factorsOf(lamps, this.header);
    this.indirect = indirectFactor(factors, this.header);
    this.tints.set(
      tints.flatMap((set) =>
        set.flatMap((tint, point) => {
          const factor = factorAt(factors, lights[point]);
          return tint.map((x, k) => x * factor[k]);
        }),
      ),
    );
    this.unshadowed.forEach((colors, side) => {
      colors.fill(0);
      this.blocks.unshadowed[side].forEach((words, lamp) => {
        if (words) addColors(colors, words, 0, factorAt(factors, lamp));
      });
    });
    this.whole = this.lit(Infinity);
  }

  // Writes radiance times the exposure, front and back, three numbers for each vertex.
  at(c: number, sides: Float32Array[]): void {
    const lit = this.lit(this.codeOf(c));
    sides.forEach((colors, side) => {
      colors.fill(0);
      this.addDirect(colors, lit[side], side);
      this.addIndirect(colors, c, side);
    });
  }

  private codeOf(c: number): number {
    const [low, high] = this.header.isovalueRange;
    return 1 + (252 * (c - low)) / (high - low);
  }

  // Returns unblocked direct light by side.
  private lit(code: number): Float32Array[] {
    const { sets, least, greatest, weights } = this.blocks;
    const { tints, points, count } = this;
    const sides = [0, 1].map(() => new Float32Array(3 * count));
    for (let point = 0, way = 0; point < points; ++point) {
      for (let v = 0; v < count; ++v, ++way) {
        const weight = weights[way];
        const passes = least !== null && code <= least[way] + 0.5;
        if (weight === 0 || (greatest[way] + 0.5 >= code && !passes)) continue;
        const light = sides[weight < 0 ? 1 : 0];
        const tint = 3 * (sets[v] * points + point);
        const at = 3 * v;
        const share = Math.abs(weight);
        light[at] += share * tints[tint];
        light[at + 1] += share * tints[tint + 1];
        light[at + 2] += share * tints[tint + 2];
      }
    }
    return sides;
  }

  private addDirect(colors: Float32Array, lit: Float32Array, side: number): void {
    const unshadowed = this.unshadowed[side];
    const whole = this.whole[side];
    for (let i = 0; i < lit.length; ++i) if (lit[i] > 0) lit[i] /= whole[i];
    // Averages each vertex with its neighbors.
    const sum = lit.slice();
    const { edges, terms } = this;
    for (let e = 0; e < edges.length; e += 2) {
      const a = 3 * edges[e];
      const b = 3 * edges[e + 1];
      for (let k = 0; k < 3; ++k) {
        sum[a + k] += lit[b + k];
        sum[b + k] += lit[a + k];
      }
    }
    for (let v = 0, i = 0; v < this.count; ++v) {
      for (let k = 0; k < 3; ++k, ++i) colors[i] += (unshadowed[i] * sum[i]) / terms[v];
    }
  }

  // Adds indirect light of coarser vertices; each vertex lies halfway between two of them.
  private addIndirect(colors: Float32Array, c: number, side: number): void {
    const { between, indirect } = this.blocks;
    const words = indirect[side];
    if (words === null) return;
    const { nodes } = this.header.walls;
    const next = nodes.findIndex((node) => node > c);
    const low = Math.min(next < 0 ? nodes.length : Math.max(next, 1), nodes.length - 1) - 1;
    const share = (c - nodes[low]) / (nodes[low + 1] - nodes[low]);
    const count = words.length / nodes.length;
    const coarse = new Float32Array(3 * count);
    const half = (part: number) => this.indirect.map((factor) => 0.5 * part * factor) as Vector;
    addColors(coarse, words, low * count, half(1 - share));
    addColors(coarse, words, (low + 1) * count, half(share));
    // The baked light includes the wall's emission, which no lamp scales.
    const own = this.emission.map((x, k) => x * this.header.exposure * (1 - this.indirect[k]));
    for (let v = 0; v < this.count; ++v) {
      const [a, b] = [3 * between[2 * v], 3 * between[2 * v + 1]];
      for (let k = 0; k < 3; ++k) {
        colors[3 * v + k] += Math.max(coarse[a + k] + coarse[b + k] + own[k], 0);
      }
    }
  }
}

// List each edge once.
function edgesOf(triangles: Uint32Array, count: number): Uint32Array {
  const keys = new Set<number>();
  for (let t = 0; t < triangles.length; t += 3) {
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [triangles[t + k], triangles[t + ((k + 1) % 3)]];
      keys.add(Math.min(a, b) * count + Math.max(a, b));
    }
  }
  const edges = new Uint32Array(2 * keys.size);
  let at = 0;
  for (const key of keys) {
    edges[at++] = Math.floor(key / count);
    edges[at++] = key % count;
  }
  return edges;
}
