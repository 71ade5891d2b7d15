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

// Sizes in a picture, as shares of its height: length and width of a bar, texts, and space.
const [LENGTH, WIDTH, TEXT, SPACE] = [0.45, 0.03, 0.032, 0.02];

// Returns a picture with color bars from its right border on, as the page shows them.
export async function withColorBars(picture: Blob, bars: ColorBar[]): Promise<Blob> {
  const image = await createImageBitmap(picture);
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext('2d');
  if (!context || bars.length === 0) return picture;
  context.drawImage(image, 0, 0);
  context.font = `${TEXT * image.height}px sans-serif`;
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  let right = image.width - SPACE * image.height;
  for (const bar of [...bars].reverse()) right = drawBar(context, bar, right, image.height);
  return canvas.convertToBlob();
}

// Draws a bar left of a place, and returns the place of the next one. height: of the picture.
function drawBar(
  context: OffscreenCanvasRenderingContext2D, bar: ColorBar, right: number, height: number,
): number {
  const [length, width, text, space] = [LENGTH, WIDTH, TEXT, SPACE].map((share) => share * height);
  const widthOf = (words: string) => context.measureText(words).width;
  const numbers = Math.max(...bar.ticks.map(([, words]) => widthOf(words)));
  const inner = Math.max(widthOf(bar.title), numbers + space + width);
  const [top, end] = [0.5 * (height - length), right - space];
  context.fillStyle = '#15171ab0';
  context.beginPath();
  context.roundRect(
    end - inner - space, top - 2 * text - space,
    inner + 2 * space, length + 3 * text + 2 * space, 0.5 * space,
  );
  context.fill();
  const colors = context.createLinearGradient(0, top + length, 0, top);
  for (const [share, digits] of bar.stops) colors.addColorStop(share, `#${digits}`);
  context.fillStyle = colors;
  context.fillRect(end - width, top, width, length);
  context.fillStyle = '#fff';
  context.fillText(bar.title, end, top - 1.5 * text);
  for (const [share, words] of bar.ticks) {
    context.fillText(words, end - width - space, top + (1 - share) * length);
  }
  return end - inner - 2 * space;
}
