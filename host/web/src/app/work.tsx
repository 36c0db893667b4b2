// SPDX-License-Identifier: MIT
// The operator's screen: one shoe with its line, the verdict to be read from 3 m, what to do, and the next shoe.
import type { ComponentChildren, JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { Scan, ScanRow, State } from 'openapi';
import { failed_gates, gate_words } from '../viewer/gates';
import type { Scene } from '../viewer/scene';
import type { Gate } from '../viewer/view_data';
import { t, t_or } from '../words';
import { DayCounts } from './day_counts';
import { Fresh } from './fresh';
import { Lamps } from './lamps';
import { Decide } from './live';
import { Failure, shoe_words, verdict_signs } from './parts';
import { ShoePicture, use_shoe } from './scanned_shoe';
import { Settle, open_stretches } from './settle';
import { StartForm } from './start_form';
import { holds_control, may, use_reading, use_store } from './store';

/// How wide a word is, in widths of a Latin letter: a Chinese sign is two.
function letters_of(word: string): number {
  return [...word].reduce((sum, sign) => sum + (sign > '\u2e80' ? 2 : 1), 0);
}

const moods: Record<string, string> = { ok: 'good', amber: 'look', review: 'look', working: '' };

/// What the cell is about where no verdict is there yet, or the arm works; else the verdict of the shoe.
function big_word(state: State, scan: ScanRow | null): { sign: string; word: string; mood: string } {
  const about = state.phase;
  const without = !scan || scan.verdict === 'working';
  if (about === 'scanning' || about === 'following' || (without && about !== 'deciding'))
    return { sign: about === 'fault' ? '!' : '…', word: t(`phase_${about}`), mood: '' };
  if (!scan) return { sign: '', word: t('work_none'), mood: '' };
  return {
    sign: verdict_signs[scan.verdict] ?? '',
    word: t_or(`verdict_${scan.verdict}`, scan.verdict),
    mood: moods[scan.verdict] ?? 'refused',
  };
}

function Letters({ sign, word }: { sign: string; word: string }): JSX.Element {
  return (
    <p class="letters" style={{ '--letters': String(2 + letters_of(word)) }}>
      <span aria-hidden="true">{sign}</span> {word}
    </p>
  );
}

/// Of the scan's report, which may be of an older version.
function gates_of(scan: Scan | null): Gate[] {
  const gates = (scan?.report as { gates?: unknown } | null)?.gates;
  return Array.isArray(gates) && scan?.verdict === 'refused' ? (gates as Gate[]) : [];
}

/// Why it is so and what to do, as far as the service says.
function Reason({ scan, gates }: { scan: ScanRow; gates: Gate[] }): ComponentChildren {
  if (!scan.reason && !scan.reason_code && !scan.why) return null;
  const code = scan.reason_code ? t_or(`reason_${scan.reason_code}`, '') : '';
  return (
    <p class="reason">
      {code && <strong>{code}. </strong>}
      {scan.why ?? scan.reason ?? ''}{' '}
      {failed_gates(gates, scan.reason_code)
        .slice(0, 1)
        .map((gate) => (
          <em key={gate.measure}>{gate_words(gate)} </em>
        ))}
      {scan.next_step && (
        <>
          <strong>{t('next_step')}</strong> {scan.next_step}
        </>
      )}
    </p>
  );
}

export function Work(): JSX.Element {
  const { state, host } = use_store();
  const newest = use_reading<{ scans: ScanRow[] }>('/scans?limit=1').value?.scans[0] ?? null;
  const id = state?.held?.scan ?? newest?.id ?? null;
  const read = use_reading<Scan>(id === null ? null : `/scans/${id}`).value;
  const scan: ScanRow | null = read ?? (newest?.id === id ? newest : null);
  const scanning = state?.phase === 'scanning';
  const shoe = use_shoe(scanning ? null : scan);
  const [scene, set_scene] = useState<Scene | null>(null);
  if (!state) return <Failure text={host ? t('waits_for_state') : t('code_host_away')} />;
  const big = big_word(state, scan);
  const enabled = may('operator') && holds_control();
  const settle = scan?.verdict === 'review' && scan.decision === 'held';
  return (
    <div class="work">
      <h1 class="unseen">{t('nav_work')}</h1>
      <section class={`said ${big.mood}`} aria-live="polite" aria-label={t('verdict')}>
        <p class="about">
          {scan && <a href={`#/scans/${scan.id}`}>{scan.id}</a>}{' '}
          {scan && shoe_words(scan) !== '–' && <span>{shoe_words(scan)}</span>} {scan?.model ?? ''}{' '}
          {scan && scan.decision !== 'open' && <em>{t_or(`decision_${scan.decision}`, scan.decision)}</em>}
          {state.simulated && <span class="simulated">{t('simulated_short')}</span>}
        </p>
        <Letters sign={big.sign} word={big.word} />
        {state.progress !== null && state.phase !== 'deciding' && (
          <progress value={state.progress} max={1} aria-label={t('progress')} />
        )}
      </section>
      <ShoePicture scan={scan} shoe={shoe} scanning={scanning} begun={set_scene} />
      <div class="side">
        {scan && <Reason scan={scan} gates={gates_of(read)} />}
        {scan && (
          <div class="decide">
            {settle && shoe.view && open_stretches(shoe.view).length > 0 && (
              <Settle
                key={`${scan.id} ${scan.line_version ?? 0}`}
                scan={scan}
                view={shoe.view}
                scene={scene}
                enabled={enabled}
              />
            )}
            <Decide scan={scan} />
            <Fresh scan={scan.id} />
          </div>
        )}
        <section class="next-shoe" aria-label={t('next_shoe')}>
          <h2>{t('next_shoe')}</h2>
          <StartForm enabled={enabled} short />
        </section>
        <DayCounts />
        <Lamps lamps={state.lamps} />
      </div>
    </div>
  );
}
