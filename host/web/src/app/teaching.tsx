// SPDX-License-Identifier: MIT
// What is taught, as the service tells it: every browser stands at the same step, also after a reload.
import type { JSX } from 'preact';
import type { ScanRow, TeachStep, Teaching } from 'openapi';
import { t, t_or } from '../words';
import { call } from './api';
import { act, holds_control, may, offered, time_words, use_reading, use_store } from './store';

/// The one that is open, or whose model was saved and whose shoe is still the newest; null: nobody teaches.
export function use_teaching(): Teaching | null {
  const { value } = use_reading<{ teachings: Teaching[] }>('/teachings?limit=1');
  const { value: newest } = use_reading<{ scans: ScanRow[] }>('/scans?limit=1');
  const teaching = value?.teachings[0] ?? null;
  if (!teaching?.ended) return teaching;
  const is_newest = teaching.scan !== null && newest?.scans[0]?.id === teaching.scan;
  return teaching.ended_how === 'saved' && is_newest ? teaching : null;
}

export function is_done(teaching: Teaching, step: TeachStep): boolean {
  return teaching.steps.some((one) => one.step === step && one.state === 'done');
}

/// What was done with another line, process or scan is told wherever it stands; else what is next.
const stale: Record<string, true> = { scanned_again: true, line_changed: true, process_changed: true };

/// Why this step is not done.
export function Open({ teaching, step }: { teaching: Teaching; step: TeachStep }): JSX.Element | null {
  const one = teaching.steps.find((row) => row.step === step);
  if (!one?.why || (one.state !== 'now' && !stale[one.why])) return null;
  return <p class={stale[one.why] ? 'notice look' : 'quiet'}>{t_or(`teach_open_${one.why}`, one.why)}</p>;
}

/// Who teaches, what is next, and how another person goes on with it.
export function TeachingWords({ teaching }: { teaching: Teaching }): JSX.Element {
  const { state } = use_store();
  const mine = holds_control();
  const holder = state?.control.holder ?? null;
  if (teaching.ended)
    return (
      <p class="notice good">
        {t('teach_saved_by', { model: teaching.model ?? '', who: teaching.ended_by ?? '' })}
      </p>
    );
  return (
    <div class="notice" role="status">
      <p>
        {t('teach_who', { who: teaching.begun_by, time: time_words(teaching.begun) })}{' '}
        {teaching.step && t('teach_next', { step: t_or(`teach_step_${teaching.step}`, teaching.step) })}
      </p>
      <div class="tools">
        {!mine && holder === null && may('engineer') && (
          <button
            type="button"
            class="go"
            onClick={() => void act(t('done_control'), () => call('POST', '/control', { action: 'take' }))}
          >
            {t('teach_go_on')}
          </button>
        )}
        {mine && (
          <button
            type="button"
            onClick={() => void act(t('done_give_up'), () => call('DELETE', `/teachings/${teaching.id}`))}
          >
            {t('teach_give_up')}
          </button>
        )}
      </div>
      {!mine && holder !== null && <p class="quiet">{t('teach_held_by', { who: holder })}</p>}
    </div>
  );
}

/// Somebody has looked at the dry run of just this line and process.
export function see_dry_run(teaching: Teaching): Promise<unknown> {
  const { scan, line_version, process_sha256 } = teaching;
  return call('POST', `/teachings/${teaching.id}/dry-run`, {
    scan,
    line_version,
    ...(process_sha256 === null ? {} : { process_sha256 }),
  });
}

/// The sensor looks whether the shoe of a scan that waits still lies where it was scanned.
export function LookAgain({ scan, enabled }: { scan: string; enabled: boolean }): JSX.Element | null {
  const { state } = use_store();
  if (state?.held?.scan !== scan || !offered('look')) return null;
  return (
    <button
      type="button"
      disabled={!enabled}
      onClick={() => void act(t('done_look'), () => call('POST', `/scans/${scan}/look`))}
    >
      {t('look_again')}
    </button>
  );
}
