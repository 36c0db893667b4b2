// SPDX-License-Identifier: MIT
// The sensor records: a person asks it to keep a scan, and sees what it kept or why not.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import { t } from '../words';
import { Refused, call } from './api';
import { act, holds_control, may, use_store, words_of } from './store';

export function SensorKeep({ scanning }: { scanning: boolean }): JSX.Element {
  use_store();
  const [busy, set_busy] = useState(false);
  const [told, set_told] = useState('');
  const [refused, set_refused] = useState('');
  const operator = may('operator');
  const free = operator && holds_control() && !busy;
  const keep = async (which: 'last' | 'next') => {
    set_busy(true);
    set_told('');
    set_refused('');
    await act(t('keep_done'), async () => {
      try {
        set_told((await call<{ words: string }>('POST', '/sensors/keep', { which })).words);
      } catch (error) {
        set_refused(error instanceof Refused && error.code === 'refused' ? error.message : words_of(error));
        throw error;
      }
    });
    set_busy(false);
  };
  return (
    <section>
      <h2>{t('keep_heading')}</h2>
      <p>{t('keep_how')}</p>
      {!operator && <p class="quiet">{t('needs_operator')}</p>}
      {operator && !holds_control() && <p class="quiet">{t('keep_control')}</p>}
      <p>
        <button type="button" disabled={!free} onClick={() => void keep('last')}>
          {t('keep_last')}
        </button>{' '}
        <button type="button" disabled={!free} onClick={() => void keep('next')}>
          {t(scanning ? 'keep_this' : 'keep_next')}
        </button>
      </p>
      {told && <p class="notice">{told}</p>}
      {refused && (
        <p class="notice refused" role="alert">
          ✖ {t('keep_not')} {refused}
        </p>
      )}
    </section>
  );
}
