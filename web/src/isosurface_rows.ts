// SPDX-License-Identifier: GPL-3.0-or-later
// The controls of the isosurfaces that are shown together: isovalue, colors, opacity.

import type { Header } from './bake';
import { onGrid, textOf } from './isovalues';
import { type Look, MOST_SHOWN, type Shown, withOneMore } from './look';
import { lookNames } from './looks';

export class IsosurfaceRows {
  private readonly rows: HTMLElement[];
  private readonly add = document.getElementById('add') as HTMLButtonElement;

  // changed: called after a control has changed the look.
  constructor(
    private readonly header: Header,
    private readonly look: () => Look,
    private readonly changed: () => void,
  ) {
    const group = document.getElementById('isosurfaces');
    this.rows = Array.from({ length: MOST_SHOWN }, (_, k) => this.row(k));
    group?.append(...this.rows);
    this.add.addEventListener('click', () => {
      this.show(withOneMore(this.look().isosurfaces, header));
    });
  }

  refresh(): void {
    const { isosurfaces } = this.look();
    this.add.disabled = isosurfaces.length === MOST_SHOWN;
    this.rows.forEach((row, k) => {
      row.hidden = k >= isosurfaces.length;
      if (row.hidden) return;
      const { isovalue, opacity, colors } = isosurfaces[k];
      control(row, '.isovalue').value = String(isovalue);
      control(row, '.isovalue').setAttribute('aria-valuetext', textOf(isovalue, this.header));
      control(row, '.opacity').value = String(opacity);
      control(row, '.colors').value = colors ?? '';
      control(row, '.remove').disabled = isosurfaces.length === 1;
    });
  }

  private show(isosurfaces: Shown[]): void {
    this.look().isosurfaces = isosurfaces;
    this.changed();
  }

  private row(k: number): HTMLElement {
    const row = document.createElement('div');
    row.className = 'isosurface';
    row.setAttribute('role', 'group');
    row.setAttribute('aria-label', `Isosurface ${k + 1}`);
    const [low, high] = this.header.isovalueRange;
    row.innerHTML =
      `<div class="row"><span>Isosurface ${k + 1}</span>` +
      `<input class="isovalue" type="range" step="any" min="${low}" max="${high}" aria-label="Isovalue">` +
      '<button class="remove" type="button" aria-label="Remove">×</button></div>' +
      '<div class="row"><select class="colors" aria-label="Colors"><option value="">As baked</option></select>' +
      '<label class="row">Opacity <input class="opacity" type="range" min="0" max="1" step="0.01"></label></div>';
    for (const [key, name] of lookNames(this.header)) {
      row.querySelector('.colors')?.append(new Option(name, key));
    }
    const on = (selector: string, event: string, change: (shown: Shown) => Partial<Shown>) => {
      row.querySelector(selector)?.addEventListener(event, () => {
        this.show(this.look().isosurfaces.map((old, j) => (j === k ? { ...old, ...change(old) } : old)));
      });
    };
    on('.isovalue', 'input', () => ({
      isovalue: onGrid(control(row, '.isovalue').valueAsNumber, this.header),
    }));
    on('.opacity', 'input', () => ({ opacity: control(row, '.opacity').valueAsNumber }));
    on('.colors', 'input', () => ({ colors: control(row, '.colors').value || null }));
    row.querySelector('.remove')?.addEventListener('click', () => {
      this.show(this.look().isosurfaces.filter((_, j) => j !== k));
    });
    return row;
  }
}

// Most elements are inputs. Others are used only by members that all elements have.
function control(row: HTMLElement, selector: string): HTMLInputElement {
  return row.querySelector<HTMLElement>(selector) as HTMLInputElement;
}
