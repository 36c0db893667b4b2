// SPDX-License-Identifier: MIT
// The API as openapi.yaml describes it.
import type { Upkeep } from './upkeep';

export type Role = 'viewer' | 'operator' | 'engineer' | 'administrator';
export const roles: Role[] = ['viewer', 'operator', 'engineer', 'administrator'];

export interface Me {
  name: string;
  role: Role;
  expires?: string;
  control?: boolean;
  local?: boolean;
}
export interface Session {
  expires: string;
  user: Me;
  not_kept?: string;
}
export interface Control {
  holder: string | null;
  door?: string;
  since?: string;
  why?: string;
}
export interface Lamp {
  level: 'unknown' | 'off' | 'ok' | 'warning' | 'fault';
  words: string;
}
export interface State {
  version: string;
  simulated?: boolean;
  phase: string;
  now: string;
  next: string;
  scan?: string | null;
  progress: number | null;
  lamps: Record<string, Lamp>;
  cycle?: { this_s?: number | null; last_s?: number | null };
  model?: { name: string; probability?: number } | null;
  /// Of the scan in work or held; between scans of the next one, null where its model decides.
  process?: string | null;
  /// Whose word that process is; null: the model's or the service's own.
  process_by?: string | null;
  held?: Held | null;
  day?: Day;
  control: Control;
  seq: number;
}
/// The factory's: filters and trends go by it.
export interface Day {
  zone: string;
  begin: string;
}
/// The scan that waits for a person, and how long the gate lets it through for its age.
export interface Held {
  scan: string;
  waits_for: 'word' | 'path' | 'model';
  fresh_s: number | null;
  /// Of what a yes is said to: line, cloud, process and path.
  version?: string | null;
  /// Why a yes would come to nothing.
  sendable?: boolean;
  reason?: string | null;
  next_step?: string | null;
}
export type Verdict = 'working' | 'ok' | 'amber' | 'review' | 'refused' | 'failed';
export interface ScanRow {
  id: string;
  time: string;
  verdict: Verdict;
  decision: 'open' | 'automatic' | 'accepted' | 'rejected' | 'held';
  decided_by?: string | null;
  why?: string | null;
  model?: string | null;
  process?: string | null;
  reason_code?: string | null;
  reason?: string | null;
  next_step?: string | null;
  length_mm?: number | null;
  confidence?: number | null;
  u95_mm?: number | null;
  weak_stretches?: number | null;
  scan_s?: number | null;
  line_s?: number | null;
  cycle_s?: number | null;
  sent?: boolean;
  followed?: boolean | null;
  operator?: string | null;
  version?: string;
  line_version?: number;
  kept?: boolean;
}
export interface LineVersion {
  version: number;
  time: string;
  who: string;
  why?: string;
}
/// A kept scan worked out again, beside its result.
export interface Rerun {
  rerun: number;
  time: string;
  who: string;
  why?: string | null;
  settings: { model?: string; method?: string; process?: string; mirror?: boolean; grade?: boolean };
  state: 'working' | 'done' | 'lost';
  verdict?: 'ok' | 'review' | 'refused';
  reason?: string | null;
  next_step?: string | null;
  length_mm?: number | null;
  confidence?: number | null;
  line?: string | null;
  path?: string | null;
}
/// What became of the last run in the air.
export interface AirRun {
  state: 'begun' | 'refused' | 'stopped' | 'followed';
  reason?: string | null;
  next_step?: string | null;
  duration_s?: number | null;
}
export interface Scan extends ScanRow {
  report: Record<string, unknown> | null;
  gate?: Record<string, unknown> | null;
  follow?: Record<string, unknown> | null;
  air?: AirRun | null;
  /// The process of the list that its path was planned with, byte by byte.
  process_file?: string | null;
  versions?: LineVersion[];
  reruns?: Rerun[];
}
export interface Model {
  name: string;
  time?: string;
  scan?: string | null;
  process?: string | null;
  size?: string | null;
  foot?: 'left' | 'right' | null;
  version?: number;
  length_mm?: number | null;
  scans?: number;
}
export interface TriedProcess {
  scan: string | null;
  fits: boolean | null;
  duration_s?: number | null;
  reason?: string | null;
  next_step?: string | null;
}

export interface ProcessRow {
  name: string;
  shipped: boolean;
  time?: string | null;
  who?: string | null;
}
export interface Robot {
  name: string;
  address?: string;
  serial?: string | null;
  connected: boolean;
  powered?: boolean | null;
  remote?: boolean | null;
  ready?: boolean;
  words?: string;
}
export interface Clock {
  name: string;
  known: boolean;
  offset_ns?: number;
  uncertainty_ns?: number;
  drift_ppm?: number;
  steps?: number;
}
export interface Sensor {
  name: string;
  connected: boolean;
  clocks?: Clock[];
  upkeep?: Upkeep | null;
  fault?: string | null;
  next_step?: string | null;
  [key: string]: unknown;
}
export interface Disk {
  free_bytes: number;
  total_bytes: number;
}
export interface User {
  name: string;
  role: Role;
  enabled: boolean;
  made?: string;
  last_login?: string | null;
}
export interface LogEntry {
  seq: number;
  time: string;
  who: string;
  door?: string;
  what: string;
  subject?: string | null;
  before?: unknown;
  after?: unknown;
}
export interface Bucket {
  time: string;
  scans: number;
  ok: number;
  amber: number;
  review: number;
  refused: number;
  failed: number;
  cycle_s?: number | null;
  u95_mm?: number | null;
  length_mm?: number | null;
}
export interface Trends {
  buckets: Bucket[];
  reasons: { reason_code: string; scans: number }[];
  capability?: {
    model?: string;
    tolerance_mm?: number;
    scans?: number;
    pp?: number[];
    ppk?: number[];
  } | null;
}
export interface FileRow {
  path: string;
  bytes: number;
  time: string;
}
/// One part of what is mounted, with who taught it and how well it is known.
export interface Taught {
  version: number;
  who: string;
  time: string;
  touches?: number;
  residual_mm?: number;
  u95_mm?: number;
  at_mm?: [number, number, number];
  kg?: number;
  centre_mm?: [number, number, number];
  z_mm?: number;
  tip_version?: number;
}
export interface Mounted {
  version: number;
  tip: Taught | null;
  payload: Taught | null;
  table: Taught | null;
  /// Touches that are not kept yet.
  lesson: {
    part: 'tip' | 'table';
    touches: number;
    at_mm?: [number, number, number] | null;
    z_mm?: number | null;
    residual_mm?: number | null;
    u95_mm?: number | null;
    missing: string | null;
  } | null;
  /// What it said last.
  controller: {
    tip_mm: [number, number, number];
    payload_kg?: number | null;
    payload_centre_mm?: [number, number, number] | null;
    carries_as_taught?: boolean | null;
  } | null;
}
/// JSON Schema, as far as processes use it.
export interface Schema {
  type?: string | string[];
  title?: string;
  description?: string;
  properties?: Record<string, Schema>;
  required?: string[];
  items?: Schema;
  minItems?: number;
  maxItems?: number;
  enum?: (string | number)[];
  minimum?: number;
  maximum?: number;
  default?: unknown;
  'x-unit'?: string;
}

export interface Fault {
  field: string;
  message: string;
}

/// What the server refused, in its own words.
export class Refused extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    message: string,
    readonly faults: Fault[],
  ) {
    super(message);
  }
}

export const base = '/api/v1';

export function file_address(scan: string, path: string): string {
  return `${base}/scans/${scan}/files/${path.split('/').map(encodeURIComponent).join('/')}`;
}

/// A body of JSON, or none.
export function call<T>(method: string, path: string, body?: unknown): Promise<T> {
  return body === undefined
    ? ask<T>(path, { method })
    : ask<T>(path, { method, headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) });
}

/// A file as the body; throws as call() does.
export function send_file<T>(path: string, file: Blob, type: string): Promise<T> {
  return ask<T>(path, { method: 'POST', headers: { 'content-type': type }, body: file });
}

/// Throws Refused; `no_answer` when no server was reached.
async function ask<T>(path: string, request: RequestInit): Promise<T> {
  let answer: Response;
  try {
    answer = await fetch(base + path, { ...request, credentials: 'same-origin' });
  } catch {
    throw new Refused(0, 'no_answer', '', []);
  }
  const text = await answer.text();
  let value: unknown = null;
  try {
    value = text ? JSON.parse(text) : null;
  } catch {
    if (answer.ok) throw new Refused(answer.status, 'internal', text.slice(0, 200), []);
  }
  if (answer.ok) return value as T;
  const error = (value as { error?: { code?: string; message?: string; faults?: Fault[] } } | null)?.error;
  throw new Refused(
    answer.status,
    error?.code ?? 'internal',
    error?.message ?? answer.statusText,
    error?.faults ?? [],
  );
}

export function query(values: Record<string, string | number | undefined | null>): string {
  const parts = Object.entries(values)
    .filter(([, value]) => value !== undefined && value !== null && value !== '')
    .map(([name, value]) => `${name}=${encodeURIComponent(String(value))}`);
  return parts.length > 0 ? `?${parts.join('&')}` : '';
}
