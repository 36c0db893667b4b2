// SPDX-License-Identifier: MIT
// What is mounted at the cell: the tool by its name, tip and table by touching, the payload as numbers; each a
// version with who and when.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { Mounted, Taught } from 'openapi';
import { amount, number, t, t_or } from '../words';
import { call } from './api';
import { Failure, Figures } from './parts';
import { act, holds_control, may, time_words, use_reading } from './store';

type Part = 'tip' | 'payload' | 'table';
type Vector = [number, number, number];

function place(at: Vector | null | undefined, digits = 1): string {
  return at ? `(${at.map((v) => number(v, digits)).join(', ')}) mm` : '–';
}

function value_words(part: Part, taught: Taught): string {
  if (part === 'tip') return place(taught.at_mm, 2);
  if (part === 'payload') return `${amount(taught.kg, 'kg')}, ${place(taught.centre_mm, 0)}`;
  return amount(taught.z_mm, 'mm');
}

function how_words(taught: Taught): string {
  const by = t('mounted_by', { version: taught.version, who: taught.who, time: time_words(taught.time) });
  if (taught.touches === undefined) return by;
  return `${by}; ${t('mounted_known', {
    touches: taught.touches,
    residual: number(taught.residual_mm),
    u95: number(taught.u95_mm),
  })}`;
}

interface OfPart {
  part: Part;
  mounted: Mounted;
  enabled: boolean;
  change: (method: string, path: string, body?: unknown) => void;
}

function Known({ part, mounted, enabled, change }: OfPart): JSX.Element {
  const taught = mounted[part];
  const touched_by = part === 'table' ? taught?.tip_version : undefined;
  return (
    <>
      {touched_by !== undefined && touched_by !== mounted.tip?.version && (
        <p class="notice look">{t('mounted_other_tip')}</p>
      )}
      <p>{taught ? `${value_words(part, taught)}. ${how_words(taught)}` : t('mounted_none')}</p>
      {taught && (
        <button type="button" disabled={!enabled} onClick={() => change('DELETE', `/mounted/${part}`)}>
          {t('mounted_forget')}
        </button>
      )}
    </>
  );
}

/// Touch after touch, until what they give is told and can be kept.
function Touching(props: OfPart): JSX.Element {
  const { part, mounted, enabled, change } = props;
  const lesson = mounted.lesson?.part === part ? mounted.lesson : null;
  const ready = lesson !== null && lesson.missing === null;
  return (
    <section aria-label={t_or(`mounted_${part}`, part)}>
      <h3>{t_or(`mounted_${part}`, part)}</h3>
      <p class="quiet">{t_or(`mounted_${part}_words`, '')}</p>
      <Known {...props} />
      <div class="tools">
        <button
          type="button"
          class={ready ? '' : 'go'}
          disabled={!enabled || (part === 'table' && !mounted.tip)}
          onClick={() => change('POST', '/mounted/touches', { part })}
        >
          {t('mounted_touch')}
        </button>
        <button
          type="button"
          disabled={!enabled || !lesson}
          onClick={() => change('POST', '/mounted/touches', { part, take_back: true })}
        >
          {t('mounted_take_back')}
        </button>
        <button
          type="button"
          class={ready ? 'go' : ''}
          disabled={!enabled || !ready}
          onClick={() => change('PUT', `/mounted/${part}`)}
        >
          {t('save')}
        </button>
      </div>
      <div role="status">
        {lesson && (
          <p class={`notice ${ready ? 'good' : 'look'}`}>
            {t('mounted_touches', { touches: lesson.touches })}{' '}
            {ready
              ? `${part === 'tip' ? place(lesson.at_mm, 2) : amount(lesson.z_mm, 'mm')}; ${t(
                  'mounted_quality',
                  {
                    residual: number(lesson.residual_mm),
                    u95: number(lesson.u95_mm),
                  },
                )}`
              : lesson.missing}
          </p>
        )}
      </div>
    </section>
  );
}

const axes = ['x', 'y', 'z'] as const;

function Carried(props: OfPart): JSX.Element {
  const { mounted, enabled, change } = props;
  const [typed, set_typed] = useState({ kg: '', x: '', y: '', z: '' });
  const field = (key: keyof typeof typed) => ({
    type: 'number' as const,
    step: 'any',
    required: true,
    size: 6,
    disabled: !enabled,
    value: typed[key],
    onInput: (event: { currentTarget: { value: string } }) =>
      set_typed({ ...typed, [key]: event.currentTarget.value }),
  });
  const controller = mounted.controller;
  const told = controller?.payload_kg ?? null;
  return (
    <section aria-label={t('mounted_payload')}>
      <h3>{t('mounted_payload')}</h3>
      <p class="quiet">{t('mounted_payload_words')}</p>
      <Known {...props} />
      <form
        class="tools"
        onSubmit={(event) => {
          event.preventDefault();
          const centre_mm = axes.map((axis) => Number(typed[axis]));
          change('PUT', '/mounted/payload', { kg: Number(typed.kg), centre_mm });
        }}
      >
        <label>
          {t('mounted_mass')} <input min={0} max={20} {...field('kg')} />
        </label>
        {axes.map((axis) => (
          <label key={axis}>
            {`${t('mounted_centre')} ${axis} [mm]`}
            <input min={-1000} max={1000} {...field(axis)} />
          </label>
        ))}
        <button type="submit" disabled={!enabled}>
          {t('save')}
        </button>
      </form>
      {told !== null && (
        <p class={`notice ${controller?.carries_as_taught === false ? 'look' : ''}`}>
          {t('mounted_controller', { kg: number(told), centre: place(controller?.payload_centre_mm, 0) })}{' '}
          {controller?.carries_as_taught === false && t('mounted_differs')}
        </p>
      )}
    </section>
  );
}

const lines = ['on_output', 'ask_output', 'there_input'] as const;

function lines_words(taught: Taught): string {
  const on = taught.on_output === undefined ? '' : t('mounted_on_told', { on: taught.on_output });
  const changer =
    taught.ask_output === undefined
      ? ''
      : t('mounted_changer_told', { ask: taught.ask_output, there: taught.there_input ?? '' });
  return [on, changer, how_words(taught)].filter(Boolean).join(' ');
}

/// Of the mounted tool: which output switches it, and its place in a changer.
function Wiring({ mounted, enabled, change }: Omit<OfPart, 'part'>): JSX.Element {
  const [typed, set_typed] = useState({ on_output: '', ask_output: '', there_input: '' });
  const taught = mounted.lines;
  const may_save = enabled && mounted.tool !== null;
  return (
    <section aria-label={t('mounted_lines')}>
      <h3>{t('mounted_lines')}</h3>
      <p class="quiet">{t('mounted_lines_words')}</p>
      <p>{taught ? lines_words(taught) : t('mounted_none')}</p>
      {taught && (
        <button type="button" disabled={!enabled} onClick={() => change('DELETE', '/mounted/lines')}>
          {t('mounted_forget')}
        </button>
      )}
      <form
        class="tools"
        onSubmit={(event) => {
          event.preventDefault();
          const told = lines.filter((line) => typed[line] !== '').map((line) => [line, Number(typed[line])]);
          change('PUT', '/mounted/lines', Object.fromEntries(told));
        }}
      >
        {lines.map((line) => (
          <label key={line}>
            {t_or(`mounted_${line}`, line)}{' '}
            <input
              type="number"
              min={0}
              max={7}
              step={1}
              required={line !== 'on_output' && (typed.ask_output !== '') !== (typed.there_input !== '')}
              disabled={!may_save}
              value={typed[line]}
              onInput={(event) => set_typed({ ...typed, [line]: event.currentTarget.value })}
            />
          </label>
        ))}
        <button type="submit" disabled={!may_save || lines.every((line) => typed[line] === '')}>
          {t('save')}
        </button>
      </form>
    </section>
  );
}

/// How far each tool is worn, and since when the mounted one has a new disc, brush or roller.
function Worn({ mounted, enabled, change }: Omit<OfPart, 'part'>): JSX.Element {
  return (
    <section aria-label={t('mounted_renewed')}>
      <h3>{t('mounted_renewed')}</h3>
      <p class="quiet">{t('mounted_renewed_words')}</p>
      {mounted.renewed && <p>{t('mounted_renewed_by', { words: how_words(mounted.renewed) })}</p>}
      {Object.entries(mounted.wear).map(([tool, wear]) => (
        <p key={tool}>
          {wear.sure
            ? t('mounted_wear', {
                tool,
                shoes: wear.shoes,
                mm: number(wear.mm_per_shoe, 4),
                u95: number(wear.u95_mm_per_shoe, 4),
              })
            : t('mounted_wear_none', { tool, shoes: wear.shoes })}
        </p>
      ))}
      <button
        type="button"
        disabled={!enabled || mounted.tool === null}
        onClick={() => change('PUT', '/mounted/renewed')}
      >
        {t('mounted_renew')}
      </button>
    </section>
  );
}

/// An operator who has changed the tool says so here.
function NamedTool({ mounted, enabled, change }: Omit<OfPart, 'part'>): JSX.Element {
  const [name, set_name] = useState('');
  const others = Object.keys(mounted.shelf);
  return (
    <section aria-label={t('mounted_tool')}>
      <h3>{t('mounted_tool')}</h3>
      <p class="quiet">{t('mounted_tool_words')}</p>
      <p>
        {mounted.tool ? `${mounted.tool.name}. ${how_words(mounted.tool)}` : t('mounted_tool_none')}{' '}
        {others.length > 0 && t('mounted_tool_shelf', { names: others.join(', ') })}
      </p>
      <form
        class="tools"
        onSubmit={(event) => {
          event.preventDefault();
          change('PUT', '/mounted/tool', { name });
        }}
      >
        <label>
          {t('mounted_tool_name')}{' '}
          <input
            required
            maxLength={64}
            pattern="[A-Za-z0-9][A-Za-z0-9._\-]*"
            list="mounted-shelf"
            disabled={!enabled}
            value={name}
            onInput={(event) => set_name(event.currentTarget.value)}
          />
        </label>
        <datalist id="mounted-shelf">
          {others.map((other) => (
            <option key={other} value={other} />
          ))}
        </datalist>
        <button type="submit" disabled={!enabled}>
          {t('mounted_tool_mount')}
        </button>
      </form>
    </section>
  );
}

export function MountedCard(): JSX.Element {
  // Read again after each change: act() sees to it.
  const { value: mounted, error } = use_reading<Mounted>('/mounted');
  const enabled = may('engineer') && holds_control();
  const change: OfPart['change'] = (method, path, body) =>
    void act(t('done_mounted'), () => call<Mounted>(method, path, body));
  return (
    <section class="card">
      <h2>{t('mounted')}</h2>
      <p>{t('mounted_words')}</p>
      {!enabled && <p class="quiet">{may('engineer') ? t('needs_control') : t('needs_engineer')}</p>}
      <Failure text={error} />
      {mounted && (
        <>
          <Figures rows={[[t('version'), mounted.version]]} />
          <NamedTool mounted={mounted} enabled={may('operator') && holds_control()} change={change} />
          <Touching part="tip" mounted={mounted} enabled={enabled} change={change} />
          <Carried part="payload" mounted={mounted} enabled={enabled} change={change} />
          <Wiring mounted={mounted} enabled={enabled} change={change} />
          <Worn mounted={mounted} enabled={enabled} change={change} />
          <Touching part="table" mounted={mounted} enabled={enabled} change={change} />
        </>
      )}
    </section>
  );
}
