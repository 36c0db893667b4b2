// SPDX-License-Identifier: MIT
// A picture of the sensor with what was found in it: drawn, and measured for focus and exposure.

export interface Peaks {
  seq: number;
  region_px: [number, number, number, number];
  step: number;
  u_px: Uint16Array;
  v_px: Float32Array;
  flags: Uint8Array;
}

/// profile::PointFlag's low byte; 'good' where none is set that says anything against the point.
const marks: { name: PeakMark; bit: number }[] = [
  { name: 'reflection', bit: 0x20 },
  { name: 'clipped', bit: 0x02 },
  { name: 'saturated', bit: 0x01 },
  { name: 'wide', bit: 0x04 },
  { name: 'narrow', bit: 0x08 },
  { name: 'discontinuous', bit: 0x40 },
];
export type PeakMark = 'good' | 'reflection' | 'clipped' | 'saturated' | 'wide' | 'narrow' | 'discontinuous';
/// Told apart without colour, too: the page names each with its count.  Legible on a dark picture.
export const mark_colours: Record<PeakMark, string> = {
  good: '#39d353',
  reflection: '#ff5ad6',
  clipped: '#ff8c1a',
  saturated: '#ff4d4d',
  wide: '#4db8ff',
  narrow: '#b38cff',
  discontinuous: '#ffe14d',
};

export function mark_of(flags: number): PeakMark {
  return marks.find(({ bit }) => (flags & bit) !== 0)?.name ?? 'good';
}

export function count_marks(peaks: Peaks): Map<PeakMark, number> {
  const counts = new Map<PeakMark, number>();
  for (const flags of peaks.flags) counts.set(mark_of(flags), (counts.get(mark_of(flags)) ?? 0) + 1);
  return counts;
}

export interface Measures {
  /// Grey level of each picture column's brightest pixel, and of each row's mean.
  columns: number[];
  rows: number[];
  /// Full width at half height about each found peak [px of the sensor]; null where nothing was measured.
  widths_px: (number | null)[];
  /// Middle one of the widths; smaller is sharper.
  width_px: number | null;
  /// Mean steepest step about the peaks [grey levels a px]; larger is sharper.
  sharpness: number | null;
  /// Share of the peaks whose brightest pixel is at full scale.
  saturated: number | null;
}

const full_scale = 250; // JPEG takes some levels off 255

/// Of the pixels as they came; a scaled picture blurs: widths are right from `step` 1 to some pixels wide.
export function measure(grey: Uint8ClampedArray, width: number, height: number, peaks: Peaks): Measures {
  const columns: number[] = new Array(width).fill(0);
  const rows: number[] = new Array(height).fill(0);
  for (let y = 0; y < height; ++y) {
    let sum = 0;
    for (let x = 0; x < width; ++x) {
      const level = grey[4 * (y * width + x)]!;
      sum += level;
      if (level > columns[x]!) columns[x] = level;
    }
    rows[y] = sum / width;
  }
  const widths_px: (number | null)[] = new Array(width).fill(null);
  const found: number[] = [];
  let steps = 0;
  let saturated = 0;
  const at = (x: number, y: number) => grey[4 * (y * width + x)]!;
  for (let i = 0; i < peaks.u_px.length; ++i) {
    if (mark_of(peaks.flags[i]!) === 'reflection') continue;
    const x = Math.floor((peaks.u_px[i]! - peaks.region_px[0]) / peaks.step);
    const y = Math.round((peaks.v_px[i]! - peaks.region_px[1] + 0.5) / peaks.step - 0.5);
    if (x < 0 || x >= width || y < 1 || y >= height - 1) continue;
    const top = at(x, y);
    if (top === 0) continue;
    if (top >= full_scale) ++saturated;
    const edge = (way: number) => {
      let steepest = 0;
      for (let k = 1; y + way * k >= 0 && y + way * k < height; ++k) {
        const inner = at(x, y + way * (k - 1));
        const outer = at(x, y + way * k);
        steepest = Math.max(steepest, inner - outer);
        if (outer < top / 2) return { off: k - 1 + (inner - top / 2) / Math.max(1, inner - outer), steepest };
      }
      return null;
    };
    const above = edge(-1);
    const below = edge(1);
    if (!above || !below) continue;
    widths_px[x] = (above.off + below.off) * peaks.step;
    found.push(widths_px[x]!);
    steps += Math.max(above.steepest, below.steepest) / peaks.step;
  }
  found.sort((a, b) => a - b);
  const any = found.length > 0;
  return {
    columns,
    rows,
    widths_px,
    width_px: any ? found[Math.floor(found.length / 2)]! : null,
    sharpness: any ? steps / found.length : null,
    saturated: any ? saturated / found.length : null,
  };
}

/// The picture with its peaks, a dot each.
export function draw_peaks(
  c: CanvasRenderingContext2D,
  peaks: Peaks,
  shown: (mark: PeakMark) => boolean,
): void {
  for (let i = 0; i < peaks.u_px.length; ++i) {
    const mark = mark_of(peaks.flags[i]!);
    if (!shown(mark)) continue;
    c.fillStyle = mark_colours[mark];
    const x = (peaks.u_px[i]! - peaks.region_px[0] + 0.5) / peaks.step - 0.5;
    const y = (peaks.v_px[i]! - peaks.region_px[1] + 0.5) / peaks.step - 0.5;
    c.fillRect(x - 0.5, y - 0.5, mark === 'good' ? 1 : 2, mark === 'good' ? 1 : 2);
  }
}
