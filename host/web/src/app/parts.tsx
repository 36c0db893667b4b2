// SPDX-License-Identifier: MIT
// Small parts that several views use.
import type { ComponentChildren, JSX } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import uPlot from 'uplot';
import type { ScanRow, Work } from 'openapi';
import { locale, number, t, t_or, time_zone } from '../words';

/// A shape before the word: a verdict is never told by colour alone.
export const verdict_signs: Record<string, string> = {
  ok: '✔',
  amber: '▲',
  review: '?',
  refused: '✖',
  failed: '!',
  working: '…',
};

export function Verdict({ scan }: { scan: ScanRow }): JSX.Element {
  return (
    <span class={`verdict ${scan.verdict}`}>
      <span aria-hidden="true">{verdict_signs[scan.verdict] ?? ''}</span>{' '}
      {t_or(`verdict_${scan.verdict}`, scan.verdict)}
    </span>
  );
}

/// Whose shoe: part number, foot and size, as far as somebody knows.
export function shoe_words(shoe: {
  part?: string | null;
  foot?: 'left' | 'right' | null;
  size?: string | null;
}): string {
  const words = [shoe.part, shoe.foot && t(shoe.foot), shoe.size].filter(Boolean);
  return words.length > 0 ? words.join(', ') : '–';
}

/// What a look after the work told, in one line.
export function work_words(work: Work): string {
  const counts = (['narrow', 'wide', 'beside', 'doubled'] as const)
    .filter((kind) => work[kind] > 0)
    .map((kind) => `${work[kind]} × ${t(`work_${kind}`)}`);
  const missing = work.missing_mm ? [`${t('work_missing')} ${number(work.missing_mm, 1)} mm`] : [];
  const again = work.reworked ? [t('work_reworked')] : [];
  return [t(`work_${work.verdict}`), ...missing, ...counts, ...again].join(', ');
}

export function Figures({ rows }: { rows: [string, ComponentChildren][] }): JSX.Element {
  return (
    <dl class="figures">
      {rows.map(([name, value]) => (
        <div key={name}>
          <dt>{name}</dt>
          <dd>{value}</dd>
        </div>
      ))}
    </dl>
  );
}

export function Failure({ text }: { text: string }): JSX.Element | null {
  return text ? <p class="notice refused">{text}</p> : null;
}

/** Whose models and processes are shown, where it is not this cell that they belong to. */
export function InForce({ release }: { release: string | null | undefined }): JSX.Element | null {
  return release ? <p class="notice">{t('release_in_force', { release: release.slice(0, 12) })}</p> : null;
}

/// A numbered step; `done` puts a tick beside its name.
export function Step(props: {
  number: number;
  name: string;
  done: boolean;
  children: ComponentChildren;
}): JSX.Element {
  return (
    <section class="card step" aria-label={props.name}>
      <h2>
        <span class="step-number" aria-hidden="true">
          {props.done ? '✔' : props.number}
        </span>{' '}
        {props.name}
        {props.done && <span class="quiet">{` (${t('done_word')})`}</span>}
      </h2>
      {props.children}
    </section>
  );
}

/// A table that scrolls by itself on a narrow screen, also by keyboard.
export function Table(props: { label: string; heads: string[]; children: ComponentChildren }): JSX.Element {
  return (
    <section class="scroll" tabIndex={0} aria-label={props.label}>
      <table>
        <thead>
          <tr>
            {props.heads.map((head) =>
              // A heading without words is none for a screen reader.
              head === '' ? (
                <td key="none" />
              ) : (
                <th key={head} scope="col">
                  {head}
                </th>
              ),
            )}
          </tr>
        </thead>
        <tbody>{props.children}</tbody>
      </table>
    </section>
  );
}

/// A button that asks for a reason before it acts.  `at_once`: the question stands there already.
export function AskWhy(props: {
  label: string;
  kind?: string;
  needed?: boolean;
  disabled?: boolean;
  at_once?: boolean;
  /// Reasons that one tap says: nobody types in gloves.
  often?: string[];
  act: (why: string) => void;
  cancel?: () => void;
}): JSX.Element {
  const [open, set_open] = useState(props.at_once ?? false);
  const [why, set_why] = useState('');
  const field = useRef<HTMLInputElement>(null);
  useEffect(() => {
    if (open) field.current?.focus();
  }, [open]);
  const act = (word: string) => {
    set_open(false);
    set_why('');
    props.act(word);
  };
  if (!open) {
    return (
      <button type="button" class={props.kind} disabled={props.disabled} onClick={() => set_open(true)}>
        {props.label}
      </button>
    );
  }
  return (
    <form
      class="ask"
      onSubmit={(event) => {
        event.preventDefault();
        act(why.trim());
      }}
    >
      {(props.often ?? []).map((word) => (
        <button type="button" key={word} class={props.kind} onClick={() => act(word)}>
          {word}
        </button>
      ))}
      <label>
        {t('why')}{' '}
        <input
          ref={field}
          value={why}
          maxLength={500}
          required={props.needed ?? true}
          onInput={(e) => set_why(e.currentTarget.value)}
        />
      </label>
      <button type="submit" class={props.kind}>
        {props.label}
      </button>
      <button
        type="button"
        onClick={() => {
          set_open(false);
          props.cancel?.();
        }}
      >
        {t('cancel')}
      </button>
    </form>
  );
}

function theme_colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function day_words(time: Date): string {
  return time.toLocaleDateString(locale(), { day: 'numeric', month: 'short', timeZone: time_zone() });
}

/// Days where the axis spans days; else hours and minutes, and below them the day that begins there.
function date_words(times_s: number[]): string[] {
  const times = times_s.map((time_s) => new Date(1000 * time_s));
  const step_s = times_s.length > 1 ? times_s[1]! - times_s[0]! : 60;
  if (step_s * (times_s.length - 1) > 2 * 86_400) return times.map(day_words);
  let day = '';
  return times.map((time) => {
    const words = time.toLocaleTimeString(locale(), {
      hour: '2-digit',
      minute: '2-digit',
      second: step_s < 60 ? '2-digit' : undefined,
      timeZone: time_zone(),
    });
    const begins = day !== day_words(time);
    day = day_words(time);
    return begins ? `${words}\n${day}` : words;
  });
}

/// A time of the legend.
function moment_words(time_s: number): string {
  return new Date(1000 * time_s).toLocaleString(locale(), {
    dateStyle: 'medium',
    timeStyle: 'short',
    timeZone: time_zone(),
  });
}

/// One point alone stands in the middle of a day, or between its neighbours.  uPlot's own span of it is years.
function around(plot: uPlot, low: number, high: number): [number, number] {
  const x = plot.data[0];
  if (x.length !== 1) return [low, high];
  const half = plot.scales.x!.time ? 43_200 : 1;
  return [x[0]! - half, x[0]! + half];
}

export interface Curve {
  label: string;
  values: (number | null)[];
  /// Dashes tell curves apart without colour.
  dash?: number[];
  colour: string;
}

/// Curves over time (seconds since 1970) or over whole numbers.
export function Chart(props: {
  label: string;
  x: number[];
  curves: Curve[];
  is_time?: boolean;
}): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (!box.current || props.x.length === 0) return;
    const axis = {
      stroke: theme_colour('--text'),
      grid: { stroke: theme_colour('--edge'), width: 0.5 },
      ticks: { stroke: theme_colour('--edge') },
    };
    const newest = props.x.length - 1;
    const plot = new uPlot(
      {
        width: Math.max(280, box.current.clientWidth),
        height: 220,
        scales: { x: { time: props.is_time ?? true, range: around } },
        axes: [props.is_time === false ? axis : { ...axis, values: (_, times) => date_words(times) }, axis],
        series: [
          props.is_time === false
            ? { label: t('place') }
            : { label: t('time'), value: (_, time_s) => (time_s == null ? '–' : moment_words(time_s)) },
          ...props.curves.map((curve) => ({
            label: curve.label,
            stroke: theme_colour(curve.colour),
            dash: curve.dash,
            width: 2,
            points: { show: props.x.length < 60 },
          })),
        ],
        // Where nobody points at a value, the newest one is told.
        hooks: { setCursor: [(self) => self.cursor.idx == null && self.setLegend({ idx: newest }, false)] },
      },
      [props.x, ...props.curves.map((curve) => curve.values)],
      box.current,
    );
    plot.setLegend({ idx: newest }, false);
    const watcher = new ResizeObserver(() => {
      if (box.current) plot.setSize({ width: Math.max(280, box.current.clientWidth), height: 220 });
    });
    watcher.observe(box.current);
    return () => {
      watcher.disconnect();
      plot.destroy();
    };
  }, [props.x, props.curves, props.is_time]);
  return (
    <figure class="chart">
      <figcaption>{props.label}</figcaption>
      <div ref={box} role="img" aria-label={props.label} />
    </figure>
  );
}
