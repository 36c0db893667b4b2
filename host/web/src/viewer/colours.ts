// SPDX-License-Identifier: MIT
// One colour scale for all figures: viridis, whose lightness rises throughout, so that it reads without hue.

export type Rgb = [number, number, number];

const viridis: Rgb[] = [
  [68, 1, 84],
  [71, 44, 122],
  [59, 81, 139],
  [44, 113, 142],
  [33, 144, 141],
  [39, 173, 129],
  [92, 200, 99],
  [170, 220, 50],
  [253, 231, 37],
];

/// `share` in 0..1, clamped; components 0..1.
export function colour_of(share: number): Rgb {
  const x = Math.min(1, Math.max(0, Number.isFinite(share) ? share : 0)) * (viridis.length - 1);
  const i = Math.min(viridis.length - 2, Math.floor(x));
  const f = x - i;
  const a = viridis[i]!;
  const b = viridis[i + 1]!;
  return [0, 1, 2].map((k) => (a[k]! + f * (b[k]! - a[k]!)) / 255) as Rgb;
}

export const gradient = `linear-gradient(90deg, ${viridis.map((c) => `rgb(${c.join(',')})`).join(', ')})`;

export interface Scale {
  low: number;
  high: number;
  unit: string;
}
