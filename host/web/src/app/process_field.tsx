// SPDX-License-Identifier: MIT
// One field of a process, or a group of them: range and unit come from the service's schema, words from words/.
import type { JSX } from 'preact';
import type { Fault } from 'openapi';
import { help_words, t, t_or } from '../words';
import type { Schema } from './json_schema';
import { PlacementPicture } from './placement_picture';

export type Value = unknown;

function kind_of(schema: Schema): string {
  const types = [schema.type ?? (schema.properties ? 'object' : 'string')].flat();
  return types.find((name) => name !== 'null') ?? 'string';
}

export function put(object: Value, key: string | number, value: Value): Value {
  if (Array.isArray(object)) return object.map((old, i) => (i === key ? value : old));
  const { [key]: _, ...others } = (object ?? {}) as Record<string, Value>;
  return value === undefined ? others : { ...(object as object), [key]: value };
}

/// As people write the schema's units.
const unit_signs: Record<string, string> = { degrees: '°', 'mm/s2': 'mm/s²' };
function unit_of(schema: Schema): string {
  const unit = schema['x-unit'] ?? '';
  return unit_signs[unit] ?? unit;
}

/// "zones[2].name" as the words' files call it.
function key_of(path: string): string {
  return path.replace(/\[\d+\]/g, '[]');
}

function range_words(schema: Schema): string {
  const unit = unit_of(schema) ? ` ${unit_of(schema)}` : '';
  if (schema.minimum !== undefined && schema.maximum !== undefined)
    return `${schema.minimum} … ${schema.maximum}${unit}`;
  if (schema.minimum !== undefined) return `≥ ${schema.minimum}${unit}`;
  if (schema.maximum !== undefined) return `≤ ${schema.maximum}${unit}`;
  return unit.trim();
}

export function Field(props: {
  name: string;
  path: string;
  /// Where the path's own words are not meant: of a list's item.
  title?: string;
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
      {[help_words(`help_${key_of(path)}`, schema.description ?? ''), range_words(schema)]
        .filter(Boolean)
        .join(' · ')}
      {fault.map((f) => (
        <strong key={f.message} class="field-fault">
          {' '}
          ✖ {f.message}
        </strong>
      ))}
    </span>
  );
  const title = props.title ?? t_or(`field_${key_of(path)}`, schema.title ?? props.name);
  const common = { 'aria-describedby': help, 'aria-invalid': fault.length > 0, required: props.required };
  if (kind === 'object') {
    return (
      <fieldset>
        <legend>{title}</legend>
        {told}
        {path === 'placement' && <PlacementPicture value={value} schema={schema} change={props.change} />}
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
    // Three numbers are a place, a direction or a turn.
    const item_title = (i: number) =>
      fixed && schema.minItems === 3 ? 'xyz'[i]! : `${t_or(`field_${key_of(path)}[]`, title)} ${i + 1}`;
    return (
      <fieldset>
        <legend>{title}</legend>
        {told}
        {items.map((item, i) => (
          <div class="item" key={`${path}[${i}]`}>
            <Field
              name={item_title(i)}
              title={item_title(i)}
              path={`${path}[${i}]`}
              schema={schema.items!}
              value={item}
              required
              faults={props.faults}
              change={(next) => props.change(put(items, i, next))}
            />
            {!fixed && (
              <button type="button" onClick={() => props.change(items.filter((_, k) => k !== i))}>
                {t('remove_one', { name: item_title(i) })}
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
            {t('add', { name: t_or(`field_${key_of(path)}[]`, title) })}
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
              {t_or(`choice_${one}`, String(one))}
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
          {unit_of(schema) ? ` [${unit_of(schema)}]` : ''}
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
