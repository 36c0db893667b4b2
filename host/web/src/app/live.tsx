// SPDX-License-Identifier: MIT
// What the cell does now: lamps, picture, profile, cloud, and what waits for a person.
import type { JSX } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import type { Model, ScanRow, State } from 'openapi';
import { type Scale, gradient } from '../viewer/colours';
import { amount, language, number, t, t_or } from '../words';
import { call } from './api';
import { Fresh, NotSendable, use_sendable, use_shown_version } from './fresh';
import { LampWords, lamp_signs, lamps_of } from './lamps';
import { watch_live } from './live_data';
import { LiveScene, type LiveColour } from './live_scene';
import { AskWhy, Failure, Figures, Verdict, shoe_words } from './parts';
import { StartForm } from './start_form';
import { act, holds_control, may, offered, use_reading, use_store } from './store';
import { LookAgain } from './teaching';

function draw_profile(canvas: HTMLCanvasElement, xz_mm: Float32Array, flags: Uint8Array): void {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const c = canvas.getContext('2d');
  if (!c || xz_mm.length === 0) return;
  c.scale(ratio, ratio);
  let low_x = Infinity;
  let high_x = -Infinity;
  let low_z = Infinity;
  let high_z = -Infinity;
  for (let i = 0; i + 1 < xz_mm.length; i += 2) {
    if (!Number.isFinite(xz_mm[i]!) || !Number.isFinite(xz_mm[i + 1]!)) continue;
    low_x = Math.min(low_x, xz_mm[i]!);
    high_x = Math.max(high_x, xz_mm[i]!);
    low_z = Math.min(low_z, xz_mm[i + 1]!);
    high_z = Math.max(high_z, xz_mm[i + 1]!);
  }
  const scale = Math.min(
    (width - 20) / Math.max(1, high_x - low_x),
    (height - 34) / Math.max(1, high_z - low_z),
  );
  const style = getComputedStyle(canvas);
  c.fillStyle = style.color;
  for (let i = 0; i + 1 < xz_mm.length; i += 2) {
    const x = width / 2 + (xz_mm[i]! - (low_x + high_x) / 2) * scale;
    const y = height / 2 - 8 - (xz_mm[i + 1]! - (low_z + high_z) / 2) * scale;
    // A flagged point is hollow: it stays out of the cloud.
    if (flags[i / 2]) {
      c.strokeStyle = style.color;
      c.strokeRect(x - 1.5, y - 1.5, 3, 3);
    } else c.fillRect(x - 1, y - 1, 2, 2);
  }
  c.font = '12px system-ui, sans-serif';
  c.fillText(
    `x ${number(low_x, 1)} … ${number(high_x, 1)} mm, z ${number(low_z, 1)} … ${number(high_z, 1)} mm`,
    8,
    height - 8,
  );
}

/// What the colours of the points mean.
function ColourScale({ by, scale }: { by: LiveColour; scale: Scale | null }): JSX.Element | null {
  if (by !== 'time' && !scale) return null;
  const digits = by === 'height' ? 0 : 1;
  const low = scale ? number(scale.low, digits) : t('colour_time_first');
  const high = scale ? `${number(scale.high, digits)} ${scale.unit}` : t('colour_time_last');
  return (
    <span class="colour-scale">
      {low} <span class="gradient" style={{ background: gradient }} aria-hidden="true" /> {high}
      {by === 'curvature' && ` (${t('colour_curvature_words')})`}
      {by === 'uncertainty' && ` (${t('colour_sigma_words')})`}
    </span>
  );
}

function LivePictures(): JSX.Element {
  const picture = useRef<HTMLImageElement>(null);
  const profile = useRef<HTMLCanvasElement>(null);
  const box = useRef<HTMLDivElement>(null);
  const scene = useRef<LiveScene | null>(null);
  const [seen, set_seen] = useState({
    picture: -1,
    profile: -1,
    empty: -1,
    points: 0,
    line: 0,
    tip: '',
    scale: null as Scale | null,
  });
  const [without, set_without] = useState('');
  const [colour, set_colour] = useState<LiveColour>('height');
  useEffect(() => {
    if (box.current) {
      try {
        scene.current = new LiveScene(box.current);
      } catch {
        set_without(t('no_webgl'));
      }
    }
    let address = '';
    const stop = watch_live((message) => {
      if (message.kind === 'picture' && picture.current) {
        const before = address;
        address = URL.createObjectURL(message.jpeg);
        picture.current.src = address;
        picture.current.hidden = false;
        if (before) URL.revokeObjectURL(before);
        set_seen((s) => ({ ...s, picture: message.seq }));
      } else if (message.kind === 'profile' && profile.current) {
        const empty = message.xz_mm.length === 0;
        if (!empty) draw_profile(profile.current, message.xz_mm, message.flags);
        set_seen((s) => ({
          ...s,
          profile: empty ? s.profile : message.seq,
          empty: empty ? message.seq : -1,
        }));
      } else if (message.kind === 'cloud') {
        scene.current?.add_cloud(message.scan, message.points);
        set_seen((s) => ({
          ...s,
          scale: scene.current?.scale() ?? null,
          points: scene.current?.points() ?? 0,
          line: scene.current?.line_points() ?? 0,
        }));
      } else if (message.kind === 'line') {
        scene.current?.set_line(message.values);
        set_seen((s) => ({ ...s, line: message.values.length / 5 }));
      } else if (message.kind === 'arm') {
        scene.current?.move_tip(message.tip_mm);
        set_seen((s) => ({ ...s, tip: message.tip_mm.map((v) => number(v, 0)).join(', ') }));
      }
    });
    return () => {
      stop();
      scene.current?.dispose();
      scene.current = null;
      if (address) URL.revokeObjectURL(address);
    };
  }, []);
  useEffect(() => {
    if (!scene.current) return;
    scene.current.colour = colour;
    scene.current.recolour();
    const scale = scene.current.scale();
    set_seen((s) => ({ ...s, scale }));
  }, [colour]);
  return (
    <div class="live-grid">
      <figure class="card">
        <figcaption>{t('live_picture')}</figcaption>
        <img ref={picture} alt={t('live_picture_words')} hidden />
        {seen.picture < 0 && <p class="quiet">{t('live_picture_none')}</p>}
      </figure>
      <figure class="card">
        <figcaption>{t('live_profile')}</figcaption>
        <canvas ref={profile} class="profile" role="img" aria-label={t('live_profile')} />
        <p class="quiet">
          {seen.profile < 0 ? t('live_profile_none') : t('live_profile_words', { seq: seen.profile })}
          {seen.empty >= 0 && ` ${t('live_profile_empty', { seq: seen.empty })}`}
        </p>
      </figure>
      <figure class="card wide">
        <figcaption>
          {t('live_cloud')}{' '}
          <label>
            {t('colour')}{' '}
            <select value={colour} onChange={(e) => set_colour(e.currentTarget.value as LiveColour)}>
              <option value="height">{t('colour_height')}</option>
              <option value="curvature">{t('colour_curvature')}</option>
              <option value="uncertainty">{t('colour_sigma')}</option>
              <option value="time">{t('colour_time')}</option>
            </select>
          </label>
          <ColourScale by={colour} scale={seen.scale} />
        </figcaption>
        <div class="stage" ref={box} role="img" aria-label={t('live_cloud')}>
          {without && <p class="notice refused">{without}</p>}
        </div>
        <p class="quiet">
          {t('live_cloud_words', { points: seen.points.toLocaleString(), line: seen.line })}
          {seen.tip && ` ${t('live_tip', { place: seen.tip })}`}
        </p>
      </figure>
    </div>
  );
}

/// The newest scans that wait for a person.
export function Waiting(): JSX.Element | null {
  const { state } = use_store();
  const { value } = use_reading<{ scans: ScanRow[] }>('/scans?limit=20');
  const waiting = (value?.scans ?? []).filter(
    (scan) =>
      scan.decision === 'held' ||
      (scan.decision === 'open' &&
        (scan.verdict === 'ok' || scan.verdict === 'amber') &&
        scan.reason_code !== 'stopped_by_a_person' &&
        scan.id === state?.scan),
  );
  if (waiting.length === 0) return null;
  const title = may('operator') ? t('waiting') : t('waiting_operator');
  return (
    <section class="card look" aria-label={title}>
      <h2>{title}</h2>
      {waiting.map((scan) => (
        <div key={scan.id}>
          <p>
            <a href={`#/scans/${scan.id}`}>{scan.id}</a> <Verdict scan={scan} />{' '}
            {scan.why ?? scan.reason ?? ''}
          </p>
          <Fresh scan={scan.id} />
          <Decide scan={scan} />
        </div>
      ))}
    </section>
  );
}

/// A scan that waits since nobody knows its model goes on as the one that is chosen here.
function ChooseModel({ scan, enabled }: { scan: ScanRow; enabled: boolean }): JSX.Element {
  const { value } = use_reading<{ models: Model[] }>('/models');
  const [model, set_model] = useState('');
  return (
    <form
      class="tools"
      onSubmit={(event) => {
        event.preventDefault();
        void act(t('done_choose_model', { scan: scan.id, model }), () =>
          call('POST', `/scans/${scan.id}/model`, { model }),
        );
      }}
    >
      <label>
        {t('model')}{' '}
        <select
          required
          value={model}
          disabled={!enabled}
          onChange={(event) => set_model(event.currentTarget.value)}
        >
          <option value="">{t('choose')}</option>
          {(value?.models ?? []).map((one) => (
            <option key={one.name} value={one.name}>
              {one.name}
            </option>
          ))}
        </select>
      </label>
      <button type="submit" class="go" disabled={!enabled || model === ''}>
        {t('use_model')}
      </button>
    </form>
  );
}

/// Accept, reject, hold, send, rescan: what may be done with a scan now.
export function Decide({ scan }: { scan: ScanRow }): JSX.Element {
  const { state } = use_store();
  const sendable = use_sendable(scan.id);
  const shown = use_shown_version(scan.id);
  const enabled = may('operator') && holds_control();
  const at = `/scans/${scan.id}`;
  const has_line = scan.verdict === 'ok' || scan.verdict === 'amber';
  // What the service would refuse is not offered: it sends what waits, and holds what is in work.
  const nameless = scan.decision === 'held' && scan.reason_code === 'model_unknown';
  const decided = scan.sent || scan.decision === 'rejected' || scan.decision === 'accepted';
  const no_word_yet = !decided && (has_line || scan.decision === 'held');
  const waits = has_line && scan.decision === 'held' && !scan.sent && !nameless;
  return (
    <div class="tools">
      {nameless && <ChooseModel scan={scan} enabled={enabled} />}
      {waits && (
        <button
          type="button"
          class="go"
          disabled={!enabled || !sendable}
          onClick={() => void act(t('done_accept'), () => call('POST', `${at}/accept`, shown))}
        >
          {t('accept')}
        </button>
      )}
      <LookAgain scan={scan.id} enabled={enabled} />
      {no_word_yet && (
        <AskWhy
          label={t('reject')}
          kind="stop-quiet"
          often={[t('reject_line'), t('reject_moved'), t('reject_other'), t('reject_dirt')]}
          disabled={!enabled || (state?.held?.scan === scan.id && !offered('reject'))}
          act={(why) => void act(t('done_reject'), () => call('POST', `${at}/reject`, { why }))}
        />
      )}
      {scan.verdict === 'working' && scan.decision !== 'held' && (
        <AskWhy
          label={t('hold')}
          needed={false}
          disabled={!enabled}
          act={(why) => void act(t('done_hold'), () => call('POST', `${at}/hold`, why ? { why } : {}))}
        />
      )}
      <button
        type="button"
        // Of a scan without a line it is the next step.
        class={scan.verdict === 'refused' || scan.verdict === 'failed' ? 'go' : undefined}
        disabled={!enabled || !offered('rescan')}
        onClick={() => void act(t('done_rescan'), () => call('POST', '/commands/rescan', {}))}
      >
        {t('rescan')}
      </button>
      {waits && <NotSendable scan={scan.id} />}
      {!enabled && <p class="quiet">{may('operator') ? t('needs_control') : t('needs_operator')}</p>}
    </div>
  );
}

/// What happens now, and next.  The service's own sentences are English: elsewhere its codes are put into words.
function NowWords({ state }: { state: State }): JSX.Element {
  const english = language() === 'en';
  return (
    <>
      <p class="big">
        {english ? state.now : `${t(`phase_${state.phase}`)}${state.scan === null ? '' : ` (${state.scan})`}`}
      </p>
      <p>
        {t('next')} {english ? state.next : t_or(`next_is_${state.next_code ?? ''}`, '–')}
      </p>
    </>
  );
}

export function Live(): JSX.Element {
  const { state, host } = use_store();
  const enabled = may('operator') && holds_control();
  if (!state) return <Failure text={host ? t('waits_for_state') : t('code_host_away')} />;
  return (
    <>
      <h1>{t('nav_live')}</h1>
      {state.simulated && <p class="notice">{t('simulated')}</p>}
      <Waiting />
      <section class="card now" aria-live="polite">
        <NowWords state={state} />
        {state.progress !== null && <progress value={state.progress} max={1} aria-label={t('progress')} />}
        <StartForm enabled={enabled} />
        <div class="tools">
          {state.process_by && !state.held && (
            <button
              type="button"
              disabled={!enabled}
              onClick={() =>
                void act(t('done_start'), () => call('POST', '/commands/start', { process: '' }))
              }
            >
              {t('start_own_process')}
            </button>
          )}
          {!enabled && <p class="quiet">{may('operator') ? t('needs_control') : t('needs_operator')}</p>}
        </div>
      </section>
      <ul class="lamps" aria-label={t('lamps')}>
        {lamps_of(state.lamps).map((name) => {
          const lamp = state.lamps[name] ?? { level: 'unknown', words: '' };
          return (
            <li key={name} class={`lamp ${lamp.level}`}>
              <span class="sign" aria-hidden="true">
                {lamp_signs[lamp.level] ?? '?'}
              </span>
              <span>
                <strong>{t_or(`lamp_${name}`, name)}</strong>: {t_or(`level_${lamp.level}`, lamp.level)}
                <br />
                <LampWords lamp={lamp} />
              </span>
            </li>
          );
        })}
      </ul>
      <Figures
        rows={[
          [t('cycle_this'), amount(state.cycle?.this_s, 's', 1)],
          [t('cycle_last'), amount(state.cycle?.last_s, 's', 1)],
          [
            t('model'),
            state.model
              ? `${state.model.name}${state.model.probability !== undefined ? ` (${number(state.model.probability, 2)})` : ''}`
              : '–',
          ],
          [
            t('process'),
            state.process_by
              ? t('process_by', { process: state.process ?? '–', who: state.process_by })
              : (state.process ?? t('process_of_model')),
          ],
          [t('shoe'), shoe_words(state)],
          [t('scan'), state.scan ? <a href={`#/scans/${state.scan}`}>{state.scan}</a> : '–'],
        ]}
      />
      <LivePictures />
    </>
  );
}
