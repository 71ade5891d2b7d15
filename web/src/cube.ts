// SPDX-License-Identifier: GPL-3.0-or-later
// The orientation cube. It turns with the view; a click on a face turns the view to it.

import * as three from 'three';

import type { Vector } from './bake';
import type { View } from './view';

// Letters of a patient's sides: right, left, anterior, posterior, superior, inferior. Readers
// orient a patient's coordinates to right, front and up.
const AXES: [Vector, string, string, string][] = [
  [[1, 0, 0], '+X', 'R', 'right'],
  [[-1, 0, 0], '-X', 'L', 'left'],
  [[0, 1, 0], '+Y', 'A', 'anterior'],
  [[0, -1, 0], '-Y', 'P', 'posterior'],
  [[0, 0, 1], '+Z', 'S', 'superior'],
  [[0, 0, -1], '-Z', 'I', 'inferior'],
];
function element(id: string): HTMLElement {
  return document.getElementById(id) as unknown as HTMLElement;
}

const TILT = 1e-3; // keeps the camera off its upright axis

export class Cube {
  private readonly box = element('cube');
  private readonly faces: [Vector, HTMLElement][] = [];

  constructor(
    private readonly view: View,
    isPatient: boolean,
  ) {
    for (const [axis, name, letter, side] of AXES) {
      const face = document.createElement('button');
      face.type = 'button';
      face.textContent = isPatient ? letter : name;
      face.setAttribute('aria-label', `View from ${isPatient ? side : name}`);
      face.addEventListener('click', () => {
        this.lookFrom(axis);
      });
      this.box.append(face);
      this.faces.push([axis, face]);
    }
  }

  show(): void {
    const { camera } = this.view;
    const half = 0.5 * this.box.clientWidth;
    const toView = camera.matrixWorldInverse.clone().setPosition(0, 0, 0);
    // In CSS, y points down.
    const flip = new three.Matrix4().makeScale(1, -1, 1);
    for (const [axis, face] of this.faces) {
      const normal = new three.Vector3(...axis);
      const upright = Math.abs(normal.dot(camera.up)) > 0.9 ? sideways(camera.up) : camera.up;
      const across = new three.Vector3().crossVectors(upright, normal).normalize();
      const up = new three.Vector3().crossVectors(normal, across);
      const placed = new three.Matrix4()
        .makeBasis(across, up, normal)
        .setPosition(normal.clone().multiplyScalar(half));
      const turned = flip.clone().multiply(toView).multiply(placed).multiply(flip);
      face.style.transform = `matrix3d(${turned.elements.map((x) => x.toFixed(5)).join(',')})`;
    }
  }

  private lookFrom(axis: Vector): void {
    const { target, up } = this.view.orbit.viewpoint;
    const normal = new three.Vector3(...axis);
    const upright = new three.Vector3(...up);
    if (Math.abs(normal.dot(upright)) > 0.9) {
      const { position } = this.view.orbit.viewpoint;
      const seen = new three.Vector3(...position).sub(new three.Vector3(...target));
      seen.addScaledVector(upright, -seen.dot(upright)).normalize();
      normal.addScaledVector(seen, TILT).normalize();
    }
    const place = normal.multiplyScalar(this.view.orbit.distance).add(new three.Vector3(...target));
    this.view.orbit.viewpoint = { position: place.toArray(), target, up };
  }
}

// Returns a unit vector perpendicular to another one, near an axis.
function sideways(axis: three.Vector3): three.Vector3 {
  const across = [1, 2, 0].find((k) => Math.abs(axis.getComponent(k)) < 0.6) ?? 0;
  return new three.Vector3().setComponent(across, 1);
}
