// SPDX-License-Identifier: GPL-3.0-or-later
// The camera. Mouse, touch and keys turn, move and roll it around a target.

import * as three from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

import type { Vector } from './bake';
import type { Viewpoint } from './link';

const FARTHEST = 30; // upper bound on the distance, in sizes of the object
const NEAREST = 1e-3;

export class Orbit {
  readonly camera = new three.PerspectiveCamera();
  private controls: OrbitControls;

  // size: size of the object in the world. changed: called after each change. ahead: returns how
  // far the camera may move forward.
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly size: number,
    private readonly changed: () => void,
    private readonly ahead: () => number,
  ) {
    this.controls = this.newControls();
    // Runs before the controls handle the event.
    for (const event of ['wheel', 'pointerdown', 'touchstart']) {
      canvas.addEventListener(event, () => { this.stopBefore(); }, { capture: true, passive: true }); // prettier-ignore
    }
  }

  get viewpoint(): Viewpoint {
    return {
      position: this.camera.position.toArray(),
      target: this.controls.target.toArray(),
      up: this.camera.up.toArray(),
    };
  }

  set viewpoint({ position, target, up }: Viewpoint) {
    this.controls.dispose();
    this.camera.up.set(...up).normalize();
    this.camera.position.set(...position);
    // The controls copy the upright axis in their constructor.
    this.controls = this.newControls();
    this.controls.target.set(...target);
    this.controls.update();
    this.changed();
  }

  get distance(): number {
    return this.camera.position.distanceTo(this.controls.target);
  }

  // Turns by degrees around the upright axis and above the horizon, and moves nearer by a factor.
  turn(around: number, up: number, nearer = 1): void {
    if (nearer !== 1) this.stopBefore();
    const upright = new three.Quaternion().setFromUnitVectors(
      this.camera.up,
      new three.Vector3(0, 1, 0),
    );
    const offset = this.camera.position.clone().sub(this.controls.target).applyQuaternion(upright);
    const place = new three.Spherical().setFromVector3(offset);
    place.theta += three.MathUtils.degToRad(around);
    place.phi -= three.MathUtils.degToRad(up);
    place.radius /= nearer;
    offset.setFromSpherical(place.makeSafe()).applyQuaternion(upright.invert());
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.changed();
  }

  // Rolls the picture clockwise about the view direction, which changes the upright axis.
  roll(degrees: number): void {
    const { position, target, up } = this.viewpoint;
    const upright = new three.Vector3(...up);
    const sight = new three.Vector3(...target).sub(new three.Vector3(...position));
    const axis = sight.clone().addScaledVector(upright, -sight.dot(upright)).normalize();
    const turn = new three.Quaternion().setFromAxisAngle(axis, -three.MathUtils.degToRad(degrees));
    const place = new three.Vector3(...target).sub(sight.applyQuaternion(turn));
    this.viewpoint = {
      position: place.toArray(),
      target,
      up: upright.applyQuaternion(turn).toArray().map(clean) as Vector,
    };
  }

  private stopBefore(): void {
    const nearest = this.distance - this.ahead();
    this.controls.minDistance = Math.min(this.distance, Math.max(NEAREST * this.size, nearest));
  }

  private newControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.maxDistance = FARTHEST * this.size;
    controls.addEventListener('change', this.changed);
    return controls;
  }
}

// Removes rounding errors from a component of a unit vector.
function clean(x: number): number {
  return Math.abs(x - Math.round(x)) < 1e-9 ? Math.round(x) : x;
}
