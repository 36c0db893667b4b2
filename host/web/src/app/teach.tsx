// SPDX-License-Identifier: MIT
// From one scan to a running model: scan, look, process, dry run, first run in the air, save, go.
import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import type { File, Scan, ScanRow } from 'openapi';
import { amount, t, t_or } from '../words';
import { call } from './api';
import { Fresh, use_fresh, use_sendable } from './fresh';
import { Failure, Figures, Step, Verdict } from './parts';
import { ScanView } from './scans';
import { act, holds_control, may, use_reading, use_store } from './store';
import { AirStep, GoStep, ProcessStep, SaveStep } from './teach_steps';

function has_line(scan: ScanRow): boolean {
  return scan.verdict === 'ok' || scan.verdict === 'amber';
}

/// Asks for a scan that waits for a person whatever its process says: what is taught is never sent by itself.
function scan_the_sample(again: boolean): Promise<boolean> {
  return again
    ? act(t('done_rescan'), () => call('POST', '/commands/rescan', { why: t('teach_why'), hold: true }))
    : act(t('done_start'), () => call('POST', '/commands/start', { hold: true }));
}

export function Teach(): JSX.Element {
  const { state } = use_store();
  const { value } = use_reading<{ scans: ScanRow[] }>('/scans?limit=20');
  const enabled = may('engineer') && holds_control();
  const in_work = ['scanning', 'working', 'following'].includes(state?.phase ?? '');
  const held = (value?.scans ?? []).find((scan) => has_line(scan) && scan.id === state?.held?.scan);
  // What was taught stays on the screen until the next scan is held.
  const [shown, set_shown] = useState('');
  useEffect(() => {
    if (held) set_shown(held.id);
  }, [held?.id]);
  const id = held?.id ?? shown;
  return (
    <>
      <h1>{t('nav_teach')}</h1>
      <p>{t('teach_words')}</p>
      {!may('engineer') ? (
        <p class="quiet">{t('needs_engineer')}</p>
      ) : (
        !enabled && <p class="quiet">{t('needs_control')}</p>
      )}
      <Step number={1} name={t('teach_scan')} done={id !== ''}>
        <p>{id ? t('teach_scan_done', { scan: id }) : t('teach_scan_words')}</p>
        {id !== '' && <Fresh scan={id} />}
        <button
          type="button"
          class={id ? '' : 'go'}
          disabled={!enabled || in_work}
          onClick={() => void scan_the_sample(!!state?.held)}
        >
          {state?.held ? t('rescan') : t('teach_start')}
        </button>
        {in_work && <p class="quiet">{state?.now}</p>}
      </Step>
      {id !== '' && <Taught key={id} id={id} enabled={enabled} />}
    </>
  );
}

interface OfTaught {
  id: string;
  enabled: boolean;
}

function Taught({ id, enabled }: OfTaught): JSX.Element {
  const { state } = use_store();
  const fresh = (use_fresh() ?? 0) > 0;
  const sendable = use_sendable(id);
  const { value: scan, error } = use_reading<Scan>(`/scans/${id}`);
  const { value: listed } = use_reading<{ files: File[] }>(`/scans/${id}/files`);
  const [model, set_model] = useState('');
  const [closer, set_closer] = useState(false);
  if (!scan) return <Failure text={error} />;
  const files = listed?.files ?? [];
  const waits = state?.held?.scan === id && state.phase === 'deciding';
  const dry_run = files.find((file) => file.path === 'path/tracking.html') ?? null;
  const common = { scan, enabled: enabled && waits };
  // Of the service, so that another tab, or this one after a reload, sees the same.
  const chosen = state?.held?.scan === id ? !!state.process_by : true;
  return (
    <>
      <Step number={2} name={t('teach_look')} done={has_line(scan) && (scan.weak_stretches ?? 0) === 0}>
        <p>
          <Verdict scan={scan} /> {scan.reason ?? ''} {scan.next_step ?? ''}
        </p>
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
      <ProcessStep
        {...common}
        taken={chosen ? (scan.process_file ?? '') : ''}
        chosen={chosen}
        dry_run={dry_run}
      />
      <AirStep {...common} ready={fresh && dry_run !== null} />
      <SaveStep {...common} saved={model} save={set_model} enabled={enabled} />
      <GoStep {...common} model={model} fresh={sendable} />
    </>
  );
}
