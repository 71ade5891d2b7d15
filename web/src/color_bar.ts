// SPDX-License-Identifier: GPL-3.0-or-later
// Color bars over the picture: the colors and values of textures.

import type { ColorBar } from './bake';

const percent = (share: number) => `${(100 * share).toFixed(2)}%`;

// Returns the CSS of a bar, from low values at the bottom to high ones.
export function gradientOf({ stops }: ColorBar): string {
  const colors = stops.map(([share, digits]) => `#${digits} ${percent(share)}`);
  return `linear-gradient(to top, ${colors.join(', ')})`;
}

export function colorBar(bar: ColorBar): HTMLElement {
  const figure = document.createElement('figure');
  const [title, scale] = [document.createElement('figcaption'), document.createElement('div')];
  figure.className = 'color-bar';
  title.textContent = bar.title;
  scale.style.background = gradientOf(bar);
  for (const [share, text] of bar.ticks) {
    const tick = document.createElement('span');
    tick.textContent = text;
    tick.style.bottom = percent(share);
    scale.append(tick);
  }
  figure.append(title, scale);
  return figure;
}
