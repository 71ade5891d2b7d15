// SPDX-License-Identifier: GPL-3.0-or-later
// The interface: elements of panel.html, bound to the look.

import type { Header } from './bake';
import { colorBar, withColorBars } from './color_bar';
import { namesOf } from './color_maps';
import { Cube } from './cube';
import { Histogram } from './histogram';
import { clamped, onGrid, textOf } from './isovalues';
import { IsosurfaceRows } from './isosurface_rows';
import { bindKeys } from './keys';
import { hueOf } from './lamps';
import { fromLink, type State, STRONGEST, toLink } from './link';
import type { Lamp, Slices } from './look';
import { backgroundOf } from './looks';
import { Ruler, ScaleBar } from './overlay';
import { Player } from './player';
import type { View } from './view';

const LARGE = 3840; // width of a 4K picture in pixels

// Most elements are inputs. Others are used only by members that all elements have.
function element(id: string): HTMLInputElement {
  return document.getElementById(id) as HTMLInputElement;
}

// Fills the page with the header's data before the bake is loaded. Returns the canvas of the view.
export function fillPage(header: Header): HTMLCanvasElement {
  element('title').textContent = header.title;
  element('walls-row').hidden = header.walls.meshes.length === 0;
  const more = document.getElementById('more') as HTMLDetailsElement;
  more.open = matchMedia('(min-width: 48rem)').matches;
  // Names of the ends of the axes. A patient's second axis points to the front.
  const depth = header.isPatient ? ['back', 'front'] : ['front', 'back'];
  const ends = ['left', 'right', ...depth, 'below', 'above'];
  for (const [end, name] of ends.entries()) {
    const isFirst = name === 'front';
    document.getElementById('clip-from')?.append(new Option(name, String(end), isFirst, isFirst));
  }
  const names = header.isPatient ? ['Sagittal', 'Coronal', 'Axial'] : ['X', 'Y', 'Z'];
  names.forEach((name, axis) => {
    element('slices').append(sliceRow(name, axis));
  });
  for (const [key, name] of namesOf(header)) {
    document.getElementById('slice-colors')?.append(new Option(name, key));
  }
  element('color-bars').append(...header.colorBars.map(colorBar));
  element('lamps').hidden = header.lights.lamps.length === 0;
  header.lights.lamps.forEach(({ name, color }, lamp) => {
    element('lamps').append(lampRow(name, lamp, hueOf(color)));
  });
  for (const [what, value] of header.about) {
    const term = document.createElement('dt');
    const text = document.createElement('dd');
    term.textContent = what;
    text.textContent = value;
    element('about-list').append(term, text);
  }
  return document.getElementById('view') as HTMLCanvasElement;
}

// Returns the checkbox and the slider of the slice across an axis.
function sliceRow(name: string, axis: number): HTMLElement {
  const row = document.createElement('div');
  row.className = 'row';
  row.innerHTML =
    `<label><input id="has-slice-${axis}" type="checkbox"> ${name} slice</label>` +
    `<input id="slice-${axis}" type="range" min="0" max="1" step="0.005" aria-label="Place of the slice">`;
  return row;
}

// Returns the controls of a lamp: strength relative to the bake, and color.
function lampRow(name: string, lamp: number, color: string): HTMLElement {
  const row = document.createElement('div');
  row.className = 'row';
  row.innerHTML =
    `<span></span><input id="strength-${lamp}" type="range" min="0" max="${STRONGEST}" step="0.01">` +
    `<input id="lamp-color-${lamp}" type="color" value="#${color}">`;
  row.querySelector('span')?.append(name);
  row.querySelectorAll('input').forEach((input, k) => {
    input.setAttribute('aria-label', `${k === 0 ? 'Strength' : 'Color'} of ${name}`);
  });
  return row;
}

export class Panel {
  readonly ruler: Ruler;
  private readonly histogram: Histogram;
  private readonly isosurfaces: IsosurfaceRows;
  private readonly player: Player;
  private readonly first: State;
  private written = '';

  constructor(
    private readonly header: Header,
    private readonly view: View,
  ) {
    const [low, high] = header.isovalueRange;
    for (const id of ['isovalue', 'number']) {
      element(id).min = String(low);
      element(id).max = String(high);
    }
    const bars = document.getElementById('histogram') as HTMLCanvasElement;
    this.histogram = new Histogram(bars, header.histogram, (share) => {
      this.setIsovalue(low + share * (high - low));
    });
    this.player = new Player(header.isovalueRange, () => this.isovalue, (isovalue) => {
      this.show(isovalue);
    }); // prettier-ignore
    this.isosurfaces = new IsosurfaceRows(header, () => view.look, () => {
      this.refresh();
    }); // prettier-ignore
    this.ruler = new Ruler(view, header.unit, header.unitLength);
    this.first = { look: { ...view.look }, viewpoint: view.orbit.viewpoint };
    this.bind();
    bindKeys(this, view, header);
    this.bindOverlays();
    this.bindLink();
    this.refresh();
  }

  // Choose the nearest option.
  setIsovalue(isovalue: number): void {
    this.show(onGrid(isovalue, this.header));
  }

  // The isovalue of the first isosurface, which the main slider changes.
  get isovalue(): number {
    return this.view.look.isosurfaces[0].isovalue;
  }

  // Shows the nearest isovalue of the range.
  show(isovalue: number): void {
    const [first, ...others] = this.view.look.isosurfaces;
    this.view.look.isosurfaces = [{ ...first, isovalue: clamped(isovalue, this.header) }, ...others];
    this.refresh();
  }

  // Shows the look in the elements and in the view.
  refresh(): void {
    const { look, canvas } = this.view;
    const [low, high] = this.header.isovalueRange;
    const text = textOf(this.isovalue, this.header);
    element('isovalue').value = String(this.isovalue);
    element('isovalue').setAttribute('aria-valuetext', text);
    if (document.activeElement !== element('number')) element('number').value = text;
    this.histogram.show(look.isosurfaces.map(({ isovalue }) => (isovalue - low) / (high - low)));
    this.isosurfaces.refresh();
    const background = backgroundOf(look.isosurfaces[0].colors, this.header);
    document.getElementById('stage')?.style.setProperty('--background', background);
    press('play', this.player.isPlaying);
    element('play').textContent = this.player.isPlaying ? 'Pause' : 'Play';
    press('local', look.isLocal);
    press('ruler-open', this.ruler.isOn);
    this.showPart('has-clip', 'clip', look.clip !== null);
    look.slices.forEach((place, axis) => {
      element(`has-slice-${axis}`).checked = place !== null;
      element(`slice-${axis}`).disabled = place === null;
      if (place !== null) element(`slice-${axis}`).value = String(place);
    });
    element('slice-colors').value = look.sliceColors;
    if (look.clip) {
      element('clip-from').value = String(look.clip.from);
      element('clip-share').value = String(look.clip.share);
    }
    element('walls').checked = look.showsWalls;
    element('exposure').value = String(look.stops);
    look.lamps.forEach(({ strength, color }, lamp) => {
      element(`strength-${lamp}`).value = String(strength);
      element(`lamp-color-${lamp}`).value = `#${color ?? hueOf(this.header.lights.lamps[lamp].color)}`;
    });
    const light = look.isLocal ? 'shaded locally' : 'with its baked light';
    canvas.setAttribute('aria-label', `${this.header.title} at isovalue ${text}, ${light}`);
    this.view.changed();
  }

  private showPart(box: string, part: string, isOn: boolean): void {
    element(box).checked = isOn;
    (document.getElementById(part) as HTMLFieldSetElement).disabled = !isOn;
  }

  private bind(): void {
    const { view, header } = this;
    const on = (id: string, event: string, act: (input: HTMLInputElement) => void) => {
      element(id).addEventListener(event, () => {
        act(element(id));
        this.refresh();
      });
    };
    on('isovalue', 'input', (input) => {
      this.setIsovalue(input.valueAsNumber);
    });
    on('number', 'change', (input) => {
      if (Number.isFinite(input.valueAsNumber)) this.setIsovalue(input.valueAsNumber);
      input.value = textOf(this.isovalue, header);
    });
    on('play', 'click', () => {
      this.player.toggle();
    });
    on('local', 'click', () => (view.look.isLocal = !view.look.isLocal));
    for (const id of ['has-clip', 'clip-from', 'clip-share']) {
      on(id, 'input', () => {
        const clip = {
          from: Number(element('clip-from').value),
          share: element('clip-share').valueAsNumber,
        };
        view.look.clip = element('has-clip').checked ? clip : null;
      });
    }
    for (const axis of [0, 1, 2]) {
      for (const id of [`has-slice-${axis}`, `slice-${axis}`]) {
        on(id, 'input', () => {
          const isOn = element(`has-slice-${axis}`).checked;
          const slices: Slices = [...view.look.slices];
          slices[axis] = isOn ? element(`slice-${axis}`).valueAsNumber : null;
          view.look.slices = slices;
        });
      }
    }
    on('slice-colors', 'input', (input) => (view.look.sliceColors = input.value));
    on('walls', 'input', (input) => (view.look.showsWalls = input.checked));
    on('exposure', 'input', (input) => (view.look.stops = input.valueAsNumber));
    for (const lamp of header.lights.lamps.keys()) {
      const change = (changes: Partial<Lamp>) => {
        view.look.lamps = view.look.lamps.map((old, k) => (k === lamp ? { ...old, ...changes } : old));
      };
      on(`strength-${lamp}`, 'input', (input) => {
        change({ strength: input.valueAsNumber });
      });
      on(`lamp-color-${lamp}`, 'input', (input) => {
        change({ color: input.value.slice(1) });
      });
    }
    on('reset', 'click', () => {
      view.resetCamera();
    });
    on('roll', 'click', () => {
      view.orbit.roll(90);
    });
    on('flip', 'click', () => {
      view.orbit.roll(180);
    });
    on('full', 'click', () => {
      void (document.fullscreenElement ? document.exitFullscreen() : document.body.requestFullscreen());
    });
    document.addEventListener('fullscreenchange', () => {
      press('full', document.fullscreenElement !== null);
    });
    on('ruler-open', 'click', () => {
      this.ruler.toggle();
    });
    on('save', 'click', () => {
      void this.save();
    });
    on('save-large', 'click', () => {
      void this.save(LARGE);
    });
    on('about-open', 'click', () => {
      (document.getElementById('about') as HTMLDialogElement).showModal();
    });
  }

  private bindOverlays(): void {
    const parts = [
      new ScaleBar(this.view, this.header.unit, this.header.unitLength),
      new Cube(this.view, this.header.isPatient),
      this.ruler,
    ];
    this.view.onDrawn(() => {
      for (const part of parts) part.show();
    });
  }

  // Updates the link after a change of the state, and the state after a link is entered.
  private bindLink(): void {
    // A page in the attribute srcdoc of an iframe, as in a notebook, has no link.
    if (location.protocol === 'about:') return;
    const read = () => {
      const { look, viewpoint } = fromLink(location.hash, this.first, this.header);
      this.view.look = look;
      this.view.orbit.viewpoint = viewpoint;
      this.refresh();
    };
    this.written = toLink(this.first);
    if (location.hash !== '') read();
    addEventListener('hashchange', () => {
      if (location.hash !== `#${this.written}`) read();
    });
    this.view.onDrawn((atRest) => {
      const link = toLink({ look: this.view.look, viewpoint: this.view.orbit.viewpoint });
      if (!atRest || link === this.written || this.player.isPlaying) return;
      this.written = link;
      history.replaceState(null, '', `#${link}`);
    });
  }

  private async save(pixels?: number): Promise<void> {
    const link = document.createElement('a');
    const picture = await withColorBars(await this.view.picture(pixels), this.header.colorBars);
    link.href = URL.createObjectURL(picture);
    link.download = `${this.header.title} ${textOf(this.isovalue, this.header)}.png`;
    link.click();
    URL.revokeObjectURL(link.href);
  }
}

function press(id: string, isPressed: boolean): void {
  element(id).setAttribute('aria-pressed', String(isPressed));
}
