// SPDX-License-Identifier: GPL-3.0-or-later
// Moves the isovalue back and forth through the isovalue range.

const SECONDS = 10; // seconds for one way

export class Player {
  private frame = 0;
  private last = 0;
  private direction = 1;

  constructor(
    private readonly isovalueRange: [number, number],
    private readonly isovalue: () => number,
    private readonly show: (isovalue: number) => void,
  ) {}

  get isPlaying(): boolean {
    return this.frame !== 0;
  }

  toggle(): void {
    if (this.isPlaying) {
      cancelAnimationFrame(this.frame);
      this.frame = 0;
    } else {
      this.last = performance.now();
      this.ask();
    }
  }

  private ask(): void {
    this.frame = requestAnimationFrame((now) => {
      const [low, high] = this.isovalueRange;
      const seconds = Math.max(0, now - this.last) / 1000;
      const next = this.isovalue() + (this.direction * (high - low) * seconds) / SECONDS;
      if (next >= high) this.direction = -1;
      if (next <= low) this.direction = 1;
      this.last = now;
      this.ask();
      this.show(next);
    });
  }
}
