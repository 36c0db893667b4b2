// SPDX-License-Identifier: MIT
// The sensor by itself: its picture with what was found in it, meters for focus and exposure, what it runs with.
import type { JSX } from 'preact';
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import type { LiveSensor } from 'openapi';
import { amount, number, t, t_or } from '../words';
import { watch_live } from './live_data';
import { Chart, Figures } from './parts';
import { SensorKeep } from './sensor_keep';
import {
  type Measures,
  type PeakMark,
  type Peaks,
  count_marks,
  draw_peaks,
  mark_colours,
  measure,
} from './sensor_picture';
import { SensorSettings } from './sensor_settings';
import { upkeep_rows } from './upkeep';

interface Seen {
  peaks: Peaks;
  measures: Measures;
}

const all_marks = Object.keys(mark_colours) as PeakMark[];

/// Two a second are enough to read; the picture itself is as fast as it comes.
const between_figures_ms = 500;

/// The sensor speaks some times a second.
const silent_after_ms = 3000;

function use_sensor(canvas: { current: HTMLCanvasElement | null }, hidden: Set<PeakMark>) {
  const [state, set_state] = useState<LiveSensor | null>(null);
  const [seen, set_seen] = useState<Seen | null>(null);
  const [silent, set_silent] = useState(false);
  const hide = useRef(hidden);
  hide.current = hidden;
  useEffect(() => {
    let peaks: Peaks | null = null;
    let picture: { seq: number; jpeg: Blob } | null = null;
    let drawing = false;
    let told_at = 0;
    let silence: ReturnType<typeof setTimeout> | undefined;
    const show = async (of: Peaks, jpeg: Blob) => {
      drawing = true;
      try {
        const image = await createImageBitmap(jpeg);
        const place = canvas.current;
        const c = place?.getContext('2d', { willReadFrequently: true });
        if (place && c) {
          place.width = image.width;
          place.height = image.height;
          c.drawImage(image, 0, 0);
          if (performance.now() - told_at > between_figures_ms) {
            told_at = performance.now();
            const grey = c.getImageData(0, 0, image.width, image.height).data;
            set_seen({ peaks: of, measures: measure(grey, image.width, image.height, of) });
          }
          draw_peaks(c, of, (mark) => !hide.current.has(mark));
        }
        image.close();
      } catch {
        // A picture that came damaged: the next one is better.
      }
      drawing = false;
    };
    const stop = watch_live((message) => {
      if (message.kind === 'sensor') {
        set_state(message.state);
        set_silent(false);
        clearTimeout(silence);
        silence = setTimeout(() => set_silent(true), silent_after_ms);
      }
      if (message.kind === 'peaks') peaks = message.peaks;
      if (message.kind === 'picture') picture = message;
      if (peaks && picture && peaks.seq === picture.seq && !drawing) {
        const shown = picture;
        picture = null;
        void show(peaks, shown.jpeg);
      }
    });
    return () => {
      clearTimeout(silence);
      stop();
    };
  }, []);
  return { state, seen, silent };
}

function Curves({ seen }: { seen: Seen }): JSX.Element {
  const { measures, peaks } = seen;
  const across = useMemo(
    () => measures.columns.map((_, i) => peaks.region_px[0] + i * peaks.step),
    [measures],
  );
  const down = useMemo(() => measures.rows.map((_, i) => peaks.region_px[1] + i * peaks.step), [measures]);
  const columns = useMemo(
    () => [{ label: t('grey_level'), values: measures.columns, colour: '--link' }],
    [measures],
  );
  const rows = useMemo(
    () => [{ label: t('grey_level'), values: measures.rows, colour: '--link' }],
    [measures],
  );
  const widths = useMemo(
    () => [{ label: t('stripe_width'), values: measures.widths_px, colour: '--link' }],
    [measures],
  );
  return (
    <div class="live-grid">
      <Chart label={t('column_profile')} x={across} curves={columns} is_time={false} />
      <Chart label={t('row_profile')} x={down} curves={rows} is_time={false} />
      <Chart label={t('width_profile')} x={across} curves={widths} is_time={false} />
    </div>
  );
}

function Meters({ seen }: { seen: Seen }): JSX.Element {
  const { width_px, sharpness, saturated } = seen.measures;
  return (
    <Figures
      rows={[
        [t('stripe_width'), amount(width_px, 'px', 1)],
        [t('sharpness'), amount(sharpness, t('grey_a_px'), 1)],
        [t('saturated'), saturated === null ? '–' : `${number(100 * saturated, 0)} %`],
        [t('picture_step'), String(seen.peaks.step)],
      ]}
    />
  );
}

export function Sensor(): JSX.Element {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [hidden, set_hidden] = useState(new Set<PeakMark>());
  const { state, seen, silent } = use_sensor(canvas, hidden);
  const counts = seen ? count_marks(seen.peaks) : new Map<PeakMark, number>();
  const toggle = (mark: PeakMark) => {
    const next = new Set(hidden);
    if (!next.delete(mark)) next.add(mark);
    set_hidden(next);
  };
  return (
    <>
      <h1>{t('nav_sensor')}</h1>
      {!state && <p class="notice">{t('sensor_none')}</p>}
      {silent && <p class="notice look">{t('sensor_silent')}</p>}
      {state?.simulated && <p class="notice">{t('simulated')}</p>}
      {state?.settings?.some((row) => row.key === 'camera.test_pattern' && row.now === true) && (
        <p class="notice look">{t('test_pattern_on')}</p>
      )}
      {state && (
        <Figures
          rows={[
            [t('sensor'), `${state.name} ${state.version}`],
            [
              t('lamp_laser'),
              silent
                ? '–'
                : `${t_or(`laser_is_${state.laser}`, state.laser)}${state.laser_reason ? `: ${state.laser_reason}` : ''}`,
            ],
            [t('rate_max'), amount(state.rate_max_hz, 'Hz', 1)],
            [t('temperature'), amount(state.temperature_degc, '°C', 1)],
            [
              t('frames_words'),
              t('frames_counts', {
                frames: state.frames,
                lost: state.frames_lost,
                damaged: state.frames_damaged,
              }),
            ],
            [
              t('trigger'),
              state.trigger
                ? t('trigger_counts', { edges: state.trigger.edges, missed: state.trigger.edges_missed })
                : t(state.triggered_by_software ? 'trigger_software' : 'trigger_untied'),
            ],
            ...upkeep_rows(state.upkeep),
          ]}
        />
      )}
      <figure class="card wide">
        <figcaption>{t('sensor_picture')}</figcaption>
        <canvas ref={canvas} class="sensor-picture" role="img" aria-label={t('sensor_picture_words')} />
        {!seen && <p class="quiet">{t('live_picture_none')}</p>}
        <ul class="marks" aria-label={t('peaks_found')}>
          {all_marks.map((mark) => (
            <li key={mark}>
              <label>
                <input type="checkbox" checked={!hidden.has(mark)} onChange={() => toggle(mark)} />
                <span class="mark" style={{ background: mark_colours[mark] }} aria-hidden="true" />{' '}
                {t_or(`mark_${mark}`, mark)}: {counts.get(mark) ?? 0}
              </label>
            </li>
          ))}
        </ul>
      </figure>
      {seen && <Meters seen={seen} />}
      {seen && <Curves seen={seen} />}
      {state && (
        <section>
          <h2>{t('settings_in_use')}</h2>
          <p>{t('settings_how')}</p>
          {state.settings ? (
            <SensorSettings rows={state.settings} />
          ) : (
            <p class="quiet">{t('settings_none')}</p>
          )}
        </section>
      )}
      {state && !state.recording && <SensorKeep scanning={state.scanning} />}
    </>
  );
}
