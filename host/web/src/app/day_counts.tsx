// SPDX-License-Identifier: MIT
// How many shoes the factory's day has had, by verdict.
import type { JSX } from 'preact';
import type { State, Trends } from 'openapi';
import { t } from '../words';
import { query } from './api';
import { verdict_signs } from './parts';
import { use_reading, use_store } from './store';

/// The factory's day of a moment: that of its zone, from the begin of its first shift on.
export function factory_day(day: State['day'], now: Date): string {
  const [hours, minutes] = (day?.begin ?? '00:00').split(':').map(Number);
  const moved = new Date(now.getTime() - 60_000 * (60 * (hours ?? 0) + (minutes ?? 0)));
  const style = { year: 'numeric', month: '2-digit', day: '2-digit' } as const;
  try {
    // Canada writes a date as the API does.
    return new Intl.DateTimeFormat('en-CA', { ...style, timeZone: day?.zone }).format(moved);
  } catch {
    return new Intl.DateTimeFormat('en-CA', style).format(moved);
  }
}

const counted = ['ok', 'amber', 'review', 'refused', 'failed'] as const;

export function DayCounts(): JSX.Element | null {
  const { state } = use_store();
  const from = factory_day(state?.day, new Date());
  const { value } = use_reading<Trends>(`/history/trends${query({ from, bucket: 'day' })}`);
  if (!value) return null;
  const sum = (name: (typeof counted)[number] | 'scans') =>
    value.buckets.reduce((total, bucket) => total + bucket[name], 0);
  return (
    <dl class="counts" aria-label={t('counts_day')}>
      <div>
        <dt>{t('counts_day')}</dt>
        <dd>{sum('scans')}</dd>
      </div>
      {counted.map((name) => (
        <div key={name} class={name}>
          <dt>
            <span aria-hidden="true">{verdict_signs[name]}</span> {t(`verdict_${name}`)}
          </dt>
          <dd>{sum(name)}</dd>
        </div>
      ))}
    </dl>
  );
}
