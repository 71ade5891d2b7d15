// SPDX-License-Identifier: GPL-3.0-or-later
// Keyboard shortcuts of the page.

import type { Header } from './bake';
import type { Panel } from './panel';
import type { View } from './view';

type Keys = Partial<Record<string, () => void>>;

const STEPS = 200; // steps over the isovalue range

export function bindKeys(panel: Panel, view: View, header: Header): void {
  const press = (id: string) => () => {
    document.getElementById(id)?.click();
  };
  const step = (count: number) => () => {
    const [low, high] = header.isovalueRange;
    panel.setIsovalue(panel.isovalue + (count * (high - low)) / STEPS);
  };
  const anywhere: Keys = {
    '[': step(-1), ']': step(1), '{': step(-10), '}': step(10),
    ' ': press('play'), l: press('local'), c: press('has-clip'), t: press('add'),
    w: press('walls'), s: press('save'), r: press('reset'), '?': press('about-open'),
    o: press('roll'), u: press('flip'), f: press('full'), m: press('ruler-open'),
    h: () => {
      document.getElementById('panel')?.toggleAttribute('hidden');
    },
  }; // prettier-ignore
  const onSlider: Keys = {
    ArrowLeft: step(-1), ArrowDown: step(-1), ArrowRight: step(1), ArrowUp: step(1),
    PageDown: step(-10), PageUp: step(10), Home: step(-STEPS), End: step(STEPS),
  }; // prettier-ignore
  const turn = (around: number, up: number, nearer?: number) => () => {
    view.orbit.turn(around, up, nearer);
  };
  const onView: Keys = {
    ArrowLeft: turn(-5, 0), ArrowRight: turn(5, 0), ArrowUp: turn(0, 5), ArrowDown: turn(0, -5),
    '+': turn(0, 0, 1.1), '=': turn(0, 0, 1.1), '-': turn(0, 0, 1 / 1.1),
  }; // prettier-ignore
  document.addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.altKey || event.metaKey || target.id === 'number') return;
    // Native elements keep their own keys.
    const natives = 'button, select, summary, dialog, [type=checkbox]';
    if (event.key === ' ' && target.closest(natives)) return;
    const own = target.id === 'isovalue' ? onSlider : target === view.canvas ? onView : {};
    const act = own[event.key] ?? anywhere[event.key.length === 1 ? event.key.toLowerCase() : ''];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
