// SPDX-License-Identifier: MIT
// Binary live data, as openapi.yaml's /live describes them: little endian, byte 0 is the kind.
import type { LiveSensor } from 'openapi';
import type { Peaks } from './sensor_picture';
import { socket_address } from './store';

export type LiveMessage =
  | { kind: 'picture'; seq: number; jpeg: Blob }
  | { kind: 'profile'; seq: number; xz_mm: Float32Array; flags: Uint8Array }
  /// x y z (mm), curvature (1/mm), sigma (mm) of each point
  | { kind: 'cloud'; scan: number; points: Float32Array }
  | { kind: 'line'; values: Float32Array }
  | { kind: 'arm'; joints_rad: number[]; tip_mm: [number, number, number] }
  | { kind: 'peaks'; peaks: Peaks }
  | { kind: 'sensor'; state: LiveSensor };

function read_peaks(view: DataView): Peaks | null {
  const count = view.byteLength >= 17 ? view.getUint16(15, true) : 0;
  if (view.byteLength < 17 + 7 * count) return null;
  const short = (at: number) => view.getUint16(at, true);
  const peaks: Peaks = {
    seq: view.getUint32(1, true),
    region_px: [short(5), short(7), short(9), short(11)],
    step: Math.max(1, short(13)),
    u_px: new Uint16Array(count),
    v_px: new Float32Array(count),
    flags: new Uint8Array(count),
  };
  for (let i = 0; i < count; ++i) {
    peaks.u_px[i] = short(17 + 7 * i);
    peaks.v_px[i] = view.getFloat32(19 + 7 * i, true);
    peaks.flags[i] = view.getUint8(23 + 7 * i);
  }
  return peaks;
}

function read_sensor(buffer: ArrayBuffer): LiveSensor | null {
  try {
    return JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 1))) as LiveSensor;
  } catch {
    return null;
  }
}

/// Null for what is cut off or of a kind that this page does not know.
export function read_live(buffer: ArrayBuffer): LiveMessage | null {
  const view = new DataView(buffer);
  const size = buffer.byteLength;
  if (size < 1) return null;
  const kind = view.getUint8(0);
  if (kind === 1 && size > 13) {
    const jpeg = new Blob([buffer.slice(13)], { type: 'image/jpeg' });
    return { kind: 'picture', seq: view.getUint32(1, true), jpeg };
  }
  if (kind === 2 && size >= 15) {
    const count = view.getUint16(13, true);
    if (size < 15 + 9 * count) return null;
    const xz_mm = new Float32Array(2 * count);
    const flags = new Uint8Array(count);
    for (let i = 0; i < count; ++i) {
      xz_mm[2 * i] = view.getFloat32(15 + 9 * i, true);
      xz_mm[2 * i + 1] = view.getFloat32(19 + 9 * i, true);
      flags[i] = view.getUint8(23 + 9 * i);
    }
    return { kind: 'profile', seq: view.getUint32(1, true), xz_mm, flags };
  }
  if (kind === 3 && size >= 9) {
    const count = view.getUint32(5, true);
    if (size < 9 + 20 * count) return null;
    return {
      kind: 'cloud',
      scan: view.getUint32(1, true),
      points: new Float32Array(buffer.slice(9, 9 + 20 * count)),
    };
  }
  if (kind === 4 && size >= 5) {
    const count = view.getUint32(1, true);
    if (size < 5 + 20 * count) return null;
    return { kind: 'line', values: new Float32Array(buffer.slice(5, 5 + 20 * count)) };
  }
  if (kind === 5 && size >= 81) {
    const value = (i: number) => view.getFloat64(1 + 8 * i, true);
    return { kind: 'arm', joints_rad: [1, 2, 3, 4, 5, 6].map(value), tip_mm: [value(7), value(8), value(9)] };
  }
  if (kind === 6 && size >= 17) {
    const peaks = read_peaks(view);
    return peaks && { kind: 'peaks', peaks };
  }
  if (kind === 7) {
    const state = read_sensor(buffer);
    return state && { kind: 'sensor', state };
  }
  return null;
}

/// Calls `take` for each message until stopped; connects again by itself.
export function watch_live(take: (message: LiveMessage) => void): () => void {
  let stopped = false;
  let socket: WebSocket | null = null;
  let wait_ms = 500;
  const open = () => {
    if (stopped) return;
    socket = new WebSocket(socket_address('/live'));
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      wait_ms = 500;
    };
    socket.onmessage = (message) => {
      if (!(message.data instanceof ArrayBuffer)) return;
      const read = read_live(message.data);
      if (read) take(read);
    };
    socket.onclose = () => {
      setTimeout(open, wait_ms);
      wait_ms = Math.min(5000, 2 * wait_ms);
    };
  };
  open();
  return () => {
    stopped = true;
    socket?.close();
  };
}
