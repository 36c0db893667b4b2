// SPDX-License-Identifier: MIT
// Mending a line: another candidate, a stretch led through points, a stretch cut, back to an older version.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { Scan } from 'openapi';
import type { Hand, ViewData, WeakStretch } from '../viewer/view_data';
import { amount, number, read_number, read_numbers, t, t_or } from '../words';
import { call } from './api';
import { Table } from './parts';
import { act, holds_control, may, time_words, use_store } from './store';

interface Step {
  step: 'candidate' | 'through' | 'cut' | 'back_to';
  candidate?: number;
  from_mm?: number;
  to_mm?: number;
  points?: number[][];
  line_version?: number;
}

export interface CandidateStep {
  step: 'candidate';
  candidate: number;
  from_mm?: number;
  to_mm?: number;
}

/// A candidate over a stretch; more than half of the line is no stretch: it is taken all round.
export function taken(stretch: WeakStretch, candidate: number, length_mm: number): CandidateStep {
  return {
    step: 'candidate',
    candidate,
    ...(stretch.to_mm !== undefined && stretch.length_mm < length_mm / 2
      ? { from_mm: stretch.from_mm, to_mm: stretch.to_mm }
      : {}),
  };
}

/// "x, y, z; x, y, z" in the base frame; null where it is none.
function read_points(text: string): number[][] | null {
  const points = text
    .split(/[;\n]/)
    .map((part) => part.trim())
    .filter((part) => part !== '')
    .map(read_numbers);
  return points.length > 0 && points.every((p) => p.length === 3 && p.every(Number.isFinite)) ? points : null;
}

/// The stretches that a person must settle, each with the ways that the scan offers there.
function Open(props: {
  stretches: WeakStretch[];
  length_mm: number;
  enabled: boolean;
  add: (step: Step) => void;
}): JSX.Element {
  return (
    <Table label={t('mend_open')} heads={[t('mend_open'), t('length'), t('reason'), '']}>
      {props.stretches.map((stretch) => (
        <tr key={stretch.from_mm}>
          <th scope="row">{stretch.place}</th>
          <td>{amount(stretch.length_mm, 'mm', 0)}</td>
          <td>{t_or(`reason_${stretch.reason_code}`, stretch.reason_code ?? '')}</td>
          <td>
            <div class="tools">
              <button
                type="button"
                disabled={!props.enabled}
                onClick={() => props.add(taken(stretch, 1, props.length_mm))}
              >
                {t('mend_as_found')}
              </button>
              {(stretch.alternatives ?? []).map((other) => (
                <button
                  type="button"
                  key={other.candidate}
                  disabled={!props.enabled}
                  onClick={() => props.add(taken(stretch, other.candidate, props.length_mm))}
                >
                  {t('mend_alternative', { which: other.candidate, off: number(other.off_mm, 1) })}
                </button>
              ))}
            </div>
          </td>
        </tr>
      ))}
    </Table>
  );
}

/// `hand`: the place chosen in the viewer, moved in its section.
export function Mend({
  scan,
  data,
  hand,
}: {
  scan: Scan;
  data: ViewData;
  hand: Hand | null;
}): JSX.Element | null {
  use_store();
  const [steps, set_steps] = useState<Step[]>([]);
  const [undone, set_undone] = useState<Step[]>([]);
  const [from, set_from] = useState('');
  const [to, set_to] = useState('');
  const [points, set_points] = useState('');
  const [why, set_why] = useState('');
  const candidates = data.report.candidates ?? [];
  const open = (data.report.weak_stretches ?? []).filter((stretch) => stretch.reason_code);
  if (!may('operator')) return null;
  const enabled = holds_control();
  const add = (step: Step) => {
    set_steps([...steps, step]);
    set_undone([]);
  };
  const stretch = { from_mm: read_number(from), to_mm: read_number(to) };
  const is_stretch = Number.isFinite(stretch.from_mm) && Number.isFinite(stretch.to_mm);
  const through = read_points(points);
  const range = (step: Step) =>
    step.from_mm === undefined ? '' : ` ${number(step.from_mm, 1)} … ${number(step.to_mm, 1)} mm`;
  const say = (step: Step) =>
    step.step === 'candidate'
      ? t('mend_candidate', { which: step.candidate ?? 0 }) + range(step)
      : step.step === 'back_to'
        ? t('mend_back', { version: step.line_version ?? 0 })
        : t(step.step === 'cut' ? 'mend_cut' : 'mend_through') + range(step);
  return (
    <details class="card">
      <summary>{t('mend')}</summary>
      <p>{t('mend_words')}</p>
      {!enabled && <p class="quiet">{t('needs_control')}</p>}
      {open.length > 0 && (
        <Open stretches={open} length_mm={Number(data.report.length_mm ?? 0)} enabled={enabled} add={add} />
      )}
      {candidates.length > 1 && (
        <Table
          label={t('candidates')}
          heads={[t('candidates'), t('colour_confidence'), t('length'), t('height'), '']}
        >
          {candidates.map((candidate, i) => (
            <tr key={`${candidate.length_mm}`}>
              <th scope="row">{i + 1}</th>
              <td>{number(candidate.confidence, 2)}</td>
              <td>{amount(candidate.length_mm, 'mm', 1)}</td>
              <td>{amount(candidate.mean_height_mm, 'mm', 1)}</td>
              <td>
                <button
                  type="button"
                  disabled={!enabled}
                  onClick={() => add({ step: 'candidate', candidate: i + 1 })}
                >
                  {t('take_candidate', { which: i + 1 })}
                </button>
              </td>
            </tr>
          ))}
        </Table>
      )}
      <fieldset disabled={!enabled}>
        <legend>{t('mend_stretch')}</legend>
        {hand && (
          <div class="tools">
            <button type="button" onClick={() => set_from(hand.at_mm.toFixed(1))}>
              {t('mend_a', { at: number(hand.at_mm, 1) })}
            </button>
            <button type="button" onClick={() => set_to(hand.at_mm.toFixed(1))}>
              {t('mend_b', { at: number(hand.at_mm, 1) })}
            </button>
            <button
              type="button"
              onClick={() =>
                set_points(
                  `${points ? `${points.replace(/;?\s*$/, '')}; ` : ''}${hand.base.map((v) => v.toFixed(2)).join(', ')}`,
                )
              }
            >
              {t('mend_point', { place: hand.base.map((v) => number(v, 1)).join(' / ') })}
            </button>
          </div>
        )}
        <label>
          A [mm]{' '}
          <input inputMode="decimal" value={from} onInput={(e) => set_from(e.currentTarget.value)} size={8} />
        </label>{' '}
        <label>
          B [mm]{' '}
          <input inputMode="decimal" value={to} onInput={(e) => set_to(e.currentTarget.value)} size={8} />
        </label>
        <label class="wide">
          {t('mend_points')}{' '}
          <textarea rows={2} value={points} onInput={(e) => set_points(e.currentTarget.value)} />
        </label>
        <div class="tools">
          <button
            type="button"
            disabled={!is_stretch || !through}
            onClick={() => through && add({ step: 'through', ...stretch, points: through })}
          >
            {t('mend_through')}
          </button>
          <button type="button" disabled={!is_stretch} onClick={() => add({ step: 'cut', ...stretch })}>
            {t('mend_cut')}
          </button>
        </div>
      </fieldset>
      {(scan.versions ?? []).length > 1 && (
        <Table label={t('line_versions')} heads={[t('line_versions'), t('time'), t('who'), t('why'), '']}>
          {scan.versions!.map((version) => (
            <tr key={version.version}>
              <th scope="row">{version.version}</th>
              <td>{time_words(version.time)}</td>
              <td>{version.who}</td>
              <td>{version.why ?? ''}</td>
              <td>
                <button
                  type="button"
                  disabled={!enabled || version.version === scan.line_version}
                  onClick={() => add({ step: 'back_to', line_version: version.version })}
                >
                  {t('mend_back', { version: version.version })}
                </button>
              </td>
            </tr>
          ))}
        </Table>
      )}
      <ol>
        {steps.map((step, i) => (
          <li key={`${i} ${step.step}`}>{say(step)}</li>
        ))}
      </ol>
      <form
        class="tools"
        onSubmit={(event) => {
          event.preventDefault();
          void act(t('done_mend'), () =>
            call('POST', `/scans/${scan.id}/mend`, { line_version: scan.line_version ?? 0, steps, why }),
          ).then((done) => done && set_steps([]));
        }}
      >
        <button
          type="button"
          disabled={!enabled || steps.length === 0}
          onClick={() => {
            set_undone([...undone, steps[steps.length - 1]!]);
            set_steps(steps.slice(0, -1));
          }}
        >
          {t('undo')}
        </button>
        <button
          type="button"
          disabled={!enabled || undone.length === 0}
          onClick={() => {
            set_steps([...steps, undone[undone.length - 1]!]);
            set_undone(undone.slice(0, -1));
          }}
        >
          {t('redo')}
        </button>
        <label>
          {t('why')}{' '}
          <input
            value={why}
            required
            disabled={!enabled}
            maxLength={500}
            onInput={(e) => set_why(e.currentTarget.value)}
          />
        </label>
        <button type="submit" class="go" disabled={!enabled || steps.length === 0}>
          {t('mend_save')}
        </button>
      </form>
    </details>
  );
}
