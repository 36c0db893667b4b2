// SPDX-License-Identifier: MIT
// What the page knows of the cell; events keep it fresh, and the link comes back by itself.
import { useEffect, useState } from 'preact/hooks';
import type { FleetState, Me, Role, ScanRow, Sensor, Session, State } from 'openapi';
import { locale, set_zone, t, t_or, time_zone } from '../words';
import { Refused, base, call } from './api';

export interface Told {
  id: number;
  text: string;
  bad: boolean;
}
interface Store {
  me: Me | null;
  /// False until the first answer about who I am.
  known: boolean;
  state: State | null;
  /// At the factory's centre, in the place of a cell's state.
  centre: FleetState | null;
  /// The link to the web program, and the web program's to the service.
  linked: boolean;
  host: boolean;
  told: Told[];
  /// Goes up with each change of a scan or model: lists read themselves again.
  turn: number;
  scan: ScanRow | null;
  health: { time_s: number; sensor: Sensor }[];
}

let store: Store = {
  me: null,
  known: false,
  state: null,
  centre: null,
  linked: true,
  host: true,
  told: [],
  turn: 0,
  scan: null,
  health: [],
};
const watchers = new Set<() => void>();

export function change(part: Partial<Store>): void {
  store = { ...store, ...part };
  for (const watcher of watchers) watcher();
}

export function use_store(): Store {
  const [, set] = useState(0);
  useEffect(() => {
    const watcher = () => set((n) => n + 1);
    watchers.add(watcher);
    watcher();
    return () => {
      watchers.delete(watcher);
    };
  }, []);
  return store;
}

export const roles: Role[] = ['viewer', 'operator', 'engineer', 'administrator'];

export function may(role: Role): boolean {
  return store.me !== null && roles.indexOf(store.me.role) >= roles.indexOf(role);
}

export function holds_control(): boolean {
  return store.me !== null && store.state?.control.holder === store.me.name;
}

/// The cell takes this command now; a service that does not say so takes or refuses it itself.
export function offered(command: NonNullable<State['offers']>[number]): boolean {
  return store.state?.offers?.includes(command) ?? true;
}

let next_id = 1;
export function tell(text: string, bad = false): void {
  const id = next_id++;
  change({ told: [...store.told.slice(-3), { id, text, bad }] });
  if (!bad) setTimeout(() => hush(id), 6000);
}
export function hush(id: number): void {
  change({ told: store.told.filter((one) => one.id !== id) });
}

export function words_of(error: unknown): string {
  if (error instanceof Refused)
    return t_or(`code_${error.code}`, error.message) + (error.code in own_words ? '' : detail(error));
  return error instanceof Error ? error.message : String(error);
}
/// Codes whose own words say all.
const own_words: Record<string, true> = { no_answer: true, login_needed: true, host_away: true };
function detail(error: Refused): string {
  const known = t_or(`code_${error.code}`, '') !== '';
  return known && error.message ? ` (${error.message})` : '';
}

/// Does it, tells what became of it; false when it was refused.
export async function act(done: string, work: () => Promise<unknown>): Promise<boolean> {
  try {
    await work();
    tell(done);
    change({ turn: store.turn + 1 });
    return true;
  } catch (error) {
    if (error instanceof Refused && error.code === 'login_needed') change({ me: null });
    tell(words_of(error), true);
    return false;
  }
}

/// A browser notes each 401 as an error: who never logged in here is not asked for.
const session_mark = 'biteline_session';
function mark_session(on: boolean): void {
  try {
    if (on) localStorage.setItem(session_mark, '1');
    else localStorage.removeItem(session_mark);
  } catch {
    // Without storage the page asks each time.
  }
}
export function may_have_session(): boolean {
  try {
    return localStorage.getItem(session_mark) !== null;
  } catch {
    return true;
  }
}

export async function read_me(): Promise<void> {
  try {
    change({ me: await call<Me>('GET', '/me'), known: true });
    mark_session(true);
    await read_state();
    watch();
  } catch (error) {
    if (error instanceof Refused && error.status === 401) {
      mark_session(false);
      change({ me: null, known: true });
    } else {
      change({
        known: true,
        linked: !(error instanceof Refused && error.code === 'no_answer'),
        host: !(error instanceof Refused && error.code === 'host_away'),
      });
      setTimeout(() => void read_me(), 2000);
    }
  }
}

export async function read_state(): Promise<void> {
  try {
    const state = await call<State | FleetState>('GET', '/state');
    set_zone(state.day?.zone);
    change({ ...('kind' in state ? { centre: state } : { state }), host: true, turn: store.turn + 1 });
  } catch (error) {
    if (error instanceof Refused && error.code === 'host_away') change({ host: false });
    else if (error instanceof Refused && error.status === 401) change({ me: null });
  }
}

export async function log_in(body: Record<string, unknown>): Promise<void> {
  const session = await call<Session>('POST', '/sessions', { ...body, cookie: true });
  if (session.not_kept) tell(`${t('login_not_kept')} (${session.not_kept})`, true);
  await read_me();
}

export async function log_out(): Promise<void> {
  try {
    await call('DELETE', '/sessions');
  } catch (error) {
    // Without an answer the page forgets it all the same; the session ends by its time.
    if (error instanceof Refused && error.code === 'disk_full') tell(words_of(error), true);
  }
  mark_session(false);
  socket?.close();
  change({ me: null, state: null });
}

export function socket_address(path: string): string {
  return `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}${base}${path}`;
}

let socket: WebSocket | null = null;
let seq = -1;
let wait_ms = 500;

/// Follows the events; after a gap or a break it reads the state again.
function watch(): void {
  if (socket && socket.readyState <= WebSocket.OPEN) return;
  const mine = new WebSocket(socket_address('/events'));
  socket = mine;
  mine.onopen = () => {
    wait_ms = 500;
    seq = -1;
    const came_back = !store.linked;
    change({ linked: true });
    if (came_back) void read_me();
    else void read_state();
  };
  mine.onmessage = (message) => {
    try {
      take(JSON.parse(String(message.data)));
    } catch {
      // A message that is none is as good as a gap.
      void read_state();
    }
  };
  mine.onclose = () => {
    if (socket !== mine) return;
    socket = null;
    if (!store.me) return;
    // Without the service the web program takes no watcher: that is told already.
    if (store.host) change({ linked: false });
    setTimeout(again, wait_ms);
    wait_ms = Math.min(5000, 2 * wait_ms);
  };
}

/// A server that asks for a login again is told from one that is away.
async function again(): Promise<void> {
  if (!store.me) return;
  try {
    await call<Me>('GET', '/me');
  } catch (error) {
    if (error instanceof Refused && error.status === 401) {
      change({ me: null, linked: true });
      return;
    }
    // The web program answers, the service behind it does not.
    if (error instanceof Refused && error.code === 'host_away') change({ linked: true, host: false });
    if (error instanceof Refused && error.code === 'no_answer') change({ linked: false });
  }
  watch();
}

function take(event: { event: string; seq?: number; time: string; data: unknown }): void {
  if (event.seq !== undefined && event.event !== 'host') {
    if (seq >= 0 && event.seq > seq + 1) void read_state();
    seq = event.seq;
  }
  if (event.event === 'state') change({ state: event.data as State });
  else if (event.event === 'host') {
    const connected = (event.data as { connected: boolean }).connected;
    change({ host: connected });
    if (connected) void read_state();
  } else if (event.event === 'control' && store.state)
    change({ state: { ...store.state, control: event.data as State['control'] } });
  else if (event.event === 'scan') change({ scan: event.data as ScanRow, turn: store.turn + 1 });
  else if (event.event === 'health') {
    const sample = { time_s: Date.parse(event.time) / 1000, sensor: event.data as Sensor };
    change({ health: [...store.health.slice(-599), sample] });
  } else if (event.event === 'model' || event.event === 'teaching') change({ turn: store.turn + 1 });
}

/// Reads `path` whenever it or a turn changes; keeps the last value meanwhile.
export function use_reading<T>(path: string | null): { value: T | null; error: string } {
  const { turn, linked, host } = use_store();
  const [got, set] = useState<{ path: string | null; value: T | null; error: string }>({
    path: null,
    value: null,
    error: '',
  });
  useEffect(() => {
    let alive = true;
    if (path === null) return;
    call<T>('GET', path)
      .then((value) => alive && set({ path, value, error: '' }))
      .catch((error) => {
        if (!alive) return;
        if (error instanceof Refused && error.status === 401) change({ me: null });
        // The line at the top says it for all.
        const told_above =
          error instanceof Refused && (error.code === 'host_away' || error.code === 'no_answer');
        set((before) => ({
          path,
          value: before.path === path ? before.value : null,
          error: told_above ? '' : words_of(error),
        }));
      });
    return () => {
      alive = false;
    };
  }, [path, turn, linked, host]);
  return got.path === path ? got : { value: null, error: '' };
}

export function time_words(iso: string | null | undefined): string {
  if (!iso) return t('never');
  const time = new Date(iso);
  return Number.isNaN(time.getTime()) ? iso : time.toLocaleString(locale(), { timeZone: time_zone() });
}
