// SPDX-License-Identifier: MIT
// The page at the factory's centre: all cells, what calls for a person, history, releases, recordings.
import type { JSX } from 'preact';
import { useEffect, useMemo, useState } from 'preact/hooks';
import type {
  FleetAlarm,
  FleetCell,
  FleetFetch,
  FleetGroup,
  FleetOdd,
  FleetRelease,
  ScanRow,
  Trends,
} from 'openapi';
import { type Word, amount, number, t, t_or } from '../words';
import { call, query } from './api';
import { use_pages } from './pages';
import { Chart, Failure, Table, Verdict, shoe_words, work_words } from './parts';
import { act, may, read_state, time_words, use_reading, use_store } from './store';

export const fleet_views = ['cells', 'shoes', 'releases', 'people', 'log'] as const;

const again_ms = 5000;

/// This page is the centre's: its index.html says so.  It has no Stop, since nothing here reaches an arm.
export const at_centre = document.querySelector('meta[name="biteline-centre"]') !== null;

export function FleetPage({ view, cell }: { view: string; cell: string | undefined }): JSX.Element {
  // What stands here is read again every few seconds: the centre sends no events.
  useEffect(() => {
    const timer = setInterval(() => void read_state(), again_ms);
    return () => clearInterval(timer);
  }, []);
  const { centre } = use_store();
  return (
    <>
      {centre && !centre.database && (
        <p class="notice refused" role="alert">
          {t('database_lost')}
        </p>
      )}
      <View view={view} cell={cell} />
    </>
  );
}

function View({ view, cell }: { view: string; cell: string | undefined }): JSX.Element | null {
  if (view === 'cells') return <Cells />;
  if (view === 'shoes') return <Shoes key={cell ?? ''} first_cell={cell ?? ''} />;
  if (view === 'releases') return <Releases />;
  return null;
}

function percent(part: number, whole: number): string {
  return whole > 0 ? `${number((100 * part) / whole, 1)} %` : '–';
}

function alarm_words(alarm: FleetAlarm): string {
  const cell = alarm.cell ?? '';
  const value =
    alarm.code === 'many_refused'
      ? number(100 * alarm.value, 0)
      : number(alarm.value, alarm.code === 'odd_cell' ? 2 : 0);
  return t(`alarm_${alarm.code}` as Word, { cell, model: alarm.model ?? '', value });
}

function Alarms(): JSX.Element {
  const { value, error } = use_reading<{ alarms: FleetAlarm[] }>('/fleet/alarms');
  return (
    <section aria-live="polite">
      <h2>{t('alarms')}</h2>
      <Failure text={error} />
      {value?.alarms.length === 0 && (
        <p class="notice good">
          <span aria-hidden="true">✔</span> {t('no_alarms')}
        </p>
      )}
      {value?.alarms.map((alarm) => (
        <p key={`${alarm.code} ${alarm.cell} ${alarm.model}`} class="notice look">
          <span aria-hidden="true">▲</span> {alarm_words(alarm)}
        </p>
      ))}
    </section>
  );
}

function Cells(): JSX.Element {
  const { value, error } = use_reading<{ cells: FleetCell[] }>('/fleet/cells');
  return (
    <>
      <h1>{t('nav_cells')}</h1>
      <Alarms />
      <h2>{t('health')}</h2>
      <Failure text={error} />
      {value?.cells.length === 0 && <p>{t('no_cells')}</p>}
      {value && value.cells.length > 0 && (
        <Table
          label={t('nav_cells')}
          heads={[
            t('cell'),
            t('state'),
            t('heard'),
            t('waits_for_centre'),
            t('shoes'),
            t('pass_rate'),
            t('verdict_refused'),
            t('last_shoe'),
            t('version'),
          ]}
        >
          {value.cells.map((cell) => (
            <tr key={cell.cell}>
              <th scope="row">
                <a href={`#/shoes/${cell.cell}`}>{cell.cell}</a>
              </th>
              <td>
                <span class={`verdict ${cell.online ? 'ok' : 'refused'}`}>
                  <span aria-hidden="true">{cell.online ? '✔' : '✖'}</span>{' '}
                  {t(cell.online ? 'cell_online' : 'cell_away')}
                </span>
              </td>
              <td>{time_words(cell.heard)}</td>
              <td>{cell.waiting}</td>
              <td>{cell.scans}</td>
              <td>{percent(cell.ok + cell.amber, cell.scans)}</td>
              <td>{cell.refused}</td>
              <td>{time_words(cell.last)}</td>
              <td>{cell.version}</td>
            </tr>
          ))}
        </Table>
      )}
      <OddCells />
      <Groups />
    </>
  );
}

function OddCells(): JSX.Element | null {
  const { value } = use_reading<{ odd: FleetOdd[] }>('/fleet/odd');
  if (!value) return null;
  return (
    <section>
      <h2>{t('odd_cell')}</h2>
      {value.odd.length === 0 && <p>{t('no_odd_cell')}</p>}
      {value.odd.length > 0 && (
        <Table
          label={t('odd_cell')}
          heads={[
            t('cell'),
            t('model'),
            t('odd_difference'),
            t('by_how_much'),
            'U95',
            t('shoes'),
            t('since'),
          ]}
        >
          {value.odd.map((one) => (
            <tr key={`${one.cell} ${one.model}`}>
              <th scope="row">{one.cell}</th>
              <td>{one.model}</td>
              <td>{t_or(`odd_${one.difference.replaceAll(' ', '_')}`, one.difference)}</td>
              <td>{amount(one.mm, 'mm', 2)}</td>
              <td>{amount(one.u95_mm, 'mm', 2)}</td>
              <td>{one.scans}</td>
              <td>{one.since}</td>
            </tr>
          ))}
        </Table>
      )}
    </section>
  );
}

/// Each model in each cell: where one cell does worse, it stands beside the others.
function Groups(): JSX.Element | null {
  const { value, error } = use_reading<{ groups: FleetGroup[] }>('/fleet/groups');
  if (error) return <Failure text={error} />;
  if (!value || value.groups.length === 0) return null;
  return (
    <section>
      <h2>{t('by_model_and_cell')}</h2>
      <Table
        label={t('by_model_and_cell')}
        heads={[
          t('model'),
          t('cell'),
          t('shoes'),
          t('pass_rate'),
          t('verdict_refused'),
          t('length'),
          'U95',
          t('cycle'),
        ]}
      >
        {value.groups.map((group) => (
          <tr key={`${group.model} ${group.cell}`}>
            <th scope="row">{group.model ?? t('no_model')}</th>
            <td>{group.cell}</td>
            <td>{group.scans}</td>
            <td>{percent(group.ok + group.amber, group.scans)}</td>
            <td>{group.refused}</td>
            <td>{amount(group.length_mm, 'mm', 1)}</td>
            <td>{amount(group.u95_mm, 'mm', 2)}</td>
            <td>{amount(group.cycle_s, 's', 1)}</td>
          </tr>
        ))}
      </Table>
    </section>
  );
}

interface FleetShoe extends ScanRow {
  cell: string;
  release: string | null;
}

function Shoes({ first_cell }: { first_cell: string }): JSX.Element {
  const [cell, set_cell] = useState(first_cell);
  const [model, set_model] = useState('');
  const [part, set_part] = useState('');
  const key_of = (shoe: FleetShoe) => `${shoe.cell} ${shoe.id} ${shoe.time}`;
  const { read, rows, error, load } = use_pages<FleetShoe>(
    '/fleet/scans',
    { cell, model, part: part && `${part}*` },
    key_of,
  );
  const fetch_it = (shoe: FleetShoe) =>
    act(t('done_fetch', { scan: `${shoe.cell}/${shoe.id}` }), () =>
      call('POST', '/fleet/fetches', { cell: shoe.cell, scan: shoe.id }),
    );
  return (
    <>
      <h1>{t('nav_shoes')}</h1>
      <form class="tools" onSubmit={(event) => event.preventDefault()}>
        <label>
          {t('cell')}{' '}
          <input value={cell} maxLength={64} size={12} onInput={(e) => set_cell(e.currentTarget.value)} />
        </label>
        <label>
          {t('model')}{' '}
          <input value={model} maxLength={64} size={12} onInput={(e) => set_model(e.currentTarget.value)} />
        </label>
        <label>
          {t('part')}{' '}
          <input value={part} maxLength={64} size={12} onInput={(e) => set_part(e.currentTarget.value)} />
        </label>
      </form>
      <FleetTrends cell={cell} model={model} />
      <Fetches />
      <h2>{t('shoes')}</h2>
      <Failure text={error} />
      {read && rows.length === 0 && <p>{t('no_scans')}</p>}
      {rows.length > 0 && (
        <Table
          label={t('shoes')}
          heads={[
            t('cell'),
            t('scan'),
            t('time'),
            t('verdict'),
            t('decision'),
            t('model'),
            t('shoe'),
            t('reason'),
            t('work'),
            t('length'),
            'U95',
            t('cycle'),
            t('recording'),
          ]}
        >
          {rows.map((shoe) => (
            <tr key={key_of(shoe)}>
              <th scope="row">{shoe.cell}</th>
              <td>{shoe.id}</td>
              <td>{time_words(shoe.time)}</td>
              <td>
                <Verdict scan={shoe} />
              </td>
              <td>{t_or(`decision_${shoe.decision}`, shoe.decision)}</td>
              <td>{shoe.model ?? '–'}</td>
              <td>{shoe_words(shoe)}</td>
              <td>
                {shoe.reason_code
                  ? t_or(`reason_${shoe.reason_code}`, shoe.reason_code)
                  : (shoe.reason ?? '–')}
              </td>
              <td>{shoe.work ? work_words(shoe.work) : '–'}</td>
              <td>{amount(shoe.length_mm, 'mm', 1)}</td>
              <td>{amount(shoe.u95_mm, 'mm', 2)}</td>
              <td>{amount(shoe.cycle_s, 's', 1)}</td>
              <td>
                <button
                  type="button"
                  disabled={!may('engineer')}
                  aria-label={`${t('fetch')} ${shoe.cell}/${shoe.id}`}
                  onClick={() => void fetch_it(shoe)}
                >
                  {t('fetch')}
                </button>
              </td>
            </tr>
          ))}
        </Table>
      )}
      {load && (
        <button type="button" onClick={() => void load()}>
          {t('more')}
        </button>
      )}
    </>
  );
}

function FleetTrends(props: { cell: string; model: string }): JSX.Element | null {
  const [bucket, set_bucket] = useState('day');
  const { value, error } = use_reading<Trends>(`/fleet/trends${query({ ...props, bucket })}`);
  const charts = useMemo(() => {
    if (!value) return null;
    const of = (values: (number | null)[], label: string) => [{ label, values, colour: '--link' }];
    return {
      x: value.buckets.map((one) => Date.parse(one.time) / 1000),
      pass: of(
        value.buckets.map((one) => (one.scans > 0 ? (100 * (one.ok + one.amber)) / one.scans : null)),
        t('pass_rate'),
      ),
      u95: of(
        value.buckets.map((one) => one.u95_mm ?? null),
        'U95',
      ),
      cycle: of(
        value.buckets.map((one) => one.cycle_s ?? null),
        t('cycle'),
      ),
    };
  }, [value]);
  if (error) return <Failure text={error} />;
  if (!value || !charts || value.buckets.length === 0) return null;
  return (
    <section>
      <h2>{t('trends')}</h2>
      <label>
        {t('per')}{' '}
        <select value={bucket} onChange={(e) => set_bucket(e.currentTarget.value)}>
          {['hour', 'day', 'week'].map((name) => (
            <option key={name} value={name}>
              {t_or(`per_${name}`, name)}
            </option>
          ))}
        </select>
      </label>
      <div class="live-grid">
        <Chart label={`${t('pass_rate')} [%]`} x={charts.x} curves={charts.pass} />
        <Chart label={t('u95_trend')} x={charts.x} curves={charts.u95} />
        <Chart label={`${t('cycle')} [s]`} x={charts.x} curves={charts.cycle} />
      </div>
    </section>
  );
}

function Fetches(): JSX.Element | null {
  const { value } = use_reading<{ fetches: FleetFetch[] }>('/fleet/fetches');
  if (!value || value.fetches.length === 0) return null;
  return (
    <section>
      <h2>{t('recordings')}</h2>
      <Table
        label={t('recordings')}
        heads={[t('cell'), t('scan'), t('state'), t('bytes'), t('words'), t('fetch_stay')]}
      >
        {value.fetches.slice(0, 20).map((one) => (
          <tr key={one.number}>
            <th scope="row">{one.cell}</th>
            <td>{one.scan}</td>
            <td>{t(one.marked && one.state === 'whole' ? 'fetch_marked' : `fetch_${one.state}`)}</td>
            <td>{one.total > 0 ? percent(one.have, one.total) : '–'}</td>
            <td>{one.words ?? '–'}</td>
            <td>{one.state === 'whole' && <KeepRecording one={one} />}</td>
          </tr>
        ))}
      </Table>
    </section>
  );
}

function KeepRecording({ one }: { one: FleetFetch }): JSX.Element {
  const scan = `${one.cell}/${one.scan}`;
  const does = t(one.marked ? 'fetch_let_go' : 'fetch_keep');
  const mark = () =>
    act(t(one.marked ? 'done_let_go' : 'done_keep', { scan }), () =>
      call('POST', '/fleet/marks', { cell: one.cell, scan: one.scan, marked: !one.marked }),
    );
  return (
    <button
      type="button"
      disabled={!may('engineer')}
      aria-label={`${does} ${scan}`}
      onClick={() => void mark()}
    >
      {does}
    </button>
  );
}

function Releases(): JSX.Element {
  const { value, error } = use_reading<{ releases: FleetRelease[] }>('/fleet/releases');
  return (
    <>
      <h1>{t('nav_releases')}</h1>
      <p>{t('releases_words')}</p>
      <Failure text={error} />
      {value?.releases.length === 0 && <p>{t('no_releases')}</p>}
      {value?.releases.map((release) => (
        <section key={release.number}>
          <h2>
            {release.number}: {release.name}
          </h2>
          <p>
            {number(release.bytes / 1e6, 1)} MB, SHA-256 <code>{release.sha256.slice(0, 16)}…</code>
          </p>
          <Table label={release.name} heads={[t('cell'), t('state'), t('in_force'), t('words')]}>
            {release.cells.map((one) => (
              <tr key={one.cell}>
                <th scope="row">{one.cell}</th>
                <td>
                  <span class={`verdict ${one.ready ? 'ok' : 'amber'}`}>
                    <span aria-hidden="true">{one.ready ? '✔' : '▲'}</span>{' '}
                    {t(one.ready ? 'ready' : 'not_ready')}
                  </span>
                </td>
                <td>{t(one.in_force ? 'yes' : 'no')}</td>
                <td>{one.why ?? '–'}</td>
              </tr>
            ))}
          </Table>
        </section>
      ))}
    </>
  );
}
