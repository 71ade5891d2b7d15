// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the resolution is drawn while something moves, so that it moves smoothly.

const SLOW_MS = 24; // from a frame to the next one, beyond which less is drawn
const FAST_MS = 18; // a screen of 60 Hz takes 16.7
const LEAST = 0.25;
const FRAMES = 4; // of which the mean is taken

export class Pace {
  share = 1; // of the resolution, along each side
  private total = 0;
  private count = 0;

  // From a frame in which this share was drawn to the next one.
  took(milliseconds: number): void {
    this.total += milliseconds;
    // Nobody waits for the mean of very slow ones.
    if (++this.count < FRAMES && milliseconds < FRAMES * SLOW_MS) return;
    const mean = this.total / this.count;
    if (mean > SLOW_MS) this.share = Math.max(LEAST, this.share * Math.sqrt(SLOW_MS / mean) * 0.9);
    else if (mean < FAST_MS) this.share = Math.min(1, this.share * 1.15);
    this.total = this.count = 0;
  }
}
