// SPDX-License-Identifier: GPL-3.0-or-later
// Reduces the resolution during movement, so that it stays smooth.

const SLOW_MS = 24; // slower frames reduce the resolution
const FAST_MS = 18; // faster frames increase it; a 60 Hz screen takes 16.7
const LEAST = 0.25;
const FRAMES = 4; // number of frames that are averaged

export class Pace {
  share = 1; // share of the resolution along each side
  private total = 0;
  private count = 0;

  // Adds the milliseconds from a frame at this share to the next one.
  took(milliseconds: number): void {
    this.total += milliseconds;
    // React to a very slow frame at once.
    if (++this.count < FRAMES && milliseconds < FRAMES * SLOW_MS) return;
    const mean = this.total / this.count;
    if (mean > SLOW_MS) this.share = Math.max(LEAST, this.share * Math.sqrt(SLOW_MS / mean) * 0.9);
    else if (mean < FAST_MS) this.share = Math.min(1, this.share * 1.15);
    this.total = this.count = 0;
  }
}
