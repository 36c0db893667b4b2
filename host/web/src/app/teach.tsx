// SPDX-License-Identifier: MIT
// From one scan to a running model: scan, look, process, dry run, first run in the air, save, go.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { File, Scan, Teaching } from 'openapi';
import { amount, t, t_or } from '../words';
import { call } from './api';
import { Fresh, use_fresh, use_sendable } from './fresh';
import { Failure, Figures, Step, Verdict } from './parts';
import { ScanView } from './scans';
import { act, holds_control, may, use_reading, use_store } from './store';
import { AirStep, GoStep, ProcessStep, SaveStep } from './teach_steps';
import { Open, TeachingWords, is_done, use_teaching } from './teaching';

/// Asks for a scan that waits for a person whatever its process says: what is taught is never sent by itself.
function scan_the_sample(again: boolean): Promise<boolean> {
  return again
    ? act(t('done_rescan'), () => call('POST', '/commands/rescan', { why: t('teach_why'), hold: true }))
    : act(t('done_start'), () => call('POST', '/commands/start', { hold: true }));
}

export function Teach(): JSX.Element {
  const { state } = use_store();
  const teaching = use_teaching();
  const enabled = may('engineer') && holds_control();
  const in_work = ['scanning', 'working', 'following'].includes(state?.phase ?? '');
  const held = state?.held?.scan ?? '';
  const id = teaching?.scan ?? '';
  // One that is open goes on with the next scan of the shoe.
  const goes_on = held !== '' || (teaching !== null && !teaching.ended);
  return (
    <>
      <h1>{t('nav_teach')}</h1>
      <p>{t('teach_words')}</p>
      {!may('engineer') ? (
        <p class="quiet">{t('needs_engineer')}</p>
      ) : (
        !enabled && <p class="quiet">{t('needs_control')}</p>
      )}
      {teaching && <TeachingWords teaching={teaching} />}
      <Step number={1} name={t('teach_scan')} done={id !== ''}>
        <p>{id ? t('teach_scan_done', { scan: id }) : t('teach_scan_words')}</p>
        {held !== '' && held !== id && <p class="notice look">{t('teach_untaught', { scan: held })}</p>}
        {id !== '' && <Fresh scan={id} />}
        <button
          type="button"
          class={id ? '' : 'go'}
          disabled={!enabled || in_work}
          onClick={() => void scan_the_sample(goes_on)}
        >
          {held !== '' || (goes_on && id !== '') ? t('rescan') : t('teach_start')}
        </button>
        {in_work && <p class="quiet">{state?.now}</p>}
      </Step>
      {teaching && id !== '' && <Taught key={id} id={id} teaching={teaching} enabled={enabled} />}
    </>
  );
}

interface OfTaught {
  id: string;
  teaching: Teaching;
  enabled: boolean;
}

function Taught({ id, teaching, enabled }: OfTaught): JSX.Element {
  const { state } = use_store();
  const fresh = (use_fresh() ?? 0) > 0;
  const sendable = use_sendable(id);
  const { value: scan, error } = use_reading<Scan>(`/scans/${id}`);
  const { value: listed } = use_reading<{ files: File[] }>(`/scans/${id}/files`);
  const [closer, set_closer] = useState(false);
  if (!scan) return <Failure text={error} />;
  const files = listed?.files ?? [];
  const waits = state?.held?.scan === id && state.phase === 'deciding';
  const dry_run = files.find((file) => file.path === 'path/tracking.html') ?? null;
  const common = { scan, teaching, enabled: enabled && waits };
  return (
    <>
      <Step number={2} name={t('teach_look')} done={is_done(teaching, 'line')}>
        <p>
          <Verdict scan={scan} /> {scan.reason ?? ''} {scan.next_step ?? ''}
        </p>
        <Open teaching={teaching} step="line" />
        <Figures
          rows={[
            [t('length'), amount(scan.length_mm, 'mm', 1)],
            [t('u95_line'), amount(scan.u95_mm, 'mm', 2)],
            [t('weak_stretches'), scan.weak_stretches ?? '–'],
            [t('decision'), t_or(`decision_${scan.decision}`, scan.decision)],
          ]}
        />
        <details onToggle={(event) => set_closer(event.currentTarget.open)}>
          <summary>{t('teach_look_closer')}</summary>
          {closer && <ScanView scan={scan} files={files} />}
        </details>
      </Step>
      <ProcessStep {...common} dry_run={dry_run} />
      <AirStep {...common} ready={fresh && dry_run !== null} />
      <SaveStep {...common} enabled={enabled} />
      <GoStep {...common} fresh={sendable} />
    </>
  );
}
