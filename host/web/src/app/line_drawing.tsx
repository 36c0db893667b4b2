// SPDX-License-Identifier: MIT
// A scan's line seen from above, drawn of its line.csv: light enough for a whole library.
import type { JSX } from 'preact';
import { useEffect, useMemo, useState } from 'preact/hooks';
import type { Model, ScanRow } from 'openapi';
import { file_address } from './api';

type Place = [number, number, number];

/// Places of a line, mm; empty where the text is none.
export function read_line(csv: string): Place[] {
  return csv
    .split('\n')
    .filter((row) => /^-?\d/.test(row))
    .map((row) => row.split(',').slice(0, 3).map(Number) as Place)
    .filter((p) => p.length === 3 && p.every(Number.isFinite));
}

/// An imported model names a scan of the cell that it comes from; here another shoe may have that name.
const same_mm = 0.5;

/// Whether a scan's line is the one that a model was made of.
export function is_line_of(
  model: { length_mm?: number | null },
  scan: { length_mm?: number | null } | null,
): boolean {
  if (model.length_mm == null || scan?.length_mm == null) return false;
  return Math.abs(model.length_mm - scan.length_mm) < same_mm;
}

/// Turned so that the longer way lies across, about its middle.
function lying(points: Place[]): [number, number][] {
  const middle = [0, 1].map((k) => points.reduce((sum, p) => sum + p[k]!, 0) / points.length);
  let [xx, xy, yy] = [0, 0, 0];
  for (const [x, y] of points) {
    const [a, b] = [x - middle[0]!, y - middle[1]!];
    xx += a * a;
    xy += a * b;
    yy += b * b;
  }
  const turn_rad = 0.5 * Math.atan2(2 * xy, xx - yy);
  const [c, s] = [Math.cos(turn_rad), Math.sin(turn_rad)];
  return points.map(([x, y]) => {
    const [a, b] = [x - middle[0]!, y - middle[1]!];
    return [c * a + s * b, -s * a + c * b];
  });
}

/// Of a model, where the scan that it was made of is among `scans`.
export function LineDrawing(props: { model: Model; scans: ScanRow[]; label: string }): JSX.Element | null {
  const { model, label } = props;
  const row = props.scans.find((one) => one.id === model.scan) ?? null;
  const scan = is_line_of(model, row) ? (row?.id ?? null) : null;
  const [csv, set_csv] = useState('');
  useEffect(() => {
    let alive = true;
    if (scan === null) {
      set_csv('');
      return;
    }
    fetch(file_address(scan, 'line.csv'), { credentials: 'same-origin' })
      .then((answer) => (answer.ok ? answer.text() : ''))
      .then((text) => alive && set_csv(text))
      // A scan whose folder is gone has no picture.
      .catch(() => {});
    return () => {
      alive = false;
    };
  }, [scan]);
  const shape = useMemo(() => {
    const points = read_line(csv);
    if (points.length < 3) return null;
    const turned = lying(points);
    const reach = [0, 1].map((k) => Math.max(...turned.map((p) => Math.abs(p[k]!))) + 6);
    return {
      box: [-reach[0]!, -reach[1]!, 2 * reach[0]!, 2 * reach[1]!].map((v) => v.toFixed(1)).join(' '),
      path: `M${turned.map(([x, y]) => `${x.toFixed(1)} ${(-y).toFixed(1)}`).join('L')}Z`,
    };
  }, [csv]);
  if (!shape) return null;
  return (
    <svg class="line-drawing" viewBox={shape.box} role="img" aria-label={label}>
      <path d={shape.path} />
    </svg>
  );
}
