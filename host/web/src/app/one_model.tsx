// SPDX-License-Identifier: MIT
// A model's page: picture and line, its samples by size and foot, its process, and the shoes that were of it.
import type { JSX } from 'preact';
import type { Model, ScanRow, Trends } from 'openapi';
import { amount, t, t_or } from '../words';
import { base, query } from './api';
import { is_line_of } from './line_drawing';
import { Failure, Figures, Table, Verdict, shoe_words } from './parts';
import { ScannedShoe } from './scanned_shoe';
import { time_words, use_reading } from './store';

const most_shoes = 20;

/// How its shoes ended, and why the others did not.
function Outcome({ name }: { name: string }): JSX.Element | null {
  const { value } = use_reading<Trends>(`/history/trends${query({ model: name, bucket: 'week' })}`);
  if (!value) return null;
  const sum = (key: 'scans' | 'ok' | 'amber' | 'review' | 'refused' | 'failed') =>
    value.buckets.reduce((total, bucket) => total + bucket[key], 0);
  return (
    <>
      <Figures
        rows={[
          [t('count'), sum('scans')],
          ...(['ok', 'amber', 'review', 'refused', 'failed'] as const).map((verdict): [string, number] => [
            t(`verdict_${verdict}`),
            sum(verdict),
          ]),
        ]}
      />
      {value.reasons.length > 0 && (
        <ul>
          {value.reasons.slice(0, 5).map((row) => (
            <li key={row.reason_code}>
              {t_or(`reason_${row.reason_code}`, row.reason_code)}: {row.scans}
            </li>
          ))}
        </ul>
      )}
    </>
  );
}

export function OneModel({ name }: { name: string }): JSX.Element {
  const { value, error } = use_reading<{ models: Model[] }>('/models');
  const shoes = use_reading<{ scans: ScanRow[] }>(`/scans${query({ model: name, limit: most_shoes })}`).value;
  const model = value?.models.find((one) => one.name === name) ?? null;
  const taught = use_reading<ScanRow>(model?.scan ? `/scans/${model.scan}` : null).value;
  if (!model) return <Failure text={error || (value ? t('code_not_found') : '')} />;
  const here = is_line_of(model, taught) ? taught : null;
  const family = model.of ?? model.name;
  const samples = (value?.models ?? []).filter((one) => (one.of ?? one.name) === family);
  return (
    <>
      <h1>{model.name}</h1>
      {model.damage && <Failure text={model.damage} />}
      <div class="model-page">
        {here ? <ScannedShoe scan={here} /> : <p class="notice">{t('model_no_picture')}</p>}
        <div>
          <Figures
            rows={[
              [t('model_taught'), here ? <a href={`#/scans/${here.id}`}>{here.id}</a> : (model.scan ?? '–')],
              [t('time'), time_words(model.time)],
              [t('process'), model.process ? <a href="#/processes">{model.process}</a> : '–'],
              [t('length'), amount(model.length_mm, 'mm', 1)],
              [t('version'), model.version ?? '–'],
              [t('recognised'), model.scans ?? '–'],
            ]}
          />
          <a class="button" href={`${base}/models/${name}/file`} download={`${name}.tar`}>
            {t('export_one', { name })}
          </a>
        </div>
      </div>
      <h2>{t('model_samples')}</h2>
      <Table
        label={t('model_samples')}
        heads={[t('name'), t('size'), t('foot'), t('length'), t('recognised')]}
      >
        {samples.map((one) => (
          <tr key={one.name}>
            <th scope="row">
              {one.name === name ? one.name : <a href={`#/models/${one.name}`}>{one.name}</a>}
            </th>
            <td>{one.size ?? '–'}</td>
            <td>{one.foot ? t(one.foot) : '–'}</td>
            <td>{amount(one.length_mm, 'mm', 1)}</td>
            <td>{one.scans ?? '–'}</td>
          </tr>
        ))}
      </Table>
      <h2>{t('model_shoes')}</h2>
      <Outcome name={name} />
      {shoes && shoes.scans.length > 0 && (
        <Table
          label={t('model_shoes')}
          heads={[t('scan'), t('time'), t('verdict'), t('shoe'), t('reason'), 'U95']}
        >
          {shoes.scans.map((scan) => (
            <tr key={scan.id}>
              <th scope="row">
                <a href={`#/scans/${scan.id}`}>{scan.id}</a>
              </th>
              <td>{time_words(scan.time)}</td>
              <td>
                <Verdict scan={scan} />
              </td>
              <td>{shoe_words(scan)}</td>
              <td>{scan.reason_code ? t_or(`reason_${scan.reason_code}`, scan.reason_code) : '–'}</td>
              <td>{amount(scan.u95_mm, 'mm', 2)}</td>
            </tr>
          ))}
        </Table>
      )}
    </>
  );
}
