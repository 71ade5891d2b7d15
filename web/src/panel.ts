// SPDX-License-Identifier: GPL-3.0-or-later
// The interface: elements of panel.html, bound to the look.

import type { Header, Vector } from './bake';
import { Histogram } from './histogram';
import markup from './panel.html';
import { Player } from './player';
import type { View } from './view';

type Keys = Partial<Record<string, () => void>>;

const STEPS = 200; // from one end of the window to the other, by keys

// Most are inputs; of the others only what all elements have is used by this name.
function element(id: string): HTMLInputElement {
  return document.getElementById(id) as HTMLInputElement;
}

// Puts the elements into the page; returns the canvas of the view.
export function buildPage(header: Header): HTMLCanvasElement {
  document.body.innerHTML = markup;
  element('title').textContent = header.title;
  element('walls-row').hidden = header.walls.meshes.length === 0;
  const more = document.getElementById('more') as HTMLDetailsElement;
  more.open = matchMedia('(min-width: 48rem)').matches;
  for (const [what, value] of header.about) {
    const term = document.createElement('dt');
    const text = document.createElement('dd');
    term.textContent = what;
    text.textContent = value;
    element('about-list').append(term, text);
  }
  return document.getElementById('view') as HTMLCanvasElement;
}

export class Panel {
  private readonly histogram: Histogram;
  private readonly player: Player;
  private readonly slider = element('isovalue');
  private readonly number = element('number');

  constructor(
    private readonly header: Header,
    private readonly view: View,
  ) {
    const { look } = view;
    const [low, high] = header.window;
    for (const input of [this.slider, this.number, element('second')]) {
      input.min = String(low);
      input.max = String(high);
    }
    const bars = document.getElementById('histogram') as HTMLCanvasElement;
    this.histogram = new Histogram(bars, header.histogram, (share) => {
      this.setIsovalue(low + share * (high - low));
    });
    this.player = new Player(header.window, () => look.isovalue, (isovalue) => {
      this.setIsovalue(isovalue);
    });
    element('second').value = String(low + 0.25 * (look.isovalue - low));
    element('opacity').value = String(look.opacity);
    this.bind();
    this.bindKeys();
    this.setIsovalue(look.isovalue);
  }

  setIsovalue(isovalue: number): void {
    const [low, high] = this.header.window;
    this.view.look.isovalue = Math.min(high, Math.max(low, isovalue));
    this.refresh();
  }

  // Shows the look in the elements and in the view.
  refresh(): void {
    const { look } = this.view;
    const [low, high] = this.header.window;
    const text = String(Number(look.isovalue.toPrecision(6)));
    this.slider.value = String(look.isovalue);
    this.slider.setAttribute('aria-valuetext', text);
    if (document.activeElement !== this.number) this.number.value = text;
    const shown = look.second === null ? [look.isovalue] : [look.isovalue, look.second];
    this.histogram.show(shown.map((isovalue) => (isovalue - low) / (high - low)));
    element('play').setAttribute('aria-pressed', String(this.player.isPlaying));
    element('play').textContent = this.player.isPlaying ? 'Pause' : 'Play';
    element('local').setAttribute('aria-pressed', String(look.isLocal));
    const light = look.isLocal ? 'shaded locally' : 'with its baked light';
    const label = `${this.header.title} at isovalue ${text}, ${light}`;
    this.view.canvas.setAttribute('aria-label', label);
    this.view.changed();
  }

  private bind(): void {
    const { look } = this.view;
    const on = (id: string, event: string, act: (input: HTMLInputElement) => void) => {
      element(id).addEventListener(event, () => {
        act(element(id));
        this.refresh();
      });
    };
    on('isovalue', 'input', (input) => (look.isovalue = input.valueAsNumber));
    on('number', 'change', (input) => {
      if (Number.isFinite(input.valueAsNumber)) this.setIsovalue(input.valueAsNumber);
    });
    on('play', 'click', () => {
      this.player.toggle();
    });
    on('local', 'click', () => (look.isLocal = !look.isLocal));
    for (const id of ['has-clip', 'clip-axis', 'clip-distance']) {
      on(id, 'input', () => {
        if (id !== 'has-clip') element('has-clip').checked = true;
        look.clip = element('has-clip').checked ? this.chosenClip() : null;
      });
    }
    for (const id of ['has-second', 'second']) {
      on(id, 'input', () => {
        if (id !== 'has-second') element('has-second').checked = true;
        look.second = element('has-second').checked ? element('second').valueAsNumber : null;
      });
    }
    on('opacity', 'input', (input) => (look.opacity = input.valueAsNumber));
    on('walls', 'input', (input) => (look.showsWalls = input.checked));
    on('exposure', 'input', (input) => (look.stops = input.valueAsNumber));
    on('reset', 'click', () => {
      this.view.resetCamera();
    });
    on('save', 'click', () => {
      void this.save();
    });
    on('about-open', 'click', () => {
      (document.getElementById('about') as HTMLDialogElement).showModal();
    });
  }

  private bindKeys(): void {
    const press = (id: string) => () => {
      element(id).click();
    };
    const step = (count: number) => () => {
      const [low, high] = this.header.window;
      this.setIsovalue(this.view.look.isovalue + (count * (high - low)) / STEPS);
    };
    const anywhere: Keys = {
      '[': step(-1), ']': step(1), '{': step(-10), '}': step(10),
      ' ': press('play'), l: press('local'), c: press('has-clip'), t: press('has-second'),
      w: press('walls'), s: press('save'), r: press('reset'), '?': press('about-open'),
      h: () => {
        element('panel').hidden = !element('panel').hidden;
      },
    }; // prettier-ignore
    const onSlider: Keys = {
      ArrowLeft: step(-1), ArrowDown: step(-1), ArrowRight: step(1), ArrowUp: step(1),
      PageDown: step(-10), PageUp: step(10), Home: step(-STEPS), End: step(STEPS),
    }; // prettier-ignore
    const { view } = this;
    const turn = (around: number, up: number, nearer?: number) => () => {
      view.orbit(around, up, nearer);
    };
    const onView: Keys = {
      ArrowLeft: turn(-5, 0), ArrowRight: turn(5, 0), ArrowUp: turn(0, 5), ArrowDown: turn(0, -5),
      '+': turn(0, 0, 1.1), '=': turn(0, 0, 1.1), '-': turn(0, 0, 1 / 1.1),
    }; // prettier-ignore
    document.addEventListener('keydown', (event) => {
      const { target } = event;
      if (event.ctrlKey || event.altKey || event.metaKey || target === this.number) return;
      // Native elements keep their own keys.
      const natives = 'button, select, summary, dialog, [type=checkbox]';
      if (event.key === ' ' && (target as Element).closest(natives)) return;
      const own = target === this.slider ? onSlider : target === view.canvas ? onView : {};
      const act = own[event.key] ?? anywhere[event.key.length === 1 ? event.key.toLowerCase() : ''];
      if (!act) return;
      event.preventDefault();
      act();
    });
  }

  // The half of the box's axis, from one end to the share that the slider tells, is left out.
  private chosenClip(): { normal: Vector; distance: number } {
    const choice = Number(element('clip-axis').value);
    const share = element('clip-distance').valueAsNumber;
    const axis = choice >> 1;
    const sign = choice % 2 === 0 ? 1 : -1;
    const [low, high] = this.header.bounds.map((point) => sign * point[axis]);
    const normal: Vector = [0, 0, 0];
    normal[axis] = sign;
    const [near, far] = [Math.min(low, high), Math.max(low, high)];
    return { normal, distance: near + share * (far - near) };
  }

  private async save(): Promise<void> {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(await this.view.picture());
    link.download = `${this.header.title} ${this.number.value}.png`;
    link.click();
    URL.revokeObjectURL(link.href);
  }
}
