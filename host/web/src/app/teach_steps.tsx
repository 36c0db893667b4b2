// SPDX-License-Identifier: MIT
// The steps of teaching behind the scan: process with its dry run, run in the air, model, go.
import type { JSX } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import type { File, Model, ProcessRow, Scan, Teaching, TriedProcess } from 'openapi';
import { number, t, t_or } from '../words';
import { call, file_address } from './api';
import { NotSendable, use_shown_version } from './fresh';
import { ModelForm } from './model_form';
import { type NewestOnly, newest_only } from './newest_only';
import { Step, Verdict } from './parts';
import { TriedWords, type Tried } from './process_check';
import { act, offered, time_words, use_reading, words_of } from './store';
import { LookAgain, Open, is_done, see_dry_run } from './teaching';

interface OfScan {
  scan: Scan;
  teaching: Teaching;
  enabled: boolean;
}

/// What the service says of a process along this scan's line; null: none is chosen.
function use_fit(scan: string, name: string): Tried | null {
  const [tried, set_tried] = useState<Tried | null>(null);
  const asker = useRef<NewestOnly<{ scan: string; name: string }> | null>(null);
  useEffect(() => {
    const made = newest_only<{ scan: string; name: string }>(async (asked, is_newest) => {
      try {
        const { process } = await call<{ process: unknown }>('GET', `/processes/${asked.name}`);
        if (!is_newest()) return;
        const told = await call<TriedProcess>('POST', '/processes/check', {
          process,
          scan: asked.scan,
        });
        if (is_newest()) set_tried({ state: 'told', told });
      } catch (refused) {
        if (is_newest()) set_tried({ state: 'refused', words: words_of(refused) });
      }
    });
    asker.current = made;
    return () => made.close();
  }, []);
  useEffect(() => {
    asker.current?.forget();
    if (name === '') return set_tried(null);
    set_tried({ state: 'waits' });
    asker.current?.ask({ scan, name });
  }, [scan, name]);
  return tried;
}

export function ProcessStep(props: OfScan & { dry_run: File | null }): JSX.Element {
  const { scan, teaching } = props;
  const taken = teaching.process_by === null ? '' : (scan.process_file ?? '');
  const { value } = use_reading<{ processes: ProcessRow[] }>('/processes');
  // What the service plans with, until somebody looks for another one here.
  const [chosen, set_chosen] = useState<string | null>(null);
  useEffect(() => set_chosen(null), [taken]);
  const name = chosen ?? taken;
  const names = new Set([
    ...(taken === '' ? [] : [taken]),
    ...(value?.processes ?? []).map((one) => one.name),
  ]);
  const tried = use_fit(scan.id, props.enabled && name !== taken ? name : '');
  const take = () =>
    act(t('done_choose_process', { name }), () =>
      call('POST', `/scans/${scan.id}/process`, { process: name }),
    );
  return (
    <Step
      number={3}
      name={t('teach_process')}
      done={is_done(teaching, 'process') && is_done(teaching, 'dry_run')}
    >
      <p>{t('teach_process_words')}</p>
      {scan.process && <p class="quiet">{t('teach_planned_with', { process: scan.process })}</p>}
      <Open teaching={teaching} step="process" />
      <div class="tools">
        <label>
          {t('process')}{' '}
          <select value={name} onChange={(event) => set_chosen(event.currentTarget.value)}>
            <option value="">{t('choose')}</option>
            {[...names].map((one) => (
              <option key={one} value={one}>
                {one}
              </option>
            ))}
          </select>
        </label>
        <button
          type="button"
          class="go"
          disabled={!props.enabled || !offered('process') || name === ''}
          onClick={() => void take()}
        >
          {t('teach_take_process')}
        </button>
        <a href="#/processes">{t('teach_edit_process')}</a>
        <a href="#/devices">{t('teach_mounted')}</a>
      </div>
      <TriedWords tried={tried} />
      {props.dry_run ? (
        <>
          <h3>{t('teach_dry_run')}</h3>
          <iframe
            key={`${props.dry_run.time} ${props.dry_run.bytes}`}
            class="dry-run"
            title={t('teach_dry_run')}
            src={file_address(scan.id, 'path/tracking.html')}
          />
          <Open teaching={teaching} step="dry_run" />
          {teaching.dry_run && (
            <p class="quiet">
              {t('teach_seen_by', { who: teaching.dry_run.who, time: time_words(teaching.dry_run.time) })}
            </p>
          )}
          {!is_done(teaching, 'dry_run') && (
            <button
              type="button"
              disabled={!props.enabled}
              onClick={() => void act(t('done_seen'), () => see_dry_run(teaching))}
            >
              {t('teach_seen')}
            </button>
          )}
        </>
      ) : (
        <p class="quiet">{t('teach_no_path')}</p>
      )}
    </Step>
  );
}

export function AirStep({ scan, teaching, enabled, ready }: OfScan & { ready: boolean }): JSX.Element {
  const air = scan.air ?? null;
  // Who lets the arm run what is shown above has looked at it.
  const run = async () => {
    if (!is_done(teaching, 'dry_run')) await see_dry_run(teaching);
    await call('POST', `/scans/${scan.id}/air`);
  };
  const look = air?.state === 'followed' ? 'good' : air?.state === 'begun' ? '' : 'refused';
  return (
    <Step number={4} name={t('teach_air')} done={is_done(teaching, 'air')}>
      <p>{t('teach_air_words')}</p>
      <Open teaching={teaching} step="air" />
      <div class="tools">
        <button
          type="button"
          class={is_done(teaching, 'air') ? '' : 'go'}
          disabled={!enabled || !ready || !offered('air')}
          onClick={() => void act(t('done_air'), run)}
        >
          {t('teach_air_go')}
        </button>
        <LookAgain scan={scan.id} enabled={enabled} />
      </div>
      <div role="status">
        {air && (
          <p class={`notice ${look}`}>
            {t_or(`air_${air.state}`, air.state)}
            {air.duration_s ? `, ${number(air.duration_s, 0)} s` : ''}
            {air.reason ? `: ${air.reason}. ${air.next_step ?? ''}` : ''}
          </p>
        )}
      </div>
    </Step>
  );
}

export function SaveStep(props: OfScan): JSX.Element {
  const { teaching } = props;
  const { value } = use_reading<{ models: Model[] }>('/models');
  const [meant, set_meant] = useState(false);
  const not_run = !is_done(teaching, 'air');
  return (
    <Step number={5} name={t('teach_save')} done={is_done(teaching, 'model')}>
      <p>{t('teach_save_words')}</p>
      {props.scan.process && <p class="quiet">{t('teach_planned_with', { process: props.scan.process })}</p>}
      {not_run && (
        <label>
          <input
            type="checkbox"
            checked={meant}
            disabled={!props.enabled}
            onChange={(event) => set_meant(event.currentTarget.checked)}
          />{' '}
          {t('teach_not_run')}
        </label>
      )}
      <ModelForm
        look="tools"
        names={(value?.models ?? []).map((model) => model.name)}
        scan={props.scan.id}
        process=""
        enabled={props.enabled && (!not_run || meant)}
        not_run={not_run && meant}
        saved={teaching.model ?? ''}
      />
    </Step>
  );
}

export function GoStep(props: OfScan & { fresh: boolean }): JSX.Element {
  const { scan, enabled } = props;
  const model = props.teaching.model;
  const shown = use_shown_version(scan.id);
  const at = `/scans/${scan.id}`;
  return (
    <Step number={6} name={t('teach_go')} done={scan.followed === true}>
      <p>{model ? t('teach_go_words', { model }) : t('teach_go_unsaved')}</p>
      <div class="tools">
        <button
          type="button"
          class={props.fresh ? 'go' : ''}
          disabled={!enabled || !props.fresh}
          onClick={() => void act(t('done_accept'), () => call('POST', `${at}/accept`, shown))}
        >
          {t('teach_go_now')}
        </button>
        <button
          type="button"
          class={props.fresh ? '' : 'go'}
          disabled={!enabled || !offered('rescan')}
          onClick={() => void act(t('done_rescan'), () => call('POST', '/commands/rescan', {}))}
        >
          {t('teach_go_again')}
        </button>
      </div>
      <NotSendable scan={scan.id} />
      {scan.decision !== 'held' && (
        <p class="notice">
          <Verdict scan={scan} /> {t_or(`decision_${scan.decision}`, scan.decision)}
          {scan.followed === true ? `, ${t('followed')}` : ''} {scan.reason ?? ''} {scan.next_step ?? ''}
        </p>
      )}
    </Step>
  );
}
