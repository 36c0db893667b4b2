// SPDX-License-Identifier: MIT
// How the page asks the API; what it says has the types that `npm run types` makes of openapi.yaml.
import type { Fault } from 'openapi';

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
