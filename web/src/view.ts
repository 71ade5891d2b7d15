// SPDX-License-Identifier: GPL-3.0-or-later
// Draws a look from the camera on the canvas.

import * as three from 'three';

import type { Header } from './bake';
import { Failure, showFailure } from './failure';
import { positionOf } from './framing';
import { type Isosurface, type Rays, Result } from './isosurface';
import type { Viewpoint } from './link';
import type { Look } from './look';
import { Orbit } from './orbit';
import { Pace } from './pace';
import type { Wall } from './walls';

const REST_MS = 150; // without a change, before the full resolution is drawn
const AHEAD = { width: 16, height: 9 }; // rays that look for obstacles of the camera
const GAP = 0.05; // least distance of the camera, in sizes of the isosurface

export class View {
  readonly orbit: Orbit;
  private readonly renderer: three.WebGLRenderer;
  private readonly scene = new three.Scene();
  private readonly pace = new Pace();
  private readonly sphere = new three.Sphere();
  private readonly listeners: ((atRest: boolean) => void)[] = [];
  private frame = 0; // requested frame; 0: none
  private isStarted = false;
  private fullDetail: ReturnType<typeof setTimeout> | undefined;

  constructor(
    readonly canvas: HTMLCanvasElement,
    context: WebGL2RenderingContext,
    private readonly header: Header,
    private readonly isosurfaces: Isosurface[],
    private readonly walls: Wall[],
    public look: Look,
  ) {
    this.renderer = new three.WebGLRenderer({ canvas, context, alpha: true });
    this.renderer.debug.onShaderError = (gl, program) => {
      throw new Failure(
        'The driver of the graphics card refuses this page ' +
          `(${gl.getProgramInfoLog(program) ?? ''}): open it in another browser.`,
      );
    };
    // The shaders encode colors.
    this.renderer.outputColorSpace = three.LinearSRGBColorSpace;
    this.renderer.setClearColor(0, 0);
    for (const each of [...walls, ...isosurfaces]) this.scene.add(each.mesh);
    const box = new three.Box3();
    for (const { mesh } of walls) box.expandByObject(mesh);
    for (const point of header.bounds) box.expandByPoint(new three.Vector3(...point));
    box.getBoundingSphere(this.sphere);
    const changed = () => { this.changed(); }; // prettier-ignore
    this.orbit = new Orbit(canvas, Math.max(...header.camera.half), changed, () => this.ahead());
    this.resetCamera();
    new ResizeObserver(changed).observe(canvas);
    canvas.addEventListener('webglcontextlost', () => {
      showFailure(new Failure('The graphics card has stopped: close other pages, then reload.'));
    });
  }

  get camera(): three.PerspectiveCamera {
    return this.orbit.camera;
  }

  // Callback after each picture.
  onDrawn(listener: (atRest: boolean) => void): void {
    this.listeners.push(listener);
  }

  // Compiles the shaders and uploads the data. Throws Failure if memory is too small.
  async start(): Promise<void> {
    // Compile in the background if the driver supports it.
    await this.renderer.compileAsync(this.scene, this.camera);
    this.drawNow(1);
    this.isStarted = true;
    const context = this.renderer.getContext();
    for (let error = context.getError(); error !== 0; error = context.getError()) {
      if (error === context.OUT_OF_MEMORY) {
        throw new Failure(
          'This volume does not fit into the memory of the graphics card: export it coarser.',
        );
      }
    }
    this.changed();
  }

  // Schedules a frame after a change of the look, the camera or the size.
  changed(): void {
    if (!this.isStarted) return;
    this.canvas.dataset.state = 'moving';
    clearTimeout(this.fullDetail);
    if (this.frame !== 0) return;
    this.frame = requestAnimationFrame((now) => {
      this.frame = 0;
      this.drawNow(this.pace.share);
      for (const listener of this.listeners) listener(false);
      requestAnimationFrame((next) => {
        this.pace.took(next - now);
      });
      this.fullDetail = setTimeout(() => {
        this.drawNow(1);
        this.canvas.dataset.state = 'rest';
        for (const listener of this.listeners) listener(true);
      }, REST_MS);
    });
  }

  // Draws at a share of the screen's resolution.
  drawNow(share: number): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(share * window.devicePixelRatio);
    this.renderer.setSize(width, height, false);
    this.draw();
  }

  resetCamera(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.orbit.viewpoint = this.firstViewpoint(width || 1, height || 1);
  }

  // Returns the camera position from which the isosurface fills a picture.
  firstViewpoint(width: number, height: number): Viewpoint {
    const { camera } = this.header;
    return { position: positionOf(camera, width, height), target: camera.target, up: camera.up };
  }

  // Returns a picture of this width in pixels, with the aspect of the view.
  async picture(pixels = this.canvas.clientWidth * window.devicePixelRatio): Promise<Blob> {
    this.drawNow(pixels / (this.canvas.clientWidth * window.devicePixelRatio));
    const blob = await new Promise<Blob | null>((resolve) => {
      this.canvas.toBlob(resolve);
    });
    this.drawNow(1);
    if (!blob) throw new Failure('The browser could not save the picture.');
    return blob;
  }

  // Returns the world position on the isosurfaces at a pixel of the page, or null.
  placeAt(x: number, y: number): three.Vector3 | null {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.aim(width / height);
    const rays = this.rays(width, height);
    const way = rays.corner
      .clone()
      .addScaledVector(rays.right, x)
      .addScaledVector(rays.up, height - y);
    this.camera.setViewOffset(width, height, x - 0.5, y - 0.5, 1, 1);
    const none = new three.Vector3();
    const [distance] = this.distances(1, 1, { corner: way, right: none, up: none });
    this.camera.clearViewOffset();
    return Number.isFinite(distance)
      ? this.camera.position.clone().addScaledVector(way, distance)
      : null;
  }

  // Counts texture fetches per pixel: means of the whole picture and of pixels on the box.
  countFetches(): { ofPicture: number; ofBox: number } {
    this.drawNow(1);
    const { drawingBufferWidth: width, drawingBufferHeight: height } = this.renderer.getContext();
    const pixels = this.bytes(width, height, this.rays(width, height), Result.Fetches);
    let total = 0;
    let filled = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] === 0) continue;
      total += pixels[i] + 256 * pixels[i + 1];
      ++filled;
    }
    return { ofPicture: total / (width * height), ofBox: total / Math.max(filled, 1) };
  }

  // Returns how far the camera may move forward.
  private ahead(): number {
    this.aim(this.canvas.clientWidth / Math.max(this.canvas.clientHeight, 1));
    const { width, height } = AHEAD;
    const nearest = Math.min(...this.distances(width, height, this.rays(width, height)));
    return nearest - GAP * Math.max(...this.header.camera.half);
  }

  // Returns distances to the isosurfaces along the view direction, by pixel; infinite for none.
  private distances(width: number, height: number, rays: Rays): Float32Array {
    const pixels = this.bytes(width, height, rays, Result.Distances);
    return new Float32Array(pixels.buffer).map((distance) => (distance > 0 ? distance : Infinity));
  }

  // Returns another output of the isosurface shader than the picture, four bytes per pixel.
  private bytes(width: number, height: number, rays: Rays, result: Result): Uint8Array<ArrayBuffer> {
    const target = new three.WebGLRenderTarget(width, height);
    for (const wall of this.walls) wall.mesh.visible = false;
    for (const isosurface of this.isosurfaces) isosurface.show(this.look, this.camera, rays, result);
    this.renderer.setRenderTarget(target);
    this.renderer.clear();
    this.renderer.render(this.scene, this.camera);
    this.renderer.setRenderTarget(null);
    const pixels = new Uint8Array(4 * width * height);
    this.renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
    target.dispose();
    return pixels;
  }

  private draw(): void {
    const { drawingBufferWidth: width, drawingBufferHeight: height } = this.renderer.getContext();
    this.aim(width / height);
    const rays = this.rays(width, height);
    for (const isosurface of this.isosurfaces) isosurface.show(this.look, this.camera, rays, Result.Picture);
    for (const wall of this.walls) wall.show(this.look, this.camera);
    this.renderer.render(this.scene, this.camera);
  }

  // Returns the rays of a picture with this many pixels.
  private rays(width: number, height: number): Rays {
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
