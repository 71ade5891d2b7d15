// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the bake in the page and shows it, or an error.

import { shareIsovalue } from './around';
import { Bake, type Header } from './bake';
import { textureSize } from './bricks';
import { Failure, showFailure } from './failure';
import { Isosurface } from './isosurface';
import { firstLook } from './look';
import { layersOf } from './maps';
import { endOpening, tellOpening } from './opening';
import { fillPage, Panel } from './panel';
import { View } from './view';
import { Wall } from './walls';

const FIRST_PICTURE_MS = 500; // upper bound

// Query the graphics card before the data are unpacked.
function openCard(canvas: HTMLCanvasElement, header: Header): WebGL2RenderingContext {
  const context = canvas.getContext('webgl2', { alpha: true, antialias: false });
  if (!context) {
    throw new Failure(
      'This page needs WebGL 2, which this browser does not offer: open it in a newer one, ' +
        'or allow it to use the graphics card.',
    );
  }
  const most = context.getParameter(context.MAX_3D_TEXTURE_SIZE) as number;
  for (const { dims, light, direct } of header.volumes) {
    const maps = direct === null ? [] : textureSize(direct, layersOf(direct));
    const side = Math.max(...dims, ...textureSize(light), ...maps);
    if (side > most) {
      throw new Failure(
        `This volume has ${side} points along one axis, and this graphics card takes ${most}: ` +
          'export it coarser.',
      );
    }
  }
  return context;
}

async function open(): Promise<void> {
  tellOpening(0, 'Reading the file');
  const header = await Bake.header();
  const canvas = fillPage(header);
  const context = openCard(canvas, header);
  if (!('DecompressionStream' in window)) {
    throw new Failure('This browser cannot unpack the data of this page: open it in a newer one.');
  }
  const bake = await Bake.read(header, tellOpening);
  const isosurfaces: Isosurface[] = [];
  const walls: Wall[] = [];
  for (const volume of header.volumes) isosurfaces.push(await Isosurface.of(bake, volume));
  for (const wall of header.walls.meshes) walls.push(await Wall.of(bake, wall));
  tellOpening(1, 'Preparing the graphics card');
  const view = new View(canvas, context, header, isosurfaces, walls, firstLook(header));
  await view.start();
  const panel = new Panel(header, view);
  shareIsovalue(panel, view);
  endOpening();
  // Expose the view to the browser's developer tools: leaflight.view.countFetches().
  Object.assign(window, { leaflight: { view, panel } });
}

// Let the browser draw the first picture before the graphics card is queried. A hidden page draws
// nothing.
function drawn(): Promise<void> {
  return new Promise((done) => {
    requestAnimationFrame(() => setTimeout(done, 0));
    setTimeout(done, FIRST_PICTURE_MS);
  });
}

drawn().then(open).catch(showFailure);
