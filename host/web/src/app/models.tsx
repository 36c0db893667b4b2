// SPDX-License-Identifier: MIT
// The library of samples: from a scan to a model, and out of use again.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import { amount, t } from '../words';
import { type Model, type ProcessRow, type ScanRow, call } from './api';
import { Failure, Table } from './parts';
import { act, may, time_words, use_reading } from './store';

export function Models(): JSX.Element {
  const { value, error } = use_reading<{ models: Model[] }>('/models');
  const [asked, set_asked] = useState('');
  return (
    <>
      <h1>{t('nav_models')}</h1>
      <Failure text={error} />
      {value && value.models.length === 0 && <p>{t('no_models')}</p>}
      {value && value.models.length > 0 && (
        <Table
          label={t('nav_models')}
          heads={[
            t('name'),
            t('time'),
            t('scan'),
            t('process'),
            t('size'),
            t('foot'),
            t('version'),
            t('length'),
            t('recognised'),
            '',
          ]}
        >
          {value.models.map((model) => (
            <tr key={model.name}>
              <th scope="row">{model.name}</th>
              <td>{time_words(model.time)}</td>
              <td>{model.scan ? <a href={`#/scans/${model.scan}`}>{model.scan}</a> : '–'}</td>
              <td>{model.process ?? '–'}</td>
              <td>{model.size ?? '–'}</td>
              <td>{model.foot ? t(model.foot) : '–'}</td>
              <td>{model.version ?? '–'}</td>
              <td>{amount(model.length_mm, 'mm', 1)}</td>
              <td>{model.scans ?? '–'}</td>
              <td>
                {may('engineer') && asked !== model.name && (
                  <button type="button" onClick={() => set_asked(model.name)}>
                    {t('remove_one', { name: model.name })}
                  </button>
                )}
                {asked === model.name && (
                  <span class="tools">
                    <button
                      type="button"
                      class="stop-quiet"
                      onClick={() => {
                        set_asked('');
                        void act(t('done_remove', { name: model.name }), () =>
                          call('DELETE', `/models/${model.name}`),
                        );
                      }}
                    >
                      {t('really_remove', { name: model.name })}
                    </button>
                    <button type="button" onClick={() => set_asked('')}>
                      {t('cancel')}
                    </button>
                  </span>
                )}
              </td>
            </tr>
          ))}
        </Table>
      )}
      {may('engineer') ? (
        <NewModel names={(value?.models ?? []).map((m) => m.name)} />
      ) : (
        <p class="quiet">{t('needs_engineer')}</p>
      )}
    </>
  );
}

function NewModel({ names }: { names: string[] }): JSX.Element {
  const { value: scans } = use_reading<{ scans: ScanRow[] }>('/scans?limit=100');
  const { value: processes } = use_reading<{ processes: ProcessRow[] }>('/processes');
  const [form, set_form] = useState({ name: '', scan: '', process: '', size: '', foot: '' });
  const usable = (scans?.scans ?? []).filter((scan) => scan.verdict === 'ok' || scan.verdict === 'amber');
  const field = (name: keyof typeof form) => ({
    value: form[name],
    onInput: (event: { currentTarget: { value: string } }) =>
      set_form({ ...form, [name]: event.currentTarget.value }),
  });
  const exists = names.includes(form.name);
  return (
    <section class="card">
      <h2>{t('new_model')}</h2>
      <p>{t('new_model_words')}</p>
      <form
        class="form"
        onSubmit={(event) => {
          event.preventDefault();
          const body = Object.fromEntries(Object.entries(form).filter(([, value]) => value !== ''));
          void act(t('done_model', { name: form.name }), () =>
            call('POST', '/models', exists ? { ...body, replace: true } : body),
          );
        }}
      >
        <label>
          {t('name')}{' '}
          <input required maxLength={64} pattern="[A-Za-z0-9][A-Za-z0-9._\-]*" {...field('name')} />
        </label>
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
            <option value="">–</option>
            {(processes?.processes ?? []).map((process) => (
              <option key={process.name} value={process.name}>
                {process.name}
              </option>
            ))}
          </select>
        </label>
        <label>
          {t('size')} <input maxLength={20} placeholder="EU 42" {...field('size')} />
        </label>
        <label>
          {t('foot')}{' '}
          <select {...field('foot')}>
            <option value="">–</option>
            <option value="left">{t('left')}</option>
            <option value="right">{t('right')}</option>
          </select>
        </label>
        {exists && <p class="notice look">{t('replaces', { name: form.name })}</p>}
        <button type="submit" class="go">
          {exists ? t('replace') : t('save')}
        </button>
      </form>
    </section>
  );
}
