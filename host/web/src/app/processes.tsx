// SPDX-License-Identifier: MIT
// Processes as forms: every field, range, unit and help comes from the service's schema.
import type { JSX } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import type { Fault, ProcessRow } from 'openapi';
import { t } from '../words';
import { Refused, call } from './api';
import type { Schema } from './json_schema';
import { Failure, InForce } from './parts';
import { TriedWords, use_try } from './process_check';
import { Field, type Value, put } from './process_field';
import { may, tell, time_words, use_reading, words_of } from './store';

export function Processes(): JSX.Element {
  const { value, error } = use_reading<{ processes: ProcessRow[]; release: string | null }>('/processes');
  const { value: schema } = use_reading<Schema>('/processes/schema');
  const [name, set_name] = useState('');
  const first = value?.processes[0]?.name ?? '';
  const chosen = name || first;
  return (
    <>
      <h1>{t('nav_processes')}</h1>
      <Failure text={error} />
      <InForce release={value?.release} />
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
  const tried = use_try(editable ? edited : null, set_faults);
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
