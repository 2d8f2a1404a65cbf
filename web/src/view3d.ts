// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
import {
  BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, EdgesGeometry, HemisphereLight, LineBasicMaterial,
  LineSegments, Matrix4, Mesh as Mesh3, MeshLambertMaterial, Object3D, PerspectiveCamera, Points, PointsMaterial, Scene,
  Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { Rows } from './data';
import type { Mesh } from './packet';

export interface Coloured {
  points: Float32Array;
  colours: Float32Array; // r g b, 0 to 1
}

export interface Part {
  mesh: Mesh;
  pose: Rows;
  colour: string;
  style: 'solid' | 'edges';
}

/** One three-dimensional view: points in one draw call, parts at poses. It draws only when something has changed. */
export class View3d {
  readonly canvas = document.createElement('canvas');
  readonly available: boolean;
  seeThrough = false;
  lastRenderMs = 0;
  renders = 0;
  private renderer?: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(40, 1, 1, 20000);
  private controls?: OrbitControls;
  private readonly points = new Points(
    new BufferGeometry(),
    new PointsMaterial({ vertexColors: true, size: 1, sizeAttenuation: true }),
  );
  private readonly normals = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true }));
  private readonly parts = new Object3D();
  private readonly solids = new WeakMap<Mesh, BufferGeometry>();
  private readonly edges = new WeakMap<Mesh, BufferGeometry>();
  private readonly centre = new Vector3(0, 0, 600);
  private aimed: Float32Array = new Float32Array([-100, -100, 500, 100, 100, 700]);
  private pending = false;
  private untouched = true; // nobody has turned the view since it was aimed

  constructor() {
    this.canvas.tabIndex = 0;
    this.canvas.className = 'view3d';
    this.canvas.setAttribute('aria-label', '3-D view: drag to turn, right-drag to move, wheel to zoom');
    try {
      this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true, powerPreference: 'high-performance' });
    } catch {
      this.available = false;
      return;
    }
    this.available = true;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const light = new DirectionalLight(0xffffff, 1.6);
    light.position.set(-40, 70, 60);
    light.target.position.set(0, 0, -100);
    this.camera.add(light, light.target);  // it comes over the left shoulder, wherever one stands
    this.scene.add(new HemisphereLight(0xffffff, 0xb0b8c4, 1.3), this.camera, this.points, this.normals, this.parts);
    this.points.frustumCulled = false;
    this.normals.frustumCulled = false;
    this.camera.up.set(0, -1, 0); // the camera's y axis points down
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => this.invalidate());
    this.controls.addEventListener('start', () => (this.untouched = false));
    new ResizeObserver(() => this.resize()).observe(this.canvas);
  }

  /** What is looked at: the box of these points. */
  aim(points: Float32Array): void {
    if (points.length === 0) return;
    const lo = [Infinity, Infinity, Infinity];
    const hi = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < points.length; ++i) {
      lo[i % 3] = Math.min(lo[i % 3], points[i]);
      hi[i % 3] = Math.max(hi[i % 3], points[i]);
    }
    this.centre.set((lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2, (lo[2] + hi[2]) / 2);
    this.aimed = points;
    this.lookAsCamera();
  }

  /** From the sensor's side, so near that what is looked at fills the view. */
  lookAsCamera(): void {
    const forward = this.centre.clone().normalize();
    const right = new Vector3().crossVectors(forward, this.camera.up).normalize();
    const up = new Vector3().crossVectors(right, forward);
    const vertical = Math.tan((this.camera.fov * Math.PI) / 360) * 0.84;
    const horizontal = vertical * this.camera.aspect;
    const offset = new Vector3();
    let distance = 1;
    for (let i = 0; i < this.aimed.length; i += 3) {
      offset.fromArray(this.aimed, i).sub(this.centre);
      const needed = Math.max(Math.abs(offset.dot(up)) / vertical, Math.abs(offset.dot(right)) / horizontal);
      distance = Math.max(distance, needed - offset.dot(forward));
    }
    this.camera.position.copy(this.centre).addScaledVector(forward, -distance);
    this.camera.near = Math.max(1, distance / 200);
    this.camera.far = distance * 40;
    this.camera.updateProjectionMatrix();
    this.controls?.target.copy(this.centre);
    this.controls?.update();
    this.untouched = true;
    this.invalidate();
  }

  turn(aroundUp: number, aroundRight: number): void {
    this.untouched = false;
    const offset = this.camera.position.clone().sub(this.centre);
    offset.applyAxisAngle(this.camera.up, aroundUp);
    const right = new Vector3().crossVectors(this.camera.up, offset).normalize();
    const tilted = offset.clone().applyAxisAngle(right, aroundRight);
    if (Math.abs(tilted.clone().normalize().dot(this.camera.up)) < 0.98) offset.copy(tilted);
    this.camera.position.copy(this.centre).add(offset);
    this.controls?.update();
    this.invalidate();
  }

  zoom(factor: number): void {
    this.untouched = false;
    this.camera.position.sub(this.centre).multiplyScalar(factor).add(this.centre);
    this.controls?.update();
    this.invalidate();
  }

  showPoints(cloud: Coloured, sizeMm: number): void {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(cloud.points, 3));
    geometry.setAttribute('color', new BufferAttribute(cloud.colours, 3));
    this.points.geometry.dispose();
    this.points.geometry = geometry;
    (this.points.material as PointsMaterial).size = sizeMm;
    this.invalidate();
  }

  /** Short lines along the normals of about 1500 points; null: none. */
  showNormals(points: Float32Array, normals: Float32Array | null, lengthMm: number): void {
    const ends: number[] = [];
    const colours: number[] = [];
    const step = normals ? Math.max(1, Math.ceil(points.length / 3 / 1500)) : 1;
    for (let i = 0; normals && i < points.length; i += 3 * step) {
      for (const along of [0, lengthMm]) {
        for (let a = 0; a < 3; ++a) ends.push(points[i + a] + along * normals[i + a]);
        colours.push(0.5 + 0.5 * normals[i], 0.5 + 0.5 * normals[i + 1], 0.5 - 0.5 * normals[i + 2]);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(ends), 3));
    geometry.setAttribute('color', new BufferAttribute(new Float32Array(colours), 3));
    this.normals.geometry.dispose();
    this.normals.geometry = geometry;
    this.invalidate();
  }

  showParts(parts: Part[]): void {
    for (const object of [...this.parts.children]) {
      this.parts.remove(object);
      const material = (object as Mesh3).material;
      for (const m of Array.isArray(material) ? material : [material]) m.dispose();
    }
    for (const part of parts) {
      const object =
        part.style === 'solid'
          ? new Mesh3(
              this.solidOf(part.mesh),
              new MeshLambertMaterial({
                color: new Color(part.colour), flatShading: true, side: DoubleSide, transparent: this.seeThrough,
                opacity: this.seeThrough ? 0.35 : 1, depthWrite: !this.seeThrough,
                polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2,
              }),
            )
          : new LineSegments(this.edgesOf(part.mesh), new LineBasicMaterial({ color: new Color(part.colour) }));
      const r = part.pose;
      object.matrixAutoUpdate = false;
      object.matrix = new Matrix4().set(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9], r[10], r[11], 0, 0, 0, 1);
      this.parts.add(object);
    }
    this.invalidate();
  }

  background(colour: string): void {
    this.scene.background = new Color(colour);
    this.invalidate();
  }

  invalidate(): void {
    if (this.pending || !this.renderer) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.render();
    });
  }

  /** Draws now. Returns the milliseconds that the call took. */
  render(): number {
    const start = performance.now();
    this.renderer?.render(this.scene, this.camera);
    this.lastRenderMs = performance.now() - start;
    ++this.renders;
    return this.lastRenderMs;
  }

  get drawCalls(): number {
    return this.renderer?.info.render.calls ?? 0;
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (!this.renderer || clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (this.untouched) this.lookAsCamera();
    this.render();
  }

  private solidOf(mesh: Mesh): BufferGeometry {
    let geometry = this.solids.get(mesh);
    if (!geometry) {
      geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(mesh.points, 3));
      geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
      this.solids.set(mesh, geometry);
    }
    return geometry;
  }

  private edgesOf(mesh: Mesh): BufferGeometry {
    let geometry = this.edges.get(mesh);
    if (!geometry) {
      geometry = new EdgesGeometry(this.solidOf(mesh), 25);
      this.edges.set(mesh, geometry);
    }
    return geometry;
  }
}
