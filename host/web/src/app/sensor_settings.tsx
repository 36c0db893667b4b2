// SPDX-License-Identifier: MIT
// What the sensor runs with: each setting with range and meaning, changed together, read back.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { Setting } from 'openapi';
import { locale, t, t_or } from '../words';
import { Refused, call } from './api';
import { Table } from './parts';
import { act, holds_control, may, use_store, words_of } from './store';

type Value = Setting['now'];

/// What the makers of profile sensors call it: Gocator; SICK Ranger3 and Ruler3; AT's C5 and C6.
const other_names: Record<string, string> = {
  'camera.exposure_us': 'Gocator: Exposure; SICK, AT: ExposureTime',
  'camera.rate_hz': 'Gocator: Frame Rate; SICK: AcquisitionLineRate; AT: AcquisitionFrameRate',
  'camera.gain': 'SICK, AT: Gain',
  'camera.second_exposure_us': 'Gocator: Multiple Exposure',
  'camera.auto_exposure': 'Gocator: Dynamic Exposure',
  'camera.follow_stripe': 'AT: AoiTracking',
  'camera.test_pattern': 'SICK, AT: TestPattern',
  'region.left_px': 'Gocator: Active Area; SICK, AT: OffsetX',
  'region.top_px': 'Gocator: Active Area; SICK, AT: OffsetY',
  'region.width_px': 'Gocator: Active Area; SICK, AT: Width',
  'region.height_px': 'Gocator: Active Area; SICK, AT: Height',
  'peaks.mode': 'AT: MAX, TRSH, COG, FIR-PEAK',
  'peaks.choice': 'Gocator: Spot Selection; SICK: SearchMode3D',
  'peaks.threshold_grey': 'Gocator: Spot Threshold; SICK: DetectionThreshold; AT: AoiThreshold',
  'peaks.width_min_px': 'Gocator: Spot Width Min',
  'peaks.width_max_px': 'Gocator: Spot Width Max',
};

const name_of = (key: string) => t_or(`key_${key}`, key);

function Entry(props: {
  row: Setting;
  value: Value;
  disabled: boolean;
  change: (value: Value) => void;
}): JSX.Element {
  const { row, value, disabled } = props;
  const name = name_of(row.key);
  if (row.kind === 'on_off')
    return (
      <input
        type="checkbox"
        aria-label={name}
        disabled={disabled}
        checked={value === true}
        onChange={(e) => props.change(e.currentTarget.checked)}
      />
    );
  if (row.kind === 'word')
    return (
      <select
        aria-label={name}
        disabled={disabled}
        value={String(value ?? '')}
        onChange={(e) => props.change(e.currentTarget.value)}
      >
        {(row.words ?? []).map((word) => (
          <option key={word} value={word}>
            {word}
          </option>
        ))}
      </select>
    );
  return (
    <span class="with-unit">
      <input
        type="number"
        aria-label={name}
        disabled={disabled}
        step={row.kind === 'whole' ? 1 : 'any'}
        min={row.range?.[0]}
        max={row.range?.[1]}
        placeholder={value === null ? row.value : ''}
        value={typeof value === 'number' ? value : ''}
        onInput={(e) => props.change(e.currentTarget.value === '' ? null : Number(e.currentTarget.value))}
      />{' '}
      {row.unit}
    </span>
  );
}

function allowed(row: Setting): string {
  if (row.range) {
    const [least, most] = row.range.map((end) => end.toLocaleString(locale()));
    return `${least} – ${most} ${row.unit}`;
  }
  return (row.words ?? [t('on'), t('off')]).join(', ');
}

export function SensorSettings({ rows }: { rows: Setting[] }): JSX.Element {
  use_store();
  const [typed, set_typed] = useState<Record<string, Value>>({});
  const [busy, set_busy] = useState(false);
  const [refused, set_refused] = useState('');
  /// What was asked last and came back otherwise: a camera takes what its own steps allow.
  const [asked, set_asked] = useState<Record<string, Value>>({});
  const engineer = may('engineer');
  const free = engineer && holds_control() && !busy;
  const changed = rows.filter((row) => row.key in typed && typed[row.key] !== row.now);
  const other = rows.filter(
    (row) => row.key in asked && asked[row.key] !== null && asked[row.key] !== row.now,
  );
  const send = async () => {
    set_busy(true);
    set_refused('');
    const settings = Object.fromEntries(changed.map((row) => [row.key, typed[row.key]!]));
    const done = await act(t('settings_taken'), async () => {
      try {
        await call('PATCH', '/sensors/settings', { settings });
      } catch (error) {
        set_refused(error instanceof Refused && error.code === 'refused' ? error.message : words_of(error));
        throw error;
      }
    });
    if (done) {
      set_asked(settings);
      set_typed({});
    }
    set_busy(false);
  };
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        void send();
      }}
    >
      {!engineer && <p class="quiet">{t('settings_engineer')}</p>}
      {engineer && !holds_control() && <p class="quiet">{t('settings_control')}</p>}
      <Table
        label={t('settings_in_use')}
        heads={[t('setting'), t('new_value'), t('in_use'), t('allowed'), t('what_it_does'), t('elsewhere')]}
      >
        {rows.map((row) => (
          <tr key={row.key} class={changed.includes(row) ? 'changed' : ''}>
            <th scope="row">
              {name_of(row.key)}
              <br />
              <code>{row.key}</code>
            </th>
            <td>
              <Entry
                row={row}
                value={row.key in typed ? typed[row.key]! : row.now}
                disabled={!free}
                change={(value) => set_typed({ ...typed, [row.key]: value })}
              />
            </td>
            <td>{row.kind === 'on_off' && row.now !== null ? t(row.now ? 'on' : 'off') : row.value}</td>
            <td>{allowed(row)}</td>
            <td class="long">{t_or(`what_${row.key}`, row.what)}</td>
            <td class="long">{other_names[row.key] ?? ''}</td>
          </tr>
        ))}
      </Table>
      {refused && (
        <p class="notice refused" role="alert">
          ✖ {t('settings_kept')} {refused}
        </p>
      )}
      {other.map((row) => (
        <p class="notice look" key={row.key}>
          {t('settings_other', { name: name_of(row.key), asked: String(asked[row.key]), taken: row.value })}
        </p>
      ))}
      <p>
        <button type="submit" class="go" disabled={!free || changed.length === 0}>
          {t('settings_send', { count: changed.length })}
        </button>{' '}
        <button type="button" disabled={busy || changed.length === 0} onClick={() => set_typed({})}>
          {t('settings_forget')}
        </button>
      </p>
    </form>
  );
}
