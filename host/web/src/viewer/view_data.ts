// SPDX-License-Identifier: MIT
// What a result folder's view_data.js says, and the same unpacked.  Lengths are mm.

export interface WeakStretch {
  place: string;
  from_mm: number;
  to_mm?: number;
  length_mm: number;
  least_confidence: number;
  u95_mm: number;
  u95_is_guessed: boolean;
  middle_mm: [number, number, number];
  /// Of a line for review: why it is open, and where the scan's other candidates run there.
  reason_code?: string;
  alternatives?: { candidate: number; off_mm: number; points: number[][] }[];
}

export interface Candidate {
  confidence: number;
  mean_height_mm?: number;
  length_mm: number;
  crease_deg?: number;
  seen_share?: number;
}

/// What one gate measured; `sure` is 0.5 at the limit.  The unit stands at the end of `measure`.
export interface Gate {
  reason_code: string;
  measure: string;
  value: number;
  at_least?: number;
  at_most?: number;
  sure: number;
}

/// schema_version 1.
export interface ViewData {
  schema_version: number;
  title: string;
  summary: string;
  found: boolean;
  report: {
    reason?: string;
    next_step?: string;
    weak_stretches?: WeakStretch[];
    candidates?: Candidate[];
    gates?: Gate[];
    /// Of a refused scan: the bit of `lacks` that its reason speaks of; 0: of no single place.
    lack?: number;
    [key: string]: unknown;
  };
  /// Row-major 4 x 4: x heel to toe, y left, z up.
  T_base_shoe?: number[];
  inner_side?: 'left' | 'right' | 'unknown';
  cloud?: { of: number; every: number; origin_mm: number[]; step_mm: number; xyz_u16: string };
  line?: {
    xyz_mm: number[][];
    normal: number[][];
    confidence: number[];
    u95_mm: (number | null)[];
    source: string[];
  };
  path_mm?: number[][];
  /// Of a refused scan, best first: places in the base, and what each lacks, as bits.
  candidates?: { points: number[][]; lacks?: number[] }[];
}

export interface ResultFile {
  file: string;
  words: string;
  bytes: number;
}

export type Vec = [number, number, number];

export interface LinePoint {
  base: Vec;
  shoe: Vec;
  /// Outward, unit, in the shoe's frame.
  normal: Vec;
  /// Unit, in the order of the points, in the shoe's frame.
  tangent: Vec;
  confidence: number;
  u95_mm: number | null;
  source: string;
  at_mm: number;
}

export interface View {
  data: ViewData;
  /// x y z of each point in the shoe's frame (in the line's own where no shoe is known).
  cloud: Float32Array;
  line: LinePoint[];
  length_mm: number;
  path: Vec[];
  candidates: { places: Vec[]; failed: boolean[] }[];
  low: Vec;
  high: Vec;
}

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/// The inverse of a rigid transform applied to a point.
function into(T: number[], p: ArrayLike<number>): Vec {
  const x = p[0]! - T[3]!;
  const y = p[1]! - T[7]!;
  const z = p[2]! - T[11]!;
  return [
    T[0]! * x + T[4]! * y + T[8]! * z,
    T[1]! * x + T[5]! * y + T[9]! * z,
    T[2]! * x + T[6]! * y + T[10]! * z,
  ];
}

function turned(T: number[], d: ArrayLike<number>): Vec {
  return [
    T[0]! * d[0]! + T[4]! * d[1]! + T[8]! * d[2]!,
    T[1]! * d[0]! + T[5]! * d[1]! + T[9]! * d[2]!,
    T[2]! * d[0]! + T[6]! * d[1]! + T[10]! * d[2]!,
  ];
}

export const minus = (a: Vec, b: Vec): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const plus = (a: Vec, b: Vec, s = 1): Vec => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
export const dot = (a: Vec, b: Vec): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vec, b: Vec): Vec => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const size = (a: Vec): number => Math.sqrt(dot(a, a));
export const unit = (a: Vec): Vec => {
  const s = size(a) || 1;
  return [a[0] / s, a[1] / s, a[2] / s];
};

function places(text: string): Uint16Array {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Uint16Array(bytes.buffer, 0, bytes.length >> 1);
}

/// Throws an Error with one line for a person when the data are not such.
export function unpack(data: ViewData): View {
  if (data.schema_version !== 1) throw new Error(`view data of version ${data.schema_version}, 1 expected`);
  const T = data.T_base_shoe?.length === 16 ? data.T_base_shoe : identity;
  const low: Vec = [Infinity, Infinity, Infinity];
  const high: Vec = [-Infinity, -Infinity, -Infinity];
  const grow = (p: ArrayLike<number>) => {
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k]!, p[k]!);
      high[k] = Math.max(high[k]!, p[k]!);
    }
  };

  let cloud = new Float32Array(0);
  if (data.cloud) {
    const packed = places(data.cloud.xyz_u16);
    const { origin_mm, step_mm } = data.cloud;
    cloud = new Float32Array(packed.length);
    for (let i = 0; i + 2 < packed.length; i += 3) {
      const p = into(
        T,
        [0, 1, 2].map((k) => origin_mm[k]! + step_mm * packed[i + k]!),
      );
      cloud.set(p, i);
      grow(p);
    }
  }

  const line: LinePoint[] = [];
  let length_mm = 0;
  if (data.line) {
    const shoe = data.line.xyz_mm.map((p) => into(T, p));
    const count = shoe.length;
    for (let i = 0; i < count; ++i) {
      const before = shoe[(i + count - 1) % count]!;
      const after = shoe[(i + 1) % count]!;
      grow(shoe[i]!);
      line.push({
        base: data.line.xyz_mm[i] as Vec,
        shoe: shoe[i]!,
        normal: turned(T, data.line.normal[i]!),
        tangent: unit(minus(after, before)),
        confidence: data.line.confidence[i]!,
        u95_mm: data.line.u95_mm[i] ?? null,
        source: data.line.source[i] ?? 'seen',
        at_mm: length_mm,
      });
      length_mm += size(minus(after, shoe[i]!));
    }
  }
  const lack = data.report.lack ?? 0;
  const candidates = (data.candidates ?? []).map(({ points, lacks }) => ({
    places: points.map((p) => into(T, p)),
    failed: points.map((_, i) => ((lacks?.[i] ?? 0) & lack) !== 0),
  }));
  for (const { places: shown } of candidates) for (const p of shown) grow(p);
  const path = (data.path_mm ?? []).map((p) => into(T, p));
  if (low[0] > high[0]) for (const p of path) grow(p);
  if (low[0] > high[0]) {
    grow([0, 0, 0]);
    grow([300, 100, 100]);
  }
  return { data, cloud, line, length_mm, path, candidates, low, high };
}

/// The text of view_data.js, as a server hands it out.
export function parse_view_data(text: string): ViewData {
  const begin = text.indexOf('{');
  const end = text.lastIndexOf('}');
  return JSON.parse(text.slice(begin, end + 1)) as ViewData;
}

/// As host/records/results does: 0.3 mm is what the confidence speaks of, the error is taken as Rayleigh's.
export function u95_of_confidence_mm(confidence: number): number {
  const outside = 1 - Math.min(1 - 1e-9, Math.max(1e-6, confidence));
  return Math.min(10, 0.3 * Math.sqrt(Math.log(0.05) / Math.log(outside)));
}

export interface SectionPoint {
  out_mm: number;
  up_mm: number;
}

export interface Section {
  at: LinePoint;
  /// Unit, across the line: outward, and upward.
  out: Vec;
  up: Vec;
  points: SectionPoint[];
}

/// Raw points within `half_thickness_mm` of the plane across the line, within `reach_mm` of it.
export function section(view: View, index: number, half_thickness_mm: number, reach_mm: number): Section {
  const at = view.line[index]!;
  const t = at.tangent;
  const out = unit(plus(at.normal, t, -dot(at.normal, t)));
  let up = cross(t, out);
  if (up[2] < 0) up = [-up[0], -up[1], -up[2]];
  const points: SectionPoint[] = [];
  const { cloud } = view;
  for (let i = 0; i + 2 < cloud.length; i += 3) {
    const d: Vec = [cloud[i]! - at.shoe[0], cloud[i + 1]! - at.shoe[1], cloud[i + 2]! - at.shoe[2]];
    if (Math.abs(dot(d, t)) > half_thickness_mm) continue;
    const out_mm = dot(d, out);
    const up_mm = dot(d, up);
    if (Math.abs(out_mm) <= reach_mm && Math.abs(up_mm) <= reach_mm) points.push({ out_mm, up_mm });
  }
  return { at, out, up, points };
}

/// A point of the shoe's frame in the robot's base.
export function in_base(view: View, p: Vec): Vec {
  const T = view.data.T_base_shoe?.length === 16 ? view.data.T_base_shoe : identity;
  return [0, 1, 2].map(
    (row) => T[4 * row]! * p[0] + T[4 * row + 1]! * p[1] + T[4 * row + 2]! * p[2] + T[4 * row + 3]!,
  ) as Vec;
}

/// A point of the robot's base in the shoe's frame.
export function in_shoe(view: View, p: ArrayLike<number>): Vec {
  return into(view.data.T_base_shoe?.length === 16 ? view.data.T_base_shoe : identity, p);
}

/// A place that a person has chosen, perhaps moved by hand in its section.
export interface Hand {
  at_mm: number;
  base: Vec;
}

export interface Difference {
  mean_mm: number;
  p95_mm: number;
  max_mm: number;
  /// Along this line, where it is largest.
  max_at_mm: number;
}

/// How far `view`'s line lies from another's, each in its own shoe's frame.  Null without two lines of a shoe.
export function difference(view: View, other: View): Difference | null {
  if (view.line.length < 3 || other.line.length < 3 || !view.data.T_base_shoe || !other.data.T_base_shoe)
    return null;
  const away = view.line.map((point) => {
    let least = Infinity;
    for (let i = 0; i < other.line.length; ++i) {
      const a = other.line[i]!.shoe;
      const d = minus(other.line[(i + 1) % other.line.length]!.shoe, a);
      const share = Math.min(1, Math.max(0, dot(minus(point.shoe, a), d) / Math.max(1e-12, dot(d, d))));
      least = Math.min(least, size(minus(point.shoe, plus(a, d, share))));
    }
    return { mm: least, at_mm: point.at_mm };
  });
  const sorted = away.map((one) => one.mm).sort((a, b) => a - b);
  const worst = away.reduce((a, b) => (b.mm > a.mm ? b : a));
  return {
    mean_mm: sorted.reduce((sum, mm) => sum + mm, 0) / sorted.length,
    p95_mm: sorted[Math.floor(0.95 * (sorted.length - 1))]!,
    max_mm: worst.mm,
    max_at_mm: worst.at_mm,
  };
}
