// SPDX-License-Identifier: MIT
// Cloud, line and path in 3-D.  Orthographic, so that the scale bar holds everywhere.  Frame: the shoe's.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { colour_of, type Rgb, type Scale } from './colours';
import { plus, section, u95_of_confidence_mm, type LinePoint, type Vec, type View } from './view_data';

export type ViewName = 'fit' | 'top' | 'left' | 'right' | 'toe' | 'heel';
export type Layer = 'cloud' | 'line' | 'path' | 'weak' | 'candidates' | 'names' | 'other';
export type CloudColour = 'grey' | 'height';
export type LineColour = 'confidence' | 'u95' | 'height' | 'source';

const directions: Record<ViewName, Vec> = {
  fit: [-0.35, -0.75, 0.55],
  top: [0, -1e-4, 1],
  left: [0, 1, 0],
  right: [0, -1, 0],
  toe: [1, 0, 0],
  heel: [-1, 0, 0],
};

const source_shares: Record<string, number> = { seen: 1, carried: 0.75, mended: 0.4, bridged: 0.1 };

export interface Label {
  key: string;
  text: string;
  at: Vec;
}

/// Says where its labels and its scale bar are; the page draws them.
export interface Overlay {
  labels: { key: string; text: string; x: number; y: number; hidden: boolean }[];
  px_per_mm: number;
}

export function line_scale(view: View, by: LineColour): Scale {
  if (by === 'confidence') return { low: 0, high: 1, unit: '' };
  if (by === 'u95') {
    const most = Math.max(0.2, ...view.line.map((p) => p.u95_mm ?? u95_of_confidence_mm(p.confidence)));
    return { low: 0, high: Math.min(3, Math.ceil(most * 10) / 10), unit: 'mm' };
  }
  if (by === 'source') return { low: 0, high: 1, unit: '' };
  const heights = view.line.map((p) => p.shoe[2]);
  return { low: Math.min(...heights), high: Math.max(...heights), unit: 'mm' };
}

export function line_value(point: LinePoint, by: LineColour): number {
  if (by === 'confidence') return point.confidence;
  if (by === 'u95') return point.u95_mm ?? u95_of_confidence_mm(point.confidence);
  if (by === 'source') return source_shares[point.source] ?? 0;
  return point.shoe[2];
}

export class Scene {
  readonly canvas: HTMLCanvasElement;
  on_overlay: (overlay: Overlay) => void = () => {};
  on_pick: (index: number) => void = () => {};

  private renderer: THREE.WebGLRenderer;
  private scene = new THREE.Scene();
  private camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -5000, 5000);
  private controls: OrbitControls;
  private layers: Record<Layer, THREE.Group> = {
    cloud: new THREE.Group(),
    line: new THREE.Group(),
    path: new THREE.Group(),
    weak: new THREE.Group(),
    candidates: new THREE.Group(),
    names: new THREE.Group(),
    other: new THREE.Group(),
  };
  private mark = new THREE.Group();
  private line_materials: LineMaterial[] = [];
  private labels: Label[] = [];
  private frame = 0;
  private watcher: ResizeObserver;
  private size_mm: number;
  private middle: THREE.Vector3;

  /// Throws where the browser offers no WebGL.
  constructor(
    private box: HTMLElement,
    private view: View,
    names: Label[],
  ) {
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute('aria-hidden', 'true');
    box.prepend(this.canvas);
    const low = new THREE.Vector3(...view.low);
    const high = new THREE.Vector3(...view.high);
    this.size_mm = Math.max(20, high.distanceTo(low));
    this.middle = low.clone().lerp(high, 0.5);
    for (const group of Object.values(this.layers)) this.scene.add(group);
    this.scene.add(this.mark);
    this.labels = names;

    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    // The wheel scrolls the page until the view was touched.
    this.controls.enableZoom = false;
    this.canvas.addEventListener('pointerdown', this.touched);
    this.canvas.addEventListener('pointerup', this.released);
    box.addEventListener('pointerleave', this.left);
    this.controls.addEventListener('change', this.draw);

    this.colour_cloud('grey');
    this.build_path();
    this.build_weak();
    this.build_candidates();
    this.colour_line('confidence');
    this.watcher = new ResizeObserver(() => this.resize());
    this.watcher.observe(box);
    this.resize();
    this.look('fit');
  }

  dispose(): void {
    cancelAnimationFrame(this.frame);
    this.watcher.disconnect();
    this.controls.dispose();
    this.box.removeEventListener('pointerleave', this.left);
    for (const group of Object.values(this.layers)) clear(group);
    clear(this.mark);
    this.renderer.dispose();
    this.canvas.remove();
  }

  look(name: ViewName): void {
    const distance = 2 * this.size_mm;
    this.controls.target.copy(this.middle);
    const direction = new THREE.Vector3(...directions[name]).normalize();
    this.camera.position.copy(this.middle).addScaledVector(direction, distance);
    this.camera.zoom = 1;
    this.camera.lookAt(this.middle);
    this.fit();
    this.controls.update();
    this.draw();
  }

  /// Centres on a point of the line, near.
  look_at(index: number): void {
    const at = new THREE.Vector3(...this.view.line[index]!.shoe);
    const way = this.camera.position.clone().sub(this.controls.target);
    const n = this.view.line[index]!.normal;
    way
      .set(n[0], n[1], Math.max(0.5, n[2]))
      .normalize()
      .multiplyScalar(2 * this.size_mm);
    this.controls.target.copy(at);
    this.camera.position.copy(at).add(way);
    this.camera.zoom = Math.max(this.camera.zoom, 4);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  zoom(factor: number): void {
    this.camera.zoom = Math.min(60, Math.max(0.3, this.camera.zoom * factor));
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /// Turns about the middle, radians.
  turn(azimuth: number, elevation: number): void {
    const spherical = new THREE.Spherical();
    const way = this.camera.position.clone().sub(this.controls.target);
    // Spherical's pole is y; ours is z.
    spherical.setFromVector3(new THREE.Vector3(way.x, way.z, -way.y));
    spherical.theta += azimuth;
    spherical.phi = Math.min(Math.PI - 0.01, Math.max(0.01, spherical.phi + elevation));
    const turned = new THREE.Vector3().setFromSpherical(spherical);
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(turned.x, -turned.z, turned.y));
    this.controls.update();
    this.draw();
  }

  show(layer: Layer, on: boolean): void {
    this.layers[layer].visible = on;
    this.draw();
  }

  colour_cloud(by: CloudColour): void {
    const group = this.layers.cloud;
    clear(group);
    const { cloud, low, high } = this.view;
    if (cloud.length === 0) return;
    const colours = new Float32Array(cloud.length);
    const extent = Math.max(1, high[2] - low[2]);
    for (let i = 0; i + 2 < cloud.length; i += 3) {
      const share = (cloud[i + 2]! - low[2]) / extent;
      // Grey in both themes: between the light and the dark ground.
      const grey: Rgb = [0.36 + 0.34 * share, 0.38 + 0.34 * share, 0.42 + 0.34 * share];
      const c: Rgb = by === 'height' ? colour_of(share) : grey;
      colours.set(by === 'height' ? c.map((x) => 0.15 + 0.75 * x) : c, i);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(cloud, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
    const material = new THREE.PointsMaterial({ size: 2.4, sizeAttenuation: false, vertexColors: true });
    group.add(new THREE.Points(geometry, material));
    this.draw();
  }

  colour_line(by: LineColour): void {
    const group = this.layers.line;
    clear(group);
    this.line_materials = [];
    const { line } = this.view;
    if (line.length < 2) return;
    const scale = line_scale(this.view, by);
    const closed = [...line, line[0]!];
    // The line lies in the groove, between points: a little before it, it is not cut up by them.
    const before = (mm: number) => closed.flatMap((p) => plus(p.shoe, p.normal, mm));
    const colours = closed.flatMap((p) => {
      const share = (line_value(p, by) - scale.low) / Math.max(1e-9, scale.high - scale.low);
      // A large U95 is what a person looks for: it is the bright end.
      return colour_of(share);
    });
    // A dark rim under the line keeps it apart from the cloud; what the shoe hides is drawn faint.
    this.add_line(group, before(0.5), null, 8, 1, true);
    this.add_line(group, before(1), colours, 4.5, 1, true);
    this.add_line(group, before(0), colours, 2, 0.35, false);
    this.resize();
  }

  /// Another scan's line, dashed, in this shoe's frame.
  compare(points: Vec[]): void {
    clear(this.layers.other);
    if (points.length > 1) {
      const round = [...points, points[0]!].map((p) => new THREE.Vector3(...p));
      const geometry = new THREE.BufferGeometry().setFromPoints(round);
      const line = new THREE.Line(
        geometry,
        new THREE.LineDashedMaterial({ color: 0xd1006c, dashSize: 5, gapSize: 3, depthTest: false }),
      );
      line.computeLineDistances();
      line.renderOrder = 6;
      this.layers.other.add(line);
    }
    this.draw();
  }

  /// Another way over a stretch, before somebody takes it; none: nothing is shown.
  preview(points: Vec[]): void {
    clear(this.layers.other);
    if (points.length > 1) {
      const geometry = new LineGeometry();
      geometry.setPositions(points.flat());
      const material = new LineMaterial({ color: 0x2f7de1, linewidth: 5, depthTest: false });
      material.resolution.set(Math.max(1, this.box.clientWidth), Math.max(1, this.box.clientHeight));
      const line = new Line2(geometry, material);
      line.renderOrder = 6;
      this.layers.other.add(line);
    }
    this.draw();
  }

  /// A ring about a point of the line, its normal, and the frame of its section.
  choose(index: number | null, reach_mm: number): void {
    clear(this.mark);
    if (index !== null && this.view.line[index]) {
      const cut = section(this.view, index, 0, 0);
      const at = new THREE.Vector3(...cut.at.shoe);
      const ball = new THREE.Mesh(
        new THREE.SphereGeometry(1.4, 20, 14),
        new THREE.MeshBasicMaterial({ color: 0xd1006c, depthTest: false }),
      );
      ball.position.copy(at);
      ball.renderOrder = 5;
      const out = new THREE.Vector3(...cut.out);
      const up = new THREE.Vector3(...cut.up);
      const arrow = new THREE.ArrowHelper(new THREE.Vector3(...cut.at.normal), at, 14, 0xd1006c, 4, 2.4);
      const corners = [
        [1, 1],
        [-1, 1],
        [-1, -1],
        [1, -1],
        [1, 1],
      ].map(([a, b]) =>
        at
          .clone()
          .addScaledVector(out, a! * reach_mm)
          .addScaledVector(up, b! * reach_mm),
      );
      const frame = new THREE.Line(
        new THREE.BufferGeometry().setFromPoints(corners),
        new THREE.LineBasicMaterial({ color: 0xd1006c }),
      );
      this.mark.add(ball, arrow, frame);
    }
    this.draw();
  }

  private build_path(): void {
    if (this.view.path.length < 2) return;
    const geometry = new THREE.BufferGeometry().setFromPoints(
      this.view.path.map((p) => new THREE.Vector3(...p)),
    );
    const path = new THREE.Line(
      geometry,
      new THREE.LineDashedMaterial({ color: 0x2f7de1, dashSize: 4, gapSize: 2 }),
    );
    path.computeLineDistances();
    this.layers.path.add(path);
  }

  /// A thick band beside each weak stretch: seen without its colour.
  private build_weak(): void {
    const { line, data, length_mm } = this.view;
    for (const stretch of data.report.weak_stretches ?? []) {
      const middle = stretch.from_mm + stretch.length_mm / 2;
      const points = line
        .filter(
          (p) =>
            Math.abs(((p.at_mm - middle + 1.5 * length_mm) % length_mm) - length_mm / 2) <=
            stretch.length_mm / 2 + 0.6,
        )
        .map(
          (p) =>
            [p.shoe[0] + 2 * p.normal[0], p.shoe[1] + 2 * p.normal[1], p.shoe[2] + 2 * p.normal[2]] as Vec,
        );
      const geometry = new THREE.SphereGeometry(0.9, 10, 8);
      const material = new THREE.MeshBasicMaterial({ color: 0xe07b00 });
      for (const [i, p] of points.entries()) {
        if (i % 3 !== 0) continue;
        const bead = new THREE.Mesh(geometry, material);
        bead.position.set(...p);
        this.layers.weak.add(bead);
      }
    }
  }

  /// Of a refused scan: the best candidate, the others dashed, and beads where the best one failed.
  private build_candidates(): void {
    for (const [which, { places, failed }] of this.view.candidates.entries()) {
      if (places.length < 3) continue;
      const round = [...places, places[0]!].map((p) => new THREE.Vector3(...p));
      const geometry = new THREE.BufferGeometry().setFromPoints(round);
      const material =
        which === 0
          ? new THREE.LineBasicMaterial({ color: 0xd1006c, depthTest: false })
          : new THREE.LineDashedMaterial({
              color: 0x8a5a9a,
              dashSize: 5,
              gapSize: 4,
              transparent: true,
              opacity: 0.7,
              depthTest: false,
            });
      const line = new THREE.Line(geometry, material);
      line.computeLineDistances();
      line.renderOrder = 6;
      this.layers.candidates.add(line);
      const at = places.filter((_, i) => failed[i]);
      if (at.length === 0) continue;
      const bead = new THREE.SphereGeometry(1.3, 10, 8);
      const beads = new THREE.InstancedMesh(
        bead,
        new THREE.MeshBasicMaterial({ color: 0xe07b00, depthTest: false }),
        at.length,
      );
      const placed = new THREE.Matrix4();
      for (const [i, p] of at.entries()) beads.setMatrixAt(i, placed.makeTranslation(...p));
      beads.renderOrder = 7;
      this.layers.candidates.add(beads);
    }
  }

  private add_line(
    group: THREE.Group,
    positions: number[],
    colours: number[] | null,
    width: number,
    opacity: number,
    hidden_by_cloud: boolean,
  ): void {
    const geometry = new LineGeometry();
    geometry.setPositions(positions);
    if (colours) geometry.setColors(colours);
    const material = new LineMaterial({
      color: colours ? 0xffffff : 0x101418,
      vertexColors: colours !== null,
      linewidth: width,
      transparent: opacity < 1,
      opacity,
      depthTest: hidden_by_cloud,
      // Seen along the normals, rim and line lie at one depth: the rim gives way.
      polygonOffset: colours === null,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 8,
    });
    const line = new Line2(geometry, material);
    line.renderOrder = colours ? 3 : 2;
    this.line_materials.push(material);
    group.add(line);
  }

  private pressed = { x: 0, y: 0 };
  private touched = (event: PointerEvent): void => {
    this.controls.enableZoom = true;
    this.pressed = { x: event.clientX, y: event.clientY };
  };
  private left = (): void => {
    this.controls.enableZoom = false;
  };
  private released = (event: PointerEvent): void => {
    if (Math.hypot(event.clientX - this.pressed.x, event.clientY - this.pressed.y) > 5) return;
    const rect = this.canvas.getBoundingClientRect();
    const index = this.nearest(event.clientX - rect.left, event.clientY - rect.top);
    if (index !== null) this.on_pick(index);
  };

  /// The line's point nearest to a place on the canvas, within 40 px (gloves).
  private nearest(x: number, y: number): number | null {
    let best: number | null = null;
    let least = 40;
    const p = new THREE.Vector3();
    const facing = this.camera.position.clone().sub(this.controls.target).normalize();
    this.view.line.forEach((point, i) => {
      p.set(...point.shoe).project(this.camera);
      const away = Math.hypot(
        (p.x * 0.5 + 0.5) * this.canvas.clientWidth - x,
        (0.5 - p.y * 0.5) * this.canvas.clientHeight - y,
      );
      const behind = dot3(point.normal, facing) < -0.2 ? 15 : 0;
      if (away + behind < least) {
        least = away + behind;
        best = i;
      }
    });
    return best;
  }

  private fit(): void {
    const width = Math.max(1, this.box.clientWidth);
    const height = Math.max(1, this.box.clientHeight);
    this.camera.updateMatrixWorld();
    // Half the extent of the box as it is seen.
    const right = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const up = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    const half = new THREE.Vector3(...this.view.high)
      .sub(new THREE.Vector3(...this.view.low))
      .multiplyScalar(0.5);
    const along = (v: THREE.Vector3) =>
      Math.abs(v.x) * half.x + Math.abs(v.y) * half.y + Math.abs(v.z) * half.z;
    const mm_per_px = Math.max((2.3 * along(right)) / width, (2.4 * along(up)) / height);
    this.camera.left = (-width / 2) * mm_per_px;
    this.camera.right = (width / 2) * mm_per_px;
    this.camera.top = (height / 2) * mm_per_px;
    this.camera.bottom = (-height / 2) * mm_per_px;
    this.camera.updateProjectionMatrix();
  }

  private resize(): void {
    const width = Math.max(1, this.box.clientWidth);
    const height = Math.max(1, this.box.clientHeight);
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    for (const material of this.line_materials) material.resolution.set(width, height);
    this.fit();
    this.draw();
  }

  draw = (): void => {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => {
      this.renderer.render(this.scene, this.camera);
      const width = this.canvas.clientWidth;
      const height = this.canvas.clientHeight;
      const p = new THREE.Vector3();
      this.on_overlay({
        px_per_mm: (width * this.camera.zoom) / (this.camera.right - this.camera.left),
        labels: this.labels.map((label) => {
          p.set(...label.at).project(this.camera);
          const x = (p.x * 0.5 + 0.5) * width;
          const y = (0.5 - p.y * 0.5) * height;
          const outside = x < 0 || y < 0 || x > width || y > height;
          // Near the edge a name moves in, so that it is read whole.
          const inside = Math.min(Math.max(x, 40), Math.max(40, width - 40));
          return {
            key: label.key,
            text: label.text,
            x: inside,
            y,
            hidden: outside || !this.layers.names.visible,
          };
        }),
      });
    });
  };
}

function dot3(a: Vec, b: THREE.Vector3): number {
  return a[0] * b.x + a[1] * b.y + a[2] * b.z;
}

function clear(group: THREE.Group): void {
  for (const child of [...group.children]) {
    group.remove(child);
    child.traverse((node) => {
      const part = node as THREE.Mesh;
      part.geometry?.dispose();
      for (const material of [part.material].flat()) material?.dispose();
    });
  }
}
