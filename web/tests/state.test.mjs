// SPDX-License-Identifier: GPL-3.0-or-later
// Tests isovalues, links, lengths and the first camera as plain data.
import assert from 'node:assert/strict';
import test from 'node:test';

import { load } from './load.mjs';

const { onGrid, textOf } = await load('isovalues');
const { gradientOf } = await load('color_bar');
const { colorsOf, linearAt } = await load('color_maps');
const { fromLink, toLink } = await load('link');
const { MOST_SHOWN, withOneMore } = await load('look');
const { albedoOf, backgroundOf, coatOf, lookNames } = await load('looks');
const { bakedLamps, factorsOf, hueOf, indirectFactor } = await load('lamps');
const { positionOf } = await load('framing');
const { roundLength, lengthText } = await load('lengths');

const VIRIDIS = ['Viridis', '440154', '472d7b', '3b528b', '2c728e', '21918c', '27ad81', '5cc863', 'aadc32', 'fde725'];
const BONE = { name: 'Bone', color: [0.8, 0.7, 0.5], gloss: 0.5, roughness: 0.35, background: [0, 1, 0.5] };
const CT = { isovalueRange: [-1000.5, 2000.5], step: 0.1, colorMaps: { VIRIDIS }, looks: { BONE }, lights: { lamps: [], others: [1, 1, 1] } };
const LIT = { ...CT, lights: { lamps: [
  { name: 'key', color: [4, 2, 0], share: [0.6, 0.5, 0] }, { name: 'rim', color: [1, 1, 1], share: [0.3, 0.5, 0.9] },
], others: [0.1, 0, 0.1] } }; // prettier-ignore
const MAP = { isovalueRange: [-0.31234, 1.45678], step: 0.001 };

test('isovalues have the digits of the data', () => {
  assert.equal(textOf(onGrid(0.203044, MAP), MAP), '0.203');
  assert.equal(textOf(onGrid(45.5, CT), CT), '45.5');
  assert.equal(textOf(1234.5678, { isovalueRange: [0, 9e6], step: 1000 }), '1235');
});
test('a color bar has its colors from the bottom to the top', () => {
  const bar = { title: 'potential', stops: [[0, 'ff0000'], [0.25, '00ff00'], [1, '0000ff']], ticks: [] };
  assert.equal(gradientOf(bar), 'linear-gradient(to top, #ff0000 0.00%, #00ff00 25.00%, #0000ff 100.00%)');
});
test('isovalues stay within the isovalue range', () => {
  assert.equal(onGrid(99999, CT), 2000.5);
  assert.equal(onGrid(-99999, CT), -1000.5);
  assert.equal(onGrid(99999, MAP), 1.45678);
});

const LOOK = {
  isosurfaces: [{ isovalue: 45.5, opacity: 1, colors: null }], isLocal: false, showsWalls: true, clip: null,
  stops: 0, slices: [null, null, null], sliceColors: 'GRAY', lamps: [],
}; // prettier-ignore
const FIRST = { look: LOOK, viewpoint: { position: [0, -5, 1], target: [0, 0, 0], up: [0, 0, 1] } };

test('a link holds the whole state', () => {
  const state = {
    look: {
      isosurfaces: [
        { isovalue: 120.3, opacity: 1, colors: 'BONE' }, { isovalue: 20.1, opacity: 0.5, colors: null },
        { isovalue: -3.5, opacity: 0.25, colors: 'VIRIDIS' },
      ],
      isLocal: true, showsWalls: false,
      clip: { from: 4, share: 0.25 }, stops: -1.2, slices: [0.5, null, 0.125], sliceColors: 'VIRIDIS',
      lamps: [{ strength: 0.25, color: null }, { strength: 2, color: 'ffa000' }],
    },
    viewpoint: { position: [1.5, 2.25, -3], target: [0.5, 0, 1], up: [1, 0, 0] },
  }; // prettier-ignore
  assert.deepEqual(fromLink(`#${toLink(state)}`, FIRST, LIT), state);
  assert.deepEqual(fromLink(toLink(FIRST), FIRST, CT), FIRST);
  assert.deepEqual(fromLink('', FIRST, CT), FIRST);
});
test('a link that makes no sense changes nothing', () => {
  const wrong = '#isovalue=50,x&opacity=2&clip=7,0.5&slices=a,&colors=JET&exposure=&camera=0,0,0,0,0,0,0,0,1';
  assert.deepEqual(fromLink(wrong, FIRST, CT), FIRST);
  const along = '#camera=0,0,5,0,0,0,0,0,1'; // looks along its upright axis
  assert.deepEqual(fromLink(along, FIRST, CT).viewpoint, FIRST.viewpoint);
  const beyond = fromLink('#isovalue=1e9,-1e9&opacity=,-7&colors=JET&clip=2,-1&exposure=99', FIRST, CT).look;
  const isosurfaces = [
    { isovalue: 2000.5, opacity: 1, colors: null }, { isovalue: -1000.5, opacity: 0, colors: null },
  ]; // prettier-ignore
  assert.deepEqual(beyond, { ...LOOK, isosurfaces, clip: { from: 2, share: 0 }, stops: 4 });
  const many = fromLink(`#isovalue=${Array(99).fill(5)}`, FIRST, CT).look.isosurfaces;
  assert.equal(many.length, MOST_SHOWN);
});

test('lamps that make no sense are as baked, and strengths have an end', () => {
  const baked = bakedLamps(LIT);
  for (const wrong of ['1,', '1,,1,,1,', 'x,,1,', '1,red,1,', '1.2.3,,1,', ',,,', '']) {
    assert.deepEqual(fromLink(`#lamps=${wrong}`, FIRST, LIT).look.lamps, baked, wrong);
  }
  const strengths = fromLink('#lamps=99,,-1,', FIRST, LIT).look.lamps.map(({ strength }) => strength);
  assert.deepEqual(strengths, [4, 0]);
});
test('lamps change light by channel, and have no channel that was not baked', () => {
  const lamps = [{ strength: 0.5, color: null }, { strength: 2, color: 'ff0000' }];
  const factors = factorsOf(lamps, LIT);
  assert.deepEqual(factors, [[0.5, 0.5, 0.5], [2, 0, 0]]);
  const found = indirectFactor(factors, LIT);
  [0.3 + 0.6 + 0.1, 0.25, 0.1].forEach((x, k) => assert.ok(Math.abs(found[k] - x) < 1e-12));
  assert.equal(hueOf([4, 2, 0]), 'ffbc00');
  const same = factorsOf([{ strength: 1, color: 'ffbc00' }, { strength: 1, color: 'ffffff' }], LIT);
  same.flat().forEach((x, i) => assert.ok(Math.abs(x - (i === 2 ? 0 : 1)) < 0.01, String(same)));
  assert.deepEqual(factorsOf([{ strength: 1, color: 'ffffff' }], LIT)[0], [1, 2, 0]);
});

test('another isosurface is in front of the others', () => {
  const two = withOneMore(LOOK.isosurfaces, CT);
  const three = withOneMore(two, CT);
  const isovalues = three.map(({ isovalue }) => isovalue);
  assert.ok(isovalues[2] < isovalues[1] && isovalues[1] < isovalues[0] && isovalues[2] >= -1000.5);
  assert.ok(three[2].opacity < 1 && three[0].opacity === 1);
});
test('looks have a color, a coat and a background, color maps a color alone', () => {
  assert.deepEqual(lookNames(CT), [['BONE', 'Bone'], ['VIRIDIS', 'Viridis']]);
  assert.deepEqual(albedoOf('BONE', 0.3, CT), BONE.color);
  assert.deepEqual(albedoOf('VIRIDIS', 1, CT), linearAt('VIRIDIS', 1, CT));
  assert.equal(albedoOf(null, 0.3, CT), null);
  assert.deepEqual([coatOf('BONE', CT), coatOf('VIRIDIS', CT)[0], coatOf(null, CT)[0]], [[0.5, 0.35], 0, 0]);
  assert.deepEqual([backgroundOf('BONE', CT), backgroundOf('VIRIDIS', CT)], ['#00ffbc', '']);
});

test('color maps go from end to end, in displayed and in linear colors', () => {
  assert.deepEqual(colorsOf('GRAY', CT)[0], [0.15, 0.15, 0.15]);
  assert.deepEqual(colorsOf('VIRIDIS', CT)[8], [0xfd / 255, 0xe7 / 255, 0x25 / 255]);
  const red = (share) => linearAt('VIRIDIS', share, CT)[0];
  assert.ok(Math.abs(red(1) - 0.98225) < 1e-4 && red(2) === red(1) && red(-1) === red(0));
  assert.ok(Math.abs(red(0.0625) - 0.5 * (red(0) + red(0.125))) < 1e-12);
});

test('an isosurface fills its share of any picture', () => {
  const framing = { target: [1, 2, 3], back: [0, -1, 0], up: [0, 0, 1], angle: 26, filled: 0.8 };
  for (const [width, height] of [[1280, 720], [390, 844], [500, 500]]) {
    for (const half of [[2, 1, 0.5], [0.1, 3, 1]]) {
      const position = positionOf({ ...framing, half }, width, height);
      const before = 2 - position[1] - half[2]; // distance to the near side of the box
      const pixels = Math.min(width, height) / (2 * Math.tan((13 * Math.PI) / 180)) / before;
      const filled = [(2 * half[0] * pixels) / width, (2 * half[1] * pixels) / height];
      assert.ok(Math.abs(Math.max(...filled) - 0.8) < 1e-9, String(filled));
    }
  }
});

test('lengths of scale bars are round', () => {
  for (const [most, found] of [[1, 1], [1.9, 1], [2, 2], [4.99, 2], [73, 50], [0.0307, 0.02]]) {
    assert.equal(roundLength(most), found);
  }
  assert.equal(lengthText(50, 'mm'), '50 mm');
  assert.equal(lengthText(12.34567, 'Å'), '12.35 Å');
  assert.equal(lengthText(5, ''), '5 units of the file');
});
