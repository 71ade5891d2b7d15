// SPDX-License-Identifier: GPL-3.0-or-later
// The canvas: draws a look from a camera that hand and keys turn.

import * as three from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

import type { Header } from './bake';
import { Failure, showFailure } from './failure';
import type { Leaf, Rays } from './leaf';
import type { Look } from './look';
import { Pace } from './pace';
import type { Wall } from './walls';

const REST_MS = 150; // without a change, after which the whole resolution is drawn

export class View {
  readonly camera = new three.PerspectiveCamera();
  private readonly renderer: three.WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly scene = new three.Scene();
  private readonly pace = new Pace();
  private readonly sphere = new three.Sphere();
  private asked = 0;
  private resting: ReturnType<typeof setTimeout> | undefined;

  constructor(
    readonly canvas: HTMLCanvasElement,
    context: WebGL2RenderingContext,
    private readonly header: Header,
    private readonly leaves: Leaf[],
    private readonly walls: Wall[],
    readonly look: Look,
  ) {
    this.renderer = new three.WebGLRenderer({ canvas, context, alpha: true });
    this.renderer.debug.onShaderError = (gl, program) => {
      throw new Failure(
        'The driver of the graphics card refuses this page ' +
          `(${gl.getProgramInfoLog(program) ?? ''}): open it in another browser.`,
      );
    };
    // Colors are encoded by our own shaders.
    this.renderer.outputColorSpace = three.LinearSRGBColorSpace;
    this.renderer.setClearColor(0, 0);
    for (const each of [...walls, ...leaves]) this.scene.add(each.mesh);
    const box = new three.Box3();
    for (const { mesh } of walls) box.expandByObject(mesh);
    for (const point of header.bounds) box.expandByPoint(new three.Vector3(...point));
    box.getBoundingSphere(this.sphere);
    // The controls take their upright axis when they are made.
    this.camera.up.set(...header.camera.up);
    this.controls = new OrbitControls(this.camera, canvas);
    this.resetCamera();
    this.controls.addEventListener('change', () => {
      this.changed();
    });
    new ResizeObserver(() => {
      this.changed();
    }).observe(canvas);
    canvas.addEventListener('webglcontextlost', () => {
      showFailure(new Failure('The graphics card has stopped: close other pages, then reload.'));
    });
  }

  // Compiles and fills the card's memory; throws Failure where that is too small.
  start(): void {
    this.drawNow(1);
    const context = this.renderer.getContext();
    for (let error = context.getError(); error !== 0; error = context.getError()) {
      if (error === context.OUT_OF_MEMORY) {
        throw new Failure(
          'This volume does not fit into the memory of the graphics card: export it coarser.',
        );
      }
    }
  }

  // Something of the look, the camera or the size has changed.
  changed(): void {
    this.canvas.dataset.state = 'moving';
    clearTimeout(this.resting);
    if (this.asked !== 0) return;
    this.asked = requestAnimationFrame((now) => {
      this.asked = 0;
      this.drawNow(this.pace.share);
      requestAnimationFrame((next) => {
        this.pace.took(next - now);
      });
      this.resting = setTimeout(() => {
        this.drawNow(1);
        this.canvas.dataset.state = 'rest';
      }, REST_MS);
    });
  }

  // At a share of the screen's resolution.
  drawNow(share: number): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(share * window.devicePixelRatio);
    this.renderer.setSize(width, height, false);
    this.aim(width / height);
    const rays = this.rays();
    for (const leaf of this.leaves) leaf.show(this.look, this.camera, rays, this.header.exposure);
    for (const wall of this.walls) wall.show(this.look, this.camera);
    this.renderer.render(this.scene, this.camera);
  }

  resetCamera(): void {
    const { position, target } = this.header.camera;
    this.camera.position.set(...position);
    this.controls.target.set(...target);
    this.controls.update();
    this.changed();
  }

  // By degrees around the upright axis and above the horizon, and how much nearer.
  orbit(around: number, up: number, nearer = 1): void {
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

  async picture(): Promise<Blob> {
    this.drawNow(1);
    return new Promise((resolve, reject) => {
      this.canvas.toBlob((blob) => {
        if (blob) resolve(blob);
        else reject(new Failure('The browser could not save the picture.'));
      });
    });
  }

  // Of textures, a pixel on average: of the whole picture and of its pixels on the box.
  countFetches(): { ofPicture: number; ofBox: number } {
    this.look.countsFetches = true;
    this.drawNow(1);
    this.look.countsFetches = false;
    const context = this.renderer.getContext();
    const { drawingBufferWidth: width, drawingBufferHeight: height } = context;
    const pixels = new Uint8Array(4 * width * height);
    context.readPixels(0, 0, width, height, context.RGBA, context.UNSIGNED_BYTE, pixels);
    let total = 0;
    let filled = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] === 0) continue;
      total += pixels[i] + 256 * pixels[i + 1];
      ++filled;
    }
    this.drawNow(1);
    return { ofPicture: total / (width * height), ofBox: total / Math.max(filled, 1) };
  }

  private rays(): Rays {
    const { drawingBufferWidth: width, drawingBufferHeight: height } = this.renderer.getContext();
    const [right, up, back] = [new three.Vector3(), new three.Vector3(), new three.Vector3()];
    this.camera.matrixWorld.extractBasis(right, up, back);
    const half = Math.tan(three.MathUtils.degToRad(0.5 * this.camera.fov));
    right.multiplyScalar((2 * half * this.camera.aspect) / width);
    up.multiplyScalar((2 * half) / height);
    const corner = back.negate().addScaledVector(right, -0.5 * width);
    return { corner: corner.addScaledVector(up, -0.5 * height), right, up };
  }

  private aim(aspect: number): void {
    const half = Math.tan(three.MathUtils.degToRad(0.5 * this.header.camera.angle));
    const vertical = aspect < 1 ? half / aspect : half;
    const distance = this.camera.position.distanceTo(this.sphere.center);
    this.camera.fov = three.MathUtils.radToDeg(2 * Math.atan(vertical));
    this.camera.aspect = aspect;
    this.camera.near = Math.max(distance - this.sphere.radius, 0.01 * this.sphere.radius);
    this.camera.far = 1.01 * (distance + this.sphere.radius);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
}
