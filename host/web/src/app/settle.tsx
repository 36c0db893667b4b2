// SPDX-License-Identifier: MIT
// The stretches of a line that a person must settle, one after the other: each with the ways that it may take, drawn
// on the shoe and taken by a tap.
import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import type { ScanRow } from 'openapi';
import type { Scene } from '../viewer/scene';
import { index_at } from '../viewer/stage';
import { type View, type WeakStretch, in_shoe } from '../viewer/view_data';
import { amount, number, t, t_or } from '../words';
import { call } from './api';
import { type CandidateStep, taken } from './mend';
import { act } from './store';

/// Those of a line for review that are open.
export function open_stretches(view: View | null): WeakStretch[] {
  return (view?.data.report.weak_stretches ?? []).filter((stretch) => stretch.reason_code);
}

export function Settle(props: {
  scan: ScanRow;
  view: View;
  scene: Scene | null;
  enabled: boolean;
}): JSX.Element | null {
  const { scan, view, scene, enabled } = props;
  const stretches = open_stretches(view);
  const [steps, set_steps] = useState<CandidateStep[]>([]);
  const stretch = stretches[steps.length];
  useEffect(() => {
    scene?.preview([]);
    if (!stretch || !scene) return;
    const index = index_at(view, stretch.from_mm + stretch.length_mm / 2);
    scene.choose(index, 6);
    scene.look_at(index);
  }, [scene, steps.length]);
  const take = (candidate: number) => {
    if (stretch) set_steps([...steps, taken(stretch, candidate, view.length_mm)]);
  };
  const show = (points: number[][]) => scene?.preview(points.map((p) => in_shoe(view, p)));
  const save = () =>
    act(t('done_mend'), () =>
      call('POST', `/scans/${scan.id}/mend`, {
        line_version: scan.line_version ?? 0,
        steps,
        why: t('settle_why'),
      }),
    );
  return (
    <section class="settle" aria-label={t('settle')} aria-live="polite">
      {stretch ? (
        <>
          <p>
            <strong>
              {t('settle_which', {
                which: steps.length + 1,
                count: stretches.length,
                place: stretch.place,
              })}
            </strong>
            , {amount(stretch.length_mm, 'mm', 0)}.{' '}
            {t_or(`reason_${stretch.reason_code}`, stretch.reason_code ?? '')}
          </p>
          <div class="tools">
            <button type="button" disabled={!enabled} onClick={() => take(1)}>
              {t('mend_as_found')}
            </button>
            {(stretch.alternatives ?? []).map((other) => (
              <button
                type="button"
                key={other.candidate}
                disabled={!enabled}
                onPointerEnter={() => show(other.points)}
                onFocus={() => show(other.points)}
                onClick={() => take(other.candidate)}
              >
                {t('mend_alternative', { which: other.candidate, off: number(other.off_mm, 1) })}
              </button>
            ))}
          </div>
        </>
      ) : (
        <p>{t('settle_all')}</p>
      )}
      <div class="tools">
        {steps.length > 0 && (
          <button type="button" onClick={() => set_steps(steps.slice(0, -1))}>
            {t('undo')}
          </button>
        )}
        {!stretch && (
          <button type="button" class="go" disabled={!enabled} onClick={() => void save()}>
            {t('mend_save')}
          </button>
        )}
        <a class="button" href={`#/scans/${scan.id}`}>
          {t('mend')}
        </a>
      </div>
    </section>
  );
}
