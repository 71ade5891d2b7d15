// SPDX-License-Identifier: GPL-3.0-or-later
// The light of a wall at its vertices beside an isosurface: indirect light between nodes of the isosurface
// coordinate, and direct light as the core has it (core/src/bake/walls/mesh_direct_light.cpp).

import type { Bake, Header, WallLightData } from './bake';
import { addColors, colorWords } from './colors';

interface Blocks {
  between: Uint32Array;
  indirect: (Uint32Array | null)[];
  unshadowed: (Uint32Array | null)[];
  sets: Uint8Array;
  least: Uint8Array | null; // null: isosurfaces are closed
  greatest: Uint8Array;
  weights: Int8Array;
}

export class WallLight {
  private readonly count: number; // of the vertices
  private readonly tints: Float32Array; // [(set * points + point) * 3 + channel]
  private readonly points: number;
  private readonly unshadowed: (Float32Array | null)[];
  private readonly whole: Float32Array[]; // by side: the light of each vertex's set
  private readonly edges: Uint32Array; // pairs of vertices
  private readonly terms: Uint32Array; // of each vertex: itself and its neighbours

  static async of(bake: Bake, data: WallLightData, triangles: Uint32Array): Promise<WallLight> {
    const colors = async (number: number | null) =>
      number === null ? null : colorWords(await bake.block(number, 1));
    return new WallLight(bake.header, triangles, {
      between: new Uint32Array((await bake.block(data.between, 4)).buffer),
      indirect: [await colors(data.indirect[0]), await colors(data.indirect[1])],
      unshadowed: [await colors(data.unshadowed[0]), await colors(data.unshadowed[1])],
      sets: await bake.block(data.sets, 1),
      least: data.least === null ? null : await bake.block(data.least, 1),
      greatest: await bake.block(data.greatest, 1),
      weights: new Int8Array((await bake.block(data.weights, 1)).buffer),
    });
  }

  private constructor(
    private readonly header: Header,
    triangles: Uint32Array,
    private readonly blocks: Blocks,
  ) {
    const { tints } = header.walls;
    this.count = blocks.sets.length;
    this.points = tints[0].length;
    this.tints = new Float32Array(tints.flat(2));
    this.unshadowed = blocks.unshadowed.map((words) => {
      if (words === null) return null;
      const colors = new Float32Array(3 * this.count);
      addColors(colors, words, 0, 1);
      return colors;
    });
    this.whole = this.lit(Infinity);
    this.edges = edgesOf(triangles, this.count);
    this.terms = new Uint32Array(this.count).fill(1);
    for (const v of this.edges) ++this.terms[v];
  }

  // Radiance times the exposure, of the front and the back, into three numbers for each vertex.
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

  // By side: the light that comes by ways that an isosurface does not block.
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
    if (unshadowed === null) return;
    const whole = this.whole[side];
    for (let i = 0; i < lit.length; ++i) if (lit[i] > 0) lit[i] /= whole[i];
    // The mean over each vertex and its neighbours.
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

  // Of coarser vertices, of which each vertex lies halfway between two.
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
    addColors(coarse, words, low * count, 0.5 * (1 - share));
    addColors(coarse, words, (low + 1) * count, 0.5 * share);
    for (let v = 0; v < this.count; ++v) {
      const [a, b] = [3 * between[2 * v], 3 * between[2 * v + 1]];
      for (let k = 0; k < 3; ++k) colors[3 * v + k] += coarse[a + k] + coarse[b + k];
    }
  }
}

// Each once.
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
