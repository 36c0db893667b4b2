// SPDX-License-Identifier: MIT
// Working a kept scan out again with another model, method or process, beside its result.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { Model, ProcessRow, Rerun, Scan } from 'openapi';
import { amount, number, t, t_or } from '../words';
import { call, file_address } from './api';
import { Table } from './parts';
import { act, holds_control, may, time_words, use_reading, use_store } from './store';

interface Settings {
  model: string;
  method: string;
  process: string;
}

function settings_words(one: Rerun): string {
  const { model, method, process, mirror, grade } = one.settings ?? {};
  const words = [
    model && `${t('model')} ${model}`,
    method && t_or(`method_${method}`, method),
    process && `${t('process')} ${process}`,
    mirror && t('mirror'),
    grade && t('grade'),
  ];
  return words.filter(Boolean).join(', ');
}

function outcome_words(one: Rerun): string {
  if (one.state !== 'done') return t_or(`rerun_${one.state}`, one.state);
  return one.verdict === 'ok' ? t('verdict_ok') : (one.reason ?? t('verdict_refused'));
}

function Reruns({ scan }: { scan: Scan }): JSX.Element {
  return (
    <Table
      label={t('reruns')}
      heads={[
        t('reruns'),
        t('time'),
        t('who'),
        t('settings'),
        t('verdict'),
        t('length'),
        t('colour_confidence'),
        '',
      ]}
    >
      {(scan.reruns ?? []).map((one) => (
        <tr key={one.rerun}>
          <th scope="row">{one.rerun}</th>
          <td>{time_words(one.time)}</td>
          <td>{one.who}</td>
          <td>{settings_words(one)}</td>
          <td>{outcome_words(one)}</td>
          <td>{amount(one.length_mm, 'mm', 1)}</td>
          <td>{number(one.confidence, 2)}</td>
          <td>
            {one.line && (
              <a href={file_address(scan.id, one.line)} download={`${scan.id}-${one.rerun}-line.csv`}>
                line.csv
              </a>
            )}{' '}
            {one.path && (
              <a href={file_address(scan.id, one.path)} download={`${scan.id}-${one.rerun}-path.csv`}>
                path.csv
              </a>
            )}
          </td>
        </tr>
      ))}
    </Table>
  );
}

/// The form for engineers; everybody sees what came of it.
export function WorkAgain({ scan }: { scan: Scan }): JSX.Element | null {
  use_store();
  const { value: models } = use_reading<{ models: Model[] }>('/models');
  const { value: processes } = use_reading<{ processes: ProcessRow[] }>('/processes');
  const [settings, set_settings] = useState<Settings>({ model: '', method: '', process: '' });
  const [mirror, set_mirror] = useState(false);
  const [why, set_why] = useState('');
  const reruns = scan.reruns ?? [];
  const engineer = may('engineer');
  if (!engineer && reruns.length === 0) return null;
  const enabled = engineer && holds_control();
  const chosen = settings.model !== '' || settings.method !== '' || settings.process !== '';
  const order = () => {
    const given: Record<string, unknown> = Object.fromEntries(
      Object.entries(settings).filter(([, value]) => value !== ''),
    );
    if (settings.model !== '' && mirror) given.mirror = true;
    return act(t('done_rerun'), () => call('POST', `/scans/${scan.id}/rerun`, { settings: given, why }));
  };
  return (
    <details class="card" open={reruns.length > 0}>
      <summary>{t('work_again')}</summary>
      <p>{t('work_again_words')}</p>
      {reruns.length > 0 && <Reruns scan={scan} />}
      {engineer && !enabled && <p class="quiet">{t('needs_control')}</p>}
      {engineer && (
        <form
          class="form"
          onSubmit={(event) => {
            event.preventDefault();
            void order();
          }}
        >
          <label>
            {t('line_from')}{' '}
            <select
              value={settings.model !== '' ? `model ${settings.model}` : settings.method}
              disabled={!enabled}
              onChange={(event) => {
                const value = event.currentTarget.value;
                const model = value.startsWith('model ') ? value.slice('model '.length) : '';
                set_settings({ ...settings, model, method: model ? '' : value });
              }}
            >
              <option value="">{t('line_kept')}</option>
              <option value="default">{t('method_default')}</option>
              <option value="published">{t('method_published')}</option>
              {(models?.models ?? []).map((model) => (
                <option key={model.name} value={`model ${model.name}`}>
                  {t('line_of_model', { name: model.name })}
                </option>
              ))}
            </select>
          </label>
          {settings.model !== '' && (
            <label>
              <input
                type="checkbox"
                checked={mirror}
                disabled={!enabled}
                onChange={(event) => set_mirror(event.currentTarget.checked)}
              />{' '}
              {t('mirror')}
            </label>
          )}
          <label>
            {t('process')}{' '}
            <select
              value={settings.process}
              disabled={!enabled}
              onChange={(event) => set_settings({ ...settings, process: event.currentTarget.value })}
            >
              <option value="">–</option>
              {(processes?.processes ?? []).map((process) => (
                <option key={process.name} value={process.name}>
                  {process.name}
                </option>
              ))}
            </select>
          </label>
          <label>
            {t('why')}{' '}
            <input
              value={why}
              maxLength={500}
              disabled={!enabled}
              onInput={(event) => set_why(event.currentTarget.value)}
            />
          </label>
          <button type="submit" class="go" disabled={!enabled || !chosen}>
            {t('work_again')}
          </button>
        </form>
      )}
    </details>
  );
}
