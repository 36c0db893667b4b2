// SPDX-License-Identifier: MIT
// How long what waits may still be sent: the gate refuses a scan that is too old.
import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import { number, t } from '../words';
import { call } from './api';
import { act, holds_control, may, offered, use_store } from './store';

/// Seconds left, 0 when it is too old; null: no scan waits with a path, or nobody saw it come in.
export function use_fresh(): number | null {
  const held = use_store().state?.held ?? null;
  const [left, set_left] = useState<number | null>(null);
  useEffect(() => {
    const told = Date.now();
    const fresh_s = held?.fresh_s ?? null;
    const look = () => set_left(fresh_s === null ? null : Math.max(0, fresh_s - (Date.now() - told) / 1000));
    look();
    const timer = setInterval(look, 1000);
    return () => clearInterval(timer);
  }, [held]);
  return left;
}

/// A yes to this scan goes to the gate: the service says so, and it has not grown too old since.
export function use_sendable(scan: string): boolean {
  const held = use_store().state?.held ?? null;
  const left = use_fresh();
  return held?.scan === scan && held.sendable !== false && offered('accept') && left !== 0;
}

/// A yes is to what this page shows: where the service holds another version by now it is none.
export function use_shown_version(scan: string): { version?: string } {
  const held = use_store().state?.held ?? null;
  return held?.scan === scan && held.version ? { version: held.version } : {};
}

/// Why a yes is not offered, and what helps.
export function NotSendable({ scan }: { scan: string }): JSX.Element | null {
  const held = use_store().state?.held ?? null;
  const sendable = use_sendable(scan);
  if (held?.scan !== scan || sendable) return null;
  return (
    <>
      <p class="notice look">{held.reason ? `${held.reason}. ${held.next_step ?? ''}` : t('fresh_over')}</p>
      {held.tool && <MountTool name={held.tool} />}
    </>
  );
}

/// Whoever has changed the tool says so where it is asked for.
function MountTool({ name }: { name: string }): JSX.Element {
  return (
    <button
      type="button"
      disabled={!may('operator') || !holds_control()}
      onClick={() => void act(t('mounted_tool_is', { name }), () => call('PUT', '/mounted/tool', { name }))}
    >
      {t('mounted_tool_is', { name })}
    </button>
  );
}

export function Fresh({ scan }: { scan: string }): JSX.Element | null {
  const held = use_store().state?.held ?? null;
  const left = use_fresh();
  if (held?.scan !== scan || held.waits_for !== 'word') return null;
  if (left !== null && left > 0) return <p class="quiet">{t('fresh_left', { seconds: number(left, 0) })}</p>;
  // Somebody vouched for it: it has no age.
  if (left === null && held.sendable) return null;
  return <p class="notice look">{left === null ? t('fresh_unseen') : t('fresh_over')}</p>;
}
