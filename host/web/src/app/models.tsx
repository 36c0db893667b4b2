// SPDX-License-Identifier: MIT
// The library of samples: from a scan to a model, and out of use again.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { Model, ScanRow } from 'openapi';
import { amount, t } from '../words';
import { base, call } from './api';
import { LineDrawing } from './line_drawing';
import { ImportModel, NewModel } from './new_model';
import { Failure, InForce, Table } from './parts';
import { act, may, use_reading } from './store';

const newest_scans = 500;

export function Models(): JSX.Element {
  const { value, error } = use_reading<{ models: Model[]; release: string | null }>('/models');
  // A model that was taught from an older scan has its picture on its own page.
  const { value: scans } = use_reading<{ scans: ScanRow[] }>(`/scans?limit=${newest_scans}`);
  const [asked, set_asked] = useState('');
  const names = (value?.models ?? []).map((model) => model.name);
  return (
    <>
      <h1>{t('nav_models')}</h1>
      <Failure text={error} />
      <InForce release={value?.release} />
      {value && value.models.length === 0 && <p>{t('no_models')}</p>}
      {value && value.models.length > 0 && (
        <Table
          label={t('nav_models')}
          heads={[
            t('name'),
            t('layer_line'),
            t('scan'),
            t('process'),
            t('size'),
            t('foot'),
            t('sample_of'),
            t('length'),
            t('recognised'),
            '',
          ]}
        >
          {value.models.map((model) => (
            <tr key={model.name}>
              <th scope="row">
                <a href={`#/models/${model.name}`}>{model.name}</a>
              </th>
              <td>
                <LineDrawing
                  model={model}
                  scans={scans?.scans ?? []}
                  label={t('model_line', { name: model.name })}
                />
              </td>
              <td>{model.scan ? <a href={`#/scans/${model.scan}`}>{model.scan}</a> : '–'}</td>
              <td>{model.process ?? '–'}</td>
              <td>{model.size ?? '–'}</td>
              <td>{model.foot ? t(model.foot) : '–'}</td>
              <td>{model.of ?? '–'}</td>
              <td>{amount(model.length_mm, 'mm', 1)}</td>
              <td>{model.scans ?? '–'}</td>
              <td>
                <a class="button" href={`${base}/models/${model.name}/file`} download={`${model.name}.tar`}>
                  {t('export_one', { name: model.name })}
                </a>{' '}
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
        <>
          <NewModel names={names} />
          <ImportModel names={names} />
        </>
      ) : (
        <p class="quiet">{t('needs_engineer')}</p>
      )}
    </>
  );
}
