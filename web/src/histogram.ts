// SPDX-License-Identifier: GPL-3.0-or-later
// The logarithmic histogram of the values, with the isovalues. A drag chooses one.

import type { Header } from './bake';

export class Histogram {
  private shown: number[] = [];

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly bins: Header['histogram'],
    chosen: (share: number) => void,
  ) {
    const choose = (event: PointerEvent) => {
      const { left, width } = canvas.getBoundingClientRect();
      chosen(Math.min(1, Math.max(0, (event.clientX - left) / width)));
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      choose(event);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) choose(event);
    });
    const redraw = () => {
      this.show(this.shown);
    };
    new ResizeObserver(redraw).observe(canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  }

  // Draws lines at shares, 0..1, of the isovalue range.
  show(shares: number[]): void {
    this.shown = shares;
    const { canvas } = this;
    const { counts, width: share } = this.bins;
    const width = (canvas.width = Math.round(canvas.clientWidth * devicePixelRatio));
    const height = (canvas.height = Math.round(canvas.clientHeight * devicePixelRatio));
    const context = canvas.getContext('2d');
    if (!context || width === 0) return;
    const style = getComputedStyle(canvas);
    const most = Math.log1p(Math.max(...counts, 1));
    context.fillStyle = style.getPropertyValue('--bars');
    counts.forEach((count, bin) => {
      const bar = (height * Math.log1p(count)) / most;
      const [left, right] = [bin, bin + 1].map((k) => Math.round(width * share * k));
      context.fillRect(left, height - bar, right - left, bar);
    });
    context.fillStyle = style.getPropertyValue('--accent');
    for (const place of shares) {
      const line = 2 * devicePixelRatio;
      context.fillRect(Math.round(place * width) - 0.5 * line, 0, line, height);
    }
  }
}
