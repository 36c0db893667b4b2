// SPDX-License-Identifier: MIT
// The cloud as it grows, the line and the tool tip's way, in the robot's base; z is up.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { colour_of, type Rgb, type Scale } from '../viewer/colours';

const most_points = 300_000;
export type LiveColour = 'height' | 'curvature' | 'uncertainty' | 'time';
/// Fixed, so that a colour means the same on every shoe: radii from 5 mm on, and a tenth of the limit of U95.
const fixed: Partial<Record<LiveColour, Scale>> = {
  curvature: { low: -0.2, high: 0.2, unit: '1/mm' },
  uncertainty: { low: 0, high: 0.1, unit: 'mm' },
};
/// Where nothing is known.
const unknown: Rgb = [0.5, 0.5, 0.5];

export class LiveScene {
  private renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
  private scene = new THREE.Scene();
  private camera = new THREE.OrthographicCamera(-200, 200, 120, -120, -5000, 5000);
  private controls: OrbitControls;
  private positions = new Float32Array(3 * most_points);
  private colours = new Float32Array(3 * most_points);
  private curvature_per_mm = new Float32Array(most_points);
  private sigma_mm = new Float32Array(most_points);
  private geometry = new THREE.BufferGeometry();
  private count = 0;
  private scan = -1;
  private box3 = new THREE.Box3();
  private line: THREE.LineLoop | null = null;
  private tip = new THREE.Mesh(
    new THREE.SphereGeometry(4, 16, 12),
    new THREE.MeshBasicMaterial({ color: 0xd1006c }),
  );
  private trail: THREE.Vector3[] = [];
  private trail_line = new THREE.Line(
    new THREE.BufferGeometry(),
    new THREE.LineBasicMaterial({ color: 0x2f7de1 }),
  );
  private watcher: ResizeObserver;
  private frame = 0;
  private touched = false;
  colour: LiveColour = 'height';

  /// Throws where the browser offers no WebGL.
  constructor(private box: HTMLElement) {
    this.renderer.domElement.setAttribute('aria-hidden', 'true');
    box.prepend(this.renderer.domElement);
    this.geometry.setAttribute('position', new THREE.BufferAttribute(this.positions, 3));
    this.geometry.setAttribute('color', new THREE.BufferAttribute(this.colours, 3));
    this.geometry.setDrawRange(0, 0);
    const dots = new THREE.PointsMaterial({ size: 2, sizeAttenuation: false, vertexColors: true });
    const points = new THREE.Points(this.geometry, dots);
    points.frustumCulled = false;
    this.trail_line.frustumCulled = false;
    this.tip.visible = false;
    this.scene.add(points, this.tip, this.trail_line);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-350, -750, 550);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableZoom = false;
    this.renderer.domElement.addEventListener('pointerdown', () => {
      this.touched = true;
      this.controls.enableZoom = true;
    });
    box.addEventListener('pointerleave', this.left);
    this.controls.addEventListener('change', this.draw);
    this.watcher = new ResizeObserver(() => this.fit());
    this.watcher.observe(box);
    this.fit();
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.watcher.disconnect();
    this.box.removeEventListener('pointerleave', this.left);
    this.controls.dispose();
    this.geometry.dispose();
    this.renderer.dispose();
    this.renderer.domElement.remove();
  }

  /// x y z (mm), curvature (1/mm), sigma (mm) of each point.
  add_cloud(scan: number, points: Float32Array): void {
    if (scan !== this.scan) {
      this.scan = scan;
      this.count = 0;
      this.box3.makeEmpty();
      this.set_line(new Float32Array(0));
      this.trail = [];
    }
    const p = new THREE.Vector3();
    for (let i = 0; i + 4 < points.length && this.count < most_points; i += 5) {
      this.curvature_per_mm[this.count] = points[i + 3]!;
      this.sigma_mm[this.count] = points[i + 4]!;
      this.positions.set(points.subarray(i, i + 3), 3 * this.count++);
      this.box3.expandByPoint(p.set(points[i]!, points[i + 1]!, points[i + 2]!));
    }
    this.recolour();
    if (!this.touched) this.fit();
    this.draw();
  }

  line_points(): number {
    return this.line?.geometry.getAttribute('position').count ?? 0;
  }

  /// x y z confidence u95 of each point.
  set_line(values: Float32Array): void {
    if (this.line) {
      this.scene.remove(this.line);
      this.line.geometry.dispose();
      this.line = null;
    }
    const count = Math.floor(values.length / 5);
    if (count > 1) {
      const geometry = new THREE.BufferGeometry();
      const places = new Float32Array(3 * count);
      for (let i = 0; i < count; ++i) {
        places.set(values.subarray(5 * i, 5 * i + 3), 3 * i);
        this.box3.expandByPoint(new THREE.Vector3(values[5 * i]!, values[5 * i + 1]!, values[5 * i + 2]!));
      }
      geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
      this.line = new THREE.LineLoop(
        geometry,
        new THREE.LineBasicMaterial({ color: 0xd1006c, depthTest: false }),
      );
      this.line.frustumCulled = false;
      this.scene.add(this.line);
      if (!this.touched) this.fit();
    }
    this.draw();
  }

  move_tip(tip_mm: [number, number, number]): void {
    this.tip.visible = true;
    this.tip.position.set(...tip_mm);
    this.trail = [...this.trail.slice(-1999), new THREE.Vector3(...tip_mm)];
    this.trail_line.geometry.dispose();
    this.trail_line.geometry = new THREE.BufferGeometry().setFromPoints(this.trail);
    this.draw();
  }

  /// What the ends of the colours mean; none while there is nothing, or where it is the order alone.
  scale(): Scale | null {
    if (this.count === 0 || this.colour === 'time') return null;
    return fixed[this.colour] ?? { low: this.box3.min.z, high: this.box3.max.z, unit: 'mm' };
  }

  private value(i: number): number {
    if (this.colour === 'curvature') return this.curvature_per_mm[i]!;
    if (this.colour === 'uncertainty') return this.sigma_mm[i]!;
    return this.positions[3 * i + 2]!;
  }

  recolour(): void {
    const scale = this.scale();
    for (let i = 0; i < this.count; ++i) {
      const share = scale
        ? (this.value(i) - scale.low) / Math.max(1e-6, scale.high - scale.low)
        : i / this.count;
      this.colours.set(Number.isFinite(share) ? colour_of(share) : unknown, 3 * i);
    }
    this.geometry.setDrawRange(0, this.count);
    this.geometry.attributes.position!.needsUpdate = true;
    this.geometry.attributes.color!.needsUpdate = true;
    this.draw();
  }

  points(): number {
    return this.count;
  }

  private left = (): void => {
    this.controls.enableZoom = false;
  };

  private fit(): void {
    const width = Math.max(1, this.box.clientWidth);
    const height = Math.max(1, this.box.clientHeight);
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    const empty = this.box3.isEmpty();
    const middle = empty ? new THREE.Vector3() : this.box3.getCenter(new THREE.Vector3());
    const size_mm = empty ? 400 : Math.max(50, this.box3.getSize(new THREE.Vector3()).length());
    if (!this.touched) {
      this.controls.target.copy(middle);
      this.camera.position.copy(middle).add(new THREE.Vector3(-0.35, -0.75, 0.55).multiplyScalar(1000));
    }
    const half = (0.55 * size_mm) / Math.min(1, (1.6 * height) / width);
    this.camera.left = -half;
    this.camera.right = half;
    this.camera.top = (half * height) / width;
    this.camera.bottom = (-half * height) / width;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  draw = (): void => {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.renderer.render(this.scene, this.camera));
  };
}
