// SPDX-License-Identifier: MIT
// A model: of a scan, or of another cell's file.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { Model, ProcessRow, ScanRow } from 'openapi';
import { t } from '../words';
import { query, send_file } from './api';
import { ModelForm, name_pattern } from './model_form';
import { act, holds_control, time_words, use_reading, use_store } from './store';

export function NewModel({ names }: { names: string[] }): JSX.Element {
  const { value: scans } = use_reading<{ scans: ScanRow[] }>('/scans?limit=100');
  const { value: processes } = use_reading<{ processes: ProcessRow[] }>('/processes');
  const [form, set_form] = useState({ scan: '', process: '' });
  const usable = (scans?.scans ?? []).filter((scan) => scan.verdict === 'ok' || scan.verdict === 'amber');
  const field = (name: keyof typeof form) => ({
    value: form[name],
    onInput: (event: { currentTarget: { value: string } }) =>
      set_form({ ...form, [name]: event.currentTarget.value }),
  });
  return (
    <section class="card">
      <h2>{t('new_model')}</h2>
      <p>{t('new_model_words')}</p>
      <ModelForm look="form" names={names} scan={form.scan} process={form.process} enabled>
        <label>
          {t('scan')}{' '}
          <select required {...field('scan')}>
            <option value="">{t('choose')}</option>
            {usable.map((scan) => (
              <option key={scan.id} value={scan.id}>
                {scan.id}, {time_words(scan.time)}
              </option>
            ))}
          </select>
        </label>
        <label>
          {t('process')}{' '}
          <select {...field('process')}>
            <option value="">{t('process_of_scan')}</option>
            {(processes?.processes ?? []).map((process) => (
              <option key={process.name} value={process.name}>
                {process.name}
              </option>
            ))}
          </select>
        </label>
      </ModelForm>
    </section>
  );
}

/// The file of an export; without a name it keeps its own.
export function ImportModel({ names }: { names: string[] }): JSX.Element {
  use_store();
  const [file, set_file] = useState<File | null>(null);
  const [name, set_name] = useState('');
  const [replace, set_replace] = useState(false);
  const [busy, set_busy] = useState(false);
  const enabled = holds_control() && !busy;
  const bring = async () => {
    if (!file) return;
    set_busy(true);
    try {
      const path = `/model-files${query({ name, replace: replace ? 'true' : '' })}`;
      const done = await act(t('done_import', { name: name || file.name }), () =>
        send_file<Model>(path, file, 'application/x-tar'),
      );
      // Said of this file alone: the next one replaces nothing unasked.
      if (done) set_replace(false);
    } finally {
      set_busy(false);
    }
  };
  return (
    <section class="card">
      <h2>{t('import_model')}</h2>
      <p>{t('import_model_words')}</p>
      {!holds_control() && <p class="quiet">{t('needs_control')}</p>}
      <form
        class="form"
        onSubmit={(event) => {
          event.preventDefault();
          void bring();
        }}
      >
        <label>
          {t('model_file')}{' '}
          <input
            type="file"
            accept=".tar"
            required
            disabled={!enabled}
            onChange={(event) => set_file(event.currentTarget.files?.[0] ?? null)}
          />
        </label>
        <label>
          {t('under_name')}{' '}
          <input
            maxLength={64}
            pattern={name_pattern}
            value={name}
            disabled={!enabled}
            onInput={(event) => set_name(event.currentTarget.value)}
          />
        </label>
        <label>
          <input
            type="checkbox"
            checked={replace}
            disabled={!enabled}
            onChange={(event) => set_replace(event.currentTarget.checked)}
          />{' '}
          {t('replace_same')}
        </label>
        {names.includes(name) && !replace && <p class="notice look">{t('name_taken', { name })}</p>}
        <button type="submit" class="go" disabled={!enabled || !file}>
          {busy ? t('import_waits') : t('import_go')}
        </button>
      </form>
    </section>
  );
}
