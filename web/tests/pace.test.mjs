// SPDX-License-Identifier: GPL-3.0-or-later
import assert from 'node:assert/strict';
import test from 'node:test';

import { load } from './load.mjs';

const { Pace } = await load('pace');

// Returns the share after some frames, if a card takes this long for a full picture on a 60 Hz
// screen.
function shareAfter(frames, fullFrame, pace = new Pace()) {
  for (let i = 0; i < frames; ++i) {
    pace.took(Math.max(1000 / 60, fullFrame * pace.share * pace.share));
  }
  return pace.share;
}

test('a fast card draws all', () => assert.equal(shareAfter(60, 5), 1));
test('a slow one draws less, until frames come in time', () => {
  const share = shareAfter(60, 100);
  assert.ok(share < 0.55 && 100 * share * share < 25, String(share));
});
test('a very slow one after two frames', () => assert.equal(shareAfter(2, 1000), 0.25));
test('what was slow for a while draws all again', () => {
  const pace = new Pace();
  shareAfter(8, 200, pace);
  assert.ok(pace.share < 0.5);
  assert.equal(shareAfter(60, 5, pace), 1);
});
