// SPDX-License-Identifier: MIT
// What the service says of a process before it is saved: its values, and a path along a kept line.
import type { JSX } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import type { Fault, TriedProcess } from 'openapi';
import { number, t } from '../words';
import { Refused, call } from './api';
import { newest_only } from './newest_only';
import { words_of } from './store';

/// So long nothing was typed before the service is asked.
const typing_pause_ms = 600;

export interface Tried {
  state: 'waits' | 'told' | 'refused';
  told?: TriedProcess;
  words?: string;
}

/// What the service says of a process as it is typed; null: there is none to ask about.
export function use_try(process: unknown, set_faults: (faults: Fault[]) => void): Tried | null {
  const [tried, set_tried] = useState<Tried | null>(null);
  const first = useRef(true);
  const asker = useRef<ReturnType<typeof newest_only<unknown>> | null>(null);
  useEffect(() => {
    const made = newest_only<unknown>(async (asked, is_newest) => {
      try {
        const told = await call<TriedProcess>('POST', '/processes/check', { process: asked });
        if (!is_newest()) return;
        set_faults([]);
        set_tried({ state: 'told', told });
      } catch (refused) {
        if (!is_newest()) return;
        set_faults(refused instanceof Refused ? refused.faults : []);
        set_tried({ state: 'refused', words: words_of(refused) });
      }
    });
    asker.current = made;
    return () => made.close();
  }, []);
  useEffect(() => {
    if (process === null) return;
    // What was said is about older values.
    asker.current?.forget();
    set_tried({ state: 'waits' });
    const timer = setTimeout(() => asker.current?.ask(process), first.current ? 0 : typing_pause_ms);
    first.current = false;
    return () => clearTimeout(timer);
  }, [process]);
  return tried;
}

export function TriedWords({ tried }: { tried: Tried | null }): JSX.Element {
  const told = tried?.told;
  const look = !told ? '' : told.fits ? 'good' : told.fits === false ? 'refused' : 'look';
  const words = !tried
    ? ''
    : tried.state === 'waits'
      ? t('try_waits')
      : !told
        ? `✖ ${tried.words ?? ''}`
        : told.scan === null
          ? t('try_none')
          : told.fits
            ? `✔ ${t('try_fits', { scan: told.scan, seconds: number(told.duration_s, 1) })}`
            : `✖ ${t('try_refused', { scan: told.scan, reason: told.reason ?? '' })} ${told.next_step ?? ''}`;
  return (
    <p role="status" class={tried ? `notice ${look}` : ''}>
      {words}
    </p>
  );
}
