// SPDX-License-Identifier: MIT
// What the factory's centre answers (openapi.yaml, /fleet).

import type { Day } from './api';

/// In the place of a cell's state.
export interface FleetState {
  kind: 'fleet';
  version: string;
  broker: boolean;
  database: boolean;
  time: string;
  day?: Day;
}
export interface Sums {
  scans: number;
  ok: number;
  amber: number;
  review: number;
  refused: number;
  failed: number;
}
export interface Cell extends Sums {
  cell: string;
  online: boolean;
  heard: string;
  version: string;
  waiting: number;
  last: string | null;
}
export interface Group extends Sums {
  cell: string;
  model: string | null;
  length_mm: number | null;
  u95_mm: number | null;
  cycle_s: number | null;
}
export interface Trends {
  buckets: (Sums & { time: string; u95_mm?: number | null; cycle_s?: number | null })[];
  reasons: { reason_code: string; scans: number }[];
}
export interface Alarm {
  code: string;
  cell: string | null;
  model: string | null;
  value: number;
}
export interface Odd {
  cell: string;
  model: string;
  difference: string;
  mm: number;
  u95_mm: number;
  scans: number;
  since: string;
}
export interface Release {
  number: number;
  name: string;
  sha256: string;
  bytes: number;
  cells: { cell: string; ready: boolean; in_force: boolean; why: string | null }[];
}
export interface Fetch {
  number: number;
  cell: string;
  scan: string;
  state: 'asked' | 'coming' | 'whole' | 'refused' | 'removed';
  have: number;
  total: number;
  marked: boolean;
  words: string | null;
}
