// SPDX-License-Identifier: GPL-3.0-or-later
// Lengths over the picture: a scale bar, and the distance between two clicked points.

import * as three from 'three';

import { lengthText, roundLength } from './lengths';
import type { View } from './view';

const BAR_PIXELS = 140; // upper bound
const CLICK_PIXELS = 4; // a longer movement is a drag

function element(id: string): HTMLElement {
  return document.getElementById(id) as unknown as HTMLElement;
}

export class ScaleBar {
  constructor(
    private readonly view: View,
    private readonly unit: string,
    private readonly unitLength: number,
  ) {}

  // The scale bar is exact at the depth of the target.
  show(): void {
    const { camera, canvas, orbit } = this.view;
    const across = 2 * Math.tan(three.MathUtils.degToRad(0.5 * camera.fov)) * orbit.distance;
    const pixel = (this.unitLength * across) / Math.max(canvas.clientHeight, 1);
    const length = roundLength(BAR_PIXELS * pixel);
    element('scale-bar').style.width = `${length / pixel}px`;
    element('scale-text').textContent = lengthText(length, this.unit);
  }
}

export class Ruler {
  private places: three.Vector3[] = [];
  private measures = false;

  constructor(
    private readonly view: View,
    private readonly unit: string,
    private readonly unitLength: number,
  ) {
    let down: [number, number] = [0, 0];
    view.canvas.addEventListener('pointerdown', ({ offsetX, offsetY }) => {
      down = [offsetX, offsetY];
    });
    view.canvas.addEventListener('pointerup', ({ offsetX, offsetY }) => {
      const moved = Math.hypot(offsetX - down[0], offsetY - down[1]);
      if (this.measures && moved <= CLICK_PIXELS) this.add(offsetX, offsetY);
    });
  }

  // Returns the distance between both points; null before they are chosen.
  get distance(): number | null {
    if (this.places.length < 2) return null;
    return this.unitLength * this.places[0].distanceTo(this.places[1]);
  }

  get isOn(): boolean {
    return this.measures;
  }

  toggle(): void {
    this.measures = !this.measures;
    this.places = [];
    this.show();
  }

  show(): void {
    const { camera, canvas } = this.view;
    const [a, b] = this.places.map((place) => {
      const { x, y } = place.clone().project(camera);
      return [0.5 * (x + 1) * canvas.clientWidth, 0.5 * (1 - y) * canvas.clientHeight];
    }) as [number[] | undefined, number[] | undefined];
    element('ruler').toggleAttribute('hidden', !a);
    element('ruler-text').hidden = !this.measures;
    if (a) {
      const [x, y] = b ?? a;
      const ends = { x1: a[0], y1: a[1], x2: x, y2: y };
      for (const [name, value] of Object.entries(ends)) {
        element('ruler-line').setAttribute(name, String(value));
      }
    }
    const distance = this.distance;
    element('ruler-text').textContent =
      distance === null
        ? `Click ${a ? 'the second' : 'the first'} of two places on the isosurface.`
        : lengthText(distance, this.unit);
  }

  private add(x: number, y: number): void {
    const place = this.view.placeAt(x, y);
    if (!place) return;
    if (this.places.length === 2) this.places = [];
    this.places.push(place);
    this.view.changed();
  }
}
