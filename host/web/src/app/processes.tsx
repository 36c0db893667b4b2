// SPDX-License-Identifier: MIT
// Processes as forms: every field, range, unit and help comes from the service's schema.
import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import { number, t } from '../words';
import { type Fault, type ProcessRow, Refused, type Schema, type TriedProcess, call } from './api';
import { Failure } from './parts';
import { may, tell, time_words, use_reading, words_of } from './store';

type Value = unknown;

function kind_of(schema: Schema): string {
  const types = [schema.type ?? (schema.properties ? 'object' : 'string')].flat();
  return types.find((name) => name !== 'null') ?? 'string';
}

function put(object: Value, key: string | number, value: Value): Value {
  if (Array.isArray(object)) return object.map((old, i) => (i === key ? value : old));
  const { [key]: _, ...others } = (object ?? {}) as Record<string, Value>;
  return value === undefined ? others : { ...(object as object), [key]: value };
}

function range_words(schema: Schema): string {
  const unit = schema['x-unit'] ? ` ${schema['x-unit']}` : '';
  if (schema.minimum !== undefined && schema.maximum !== undefined)
    return `${schema.minimum} … ${schema.maximum}${unit}`;
  if (schema.minimum !== undefined) return `≥ ${schema.minimum}${unit}`;
  if (schema.maximum !== undefined) return `≤ ${schema.maximum}${unit}`;
  return unit.trim();
}

function Field(props: {
  name: string;
  path: string;
  schema: Schema;
  value: Value;
  required: boolean;
  faults: Fault[];
  change: (value: Value) => void;
}): JSX.Element {
  const { schema, path, value } = props;
  const kind = kind_of(schema);
  const fault = props.faults.filter(
    (f) => f.field === path || f.field.replace(/^\//, '').replace(/\//g, '.') === path,
  );
  const help = `${path}-help`;
  const told = (
    <span id={help} class="help">
      {[schema.description, range_words(schema)].filter(Boolean).join(' · ')}
      {fault.map((f) => (
        <strong key={f.message} class="field-fault">
          {' '}
          ✖ {f.message}
        </strong>
      ))}
    </span>
  );
  const title = schema.title ?? props.name;
  const common = { 'aria-describedby': help, 'aria-invalid': fault.length > 0, required: props.required };
  if (kind === 'object') {
    return (
      <fieldset>
        <legend>{title}</legend>
        {told}
        {Object.entries(schema.properties ?? {}).map(([key, part]) => (
          <Field
            key={key}
            name={key}
            path={path ? `${path}.${key}` : key}
            schema={part}
            value={(value as Record<string, Value> | undefined)?.[key]}
            required={schema.required?.includes(key) ?? false}
            faults={props.faults}
            change={(next) => props.change(put(value ?? {}, key, next))}
          />
        ))}
      </fieldset>
    );
  }
  if (kind === 'array' && schema.items) {
    const items = Array.isArray(value) ? value : [];
    const fixed = schema.minItems !== undefined && schema.minItems === schema.maxItems;
    const shown = fixed && items.length === 0 ? [] : items;
    return (
      <fieldset>
        <legend>{title}</legend>
        {told}
        {shown.map((item, i) => (
          <div class="item" key={`${path}[${i}]`}>
            <Field
              name={`${title} ${i + 1}`}
              path={`${path}[${i}]`}
              schema={schema.items!}
              value={item}
              required
              faults={props.faults}
              change={(next) => props.change(put(items, i, next))}
            />
            {!fixed && (
              <button type="button" onClick={() => props.change(items.filter((_, k) => k !== i))}>
                {t('remove_one', { name: `${title} ${i + 1}` })}
              </button>
            )}
          </div>
        ))}
        {(!fixed || items.length === 0) && items.length < (schema.maxItems ?? 1000) && (
          <button
            type="button"
            onClick={() =>
              props.change(
                fixed
                  ? new Array(schema.minItems).fill(0)
                  : [...items, kind_of(schema.items!) === 'object' ? {} : (schema.items!.default ?? 0)],
              )
            }
          >
            {t('add', { name: title })}
          </button>
        )}
      </fieldset>
    );
  }
  if (schema.enum) {
    return (
      <label class="row">
        <span>{title}</span>
        <select
          {...common}
          value={String(value ?? '')}
          onChange={(e) => props.change(schema.enum!.find((v) => String(v) === e.currentTarget.value))}
        >
          {!props.required && <option value="">–</option>}
          {schema.enum.map((one) => (
            <option key={one} value={String(one)}>
              {one}
            </option>
          ))}
        </select>
        {told}
      </label>
    );
  }
  if (kind === 'boolean') {
    return (
      <label class="row">
        <span>{title}</span>
        <input
          type="checkbox"
          aria-describedby={help}
          checked={value === true}
          onChange={(e) => props.change(e.currentTarget.checked)}
        />
        {told}
      </label>
    );
  }
  if (kind === 'number' || kind === 'integer') {
    return (
      <label class="row">
        <span>
          {title}
          {schema['x-unit'] ? ` [${schema['x-unit']}]` : ''}
        </span>
        <input
          {...common}
          type="number"
          step={kind === 'integer' ? 1 : 'any'}
          min={schema.minimum}
          max={schema.maximum}
          placeholder={schema.default !== undefined ? String(schema.default) : ''}
          value={typeof value === 'number' ? value : ''}
          onInput={(e) =>
            props.change(e.currentTarget.value === '' ? undefined : Number(e.currentTarget.value))
          }
        />
        {told}
      </label>
    );
  }
  return (
    <label class="row">
      <span>{title}</span>
      <input
        {...common}
        value={String(value ?? '')}
        maxLength={200}
        onInput={(e) => props.change(e.currentTarget.value === '' ? undefined : e.currentTarget.value)}
      />
      {told}
    </label>
  );
}

/// So long nothing was typed before the service is asked.
const typing_pause_ms = 600;

interface Tried {
  state: 'waits' | 'told' | 'refused';
  told?: TriedProcess;
  words?: string;
}

/// What the service says of a process as it is typed; null: nothing was changed.
function use_try(process: Value, changed: boolean, set_faults: (faults: Fault[]) => void): Tried | null {
  const [tried, set_tried] = useState<Tried | null>(null);
  useEffect(() => {
    if (!changed) {
      set_tried(null);
      set_faults([]);
      return;
    }
    let alive = true;
    set_tried({ state: 'waits' });
    const timer = setTimeout(() => {
      call<TriedProcess>('POST', '/processes/check', { process })
        .then((told) => {
          if (!alive) return;
          set_faults([]);
          set_tried({ state: 'told', told });
        })
        .catch((refused) => {
          if (!alive) return;
          set_faults(refused instanceof Refused ? refused.faults : []);
          set_tried({ state: 'refused', words: words_of(refused) });
        });
    }, typing_pause_ms);
    return () => {
      alive = false;
      clearTimeout(timer);
    };
  }, [process, changed]);
  return tried;
}

function TriedWords({ tried }: { tried: Tried | null }): JSX.Element {
  const told = tried?.told;
  const look = !told ? '' : told.fits ? 'good' : told.fits === false ? 'refused' : 'look';
  const words = !tried
    ? ''
    : tried.state === 'waits'
      ? t('try_waits')
      : !told
        ? `✖ ${tried.words ?? ''}`
        : told.scan === null
          ? t('try_none')
          : told.fits
            ? `✔ ${t('try_fits', { scan: told.scan, seconds: number(told.duration_s, 1) })}`
            : `✖ ${t('try_refused', { scan: told.scan, reason: told.reason ?? '' })} ${told.next_step ?? ''}`;
  return (
    <p role="status" class={tried ? `notice ${look}` : ''}>
      {words}
    </p>
  );
}

export function Processes(): JSX.Element {
  const { value, error } = use_reading<{ processes: ProcessRow[] }>('/processes');
  const { value: schema } = use_reading<Schema>('/processes/schema');
  const [name, set_name] = useState('');
  const first = value?.processes[0]?.name ?? '';
  const chosen = name || first;
  return (
    <>
      <h1>{t('nav_processes')}</h1>
      <Failure text={error} />
      {value && value.processes.length === 0 && <p>{t('no_processes')}</p>}
      {value && value.processes.length > 0 && (
        <label>
          {t('process')}{' '}
          <select value={chosen} onChange={(e) => set_name(e.currentTarget.value)}>
            {value.processes.map((process) => (
              <option key={process.name} value={process.name}>
                {process.name}{' '}
                {process.shipped ? t('shipped') : `${process.who ?? ''} ${time_words(process.time)}`}
              </option>
            ))}
          </select>
        </label>
      )}
      {chosen && schema && <OneProcess key={chosen} name={chosen} schema={schema} />}
    </>
  );
}

function OneProcess({ name, schema }: { name: string; schema: Schema }): JSX.Element {
  const { value: read, error } = use_reading<{ process: Value }>(`/processes/${name}`);
  const [edited, set_edited] = useState<Value>(null);
  const [as, set_as] = useState(name);
  const [faults, set_faults] = useState<Fault[]>([]);
  const editable = may('engineer');
  useEffect(() => {
    if (read && edited === null) set_edited(read.process);
  }, [read]);
  const changed = read !== null && edited !== null && JSON.stringify(read.process) !== JSON.stringify(edited);
  const tried = use_try(edited, changed && editable, set_faults);
  const save = async () => {
    try {
      await call('PUT', `/processes/${as}`, edited);
      set_faults([]);
      tell(t('done_process', { name: as }));
    } catch (refused) {
      set_faults(refused instanceof Refused ? refused.faults : []);
      tell(words_of(refused), true);
    }
  };
  return (
    <form
      class="form"
      onSubmit={(event) => {
        event.preventDefault();
        void save();
      }}
    >
      <Failure text={error} />
      {!editable && <p class="quiet">{t('needs_engineer')}</p>}
      {edited !== null && (
        <fieldset class="plain" disabled={!editable}>
          {Object.entries(schema.properties ?? {}).map(([key, part]) => (
            <Field
              key={key}
              name={key}
              path={key}
              schema={part}
              value={(edited as Record<string, Value>)[key]}
              required={schema.required?.includes(key) ?? false}
              faults={faults}
              change={(next) => set_edited((before: Value) => put(before, key, next))}
            />
          ))}
          <TriedWords tried={tried} />
          <div class="tools">
            <label>
              {t('save_as')}{' '}
              <input
                value={as}
                required
                maxLength={64}
                pattern="[A-Za-z0-9][A-Za-z0-9._\-]*"
                onInput={(e) => set_as(e.currentTarget.value)}
              />
            </label>
            <button type="submit" class="go">
              {t('save')}
            </button>
            <button type="button" disabled={!changed} onClick={() => set_edited(read?.process ?? null)}>
              {t('undo')}
            </button>
            {changed && <span class="quiet">{t('not_saved')}</span>}
          </div>
          <p class="quiet">{t('process_words')}</p>
        </fieldset>
      )}
    </form>
  );
}
