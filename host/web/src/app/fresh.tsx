// SPDX-License-Identifier: MIT
// How long what waits may still be sent: the gate refuses a scan that is too old.
import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import { number, t } from '../words';
import { use_store } from './store';

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

export function Fresh({ scan }: { scan: string }): JSX.Element | null {
  const held = use_store().state?.held ?? null;
  const left = use_fresh();
  if (held?.scan !== scan || held.waits_for !== 'word') return null;
  if (left !== null && left > 0) return <p class="quiet">{t('fresh_left', { seconds: number(left, 0) })}</p>;
  return <p class="notice look">{left === null ? t('fresh_unseen') : t('fresh_over')}</p>;
}
