// SPDX-License-Identifier: MIT
// Every shoe: the table with filters and trends, and one scan with the viewer.
import type { JSX } from 'preact';
import { useMemo, useState } from 'preact/hooks';
import type { File, Scan, ScanRow, Trends } from 'openapi';
import type { Hand, ResultFile } from '../viewer/view_data';
import { Viewer } from '../viewer/viewer';
import { amount, csv_style, number, t, t_or } from '../words';
import { base, file_address, query } from './api';
import { Decide } from './live';
import { Mend } from './mend';
import { use_pages } from './pages';
import { Chart, Failure, Figures, Table, Verdict, shoe_words, work_words } from './parts';
import { WorkAgain } from './rerun';
import { use_view } from './scan_view';
import { may, time_words, use_reading } from './store';

const verdicts = ['ok', 'amber', 'review', 'refused', 'failed', 'working'];

interface Filter {
  from: string;
  to: string;
  model: string;
  verdict: string;
  reason: string;
  part: string;
}

/// A day of the date field, which is the factory's; `to` is before the day behind it.
function day(text: string, end: boolean): string | undefined {
  const noon = new Date(`${text}T12:00:00Z`);
  if (!text || Number.isNaN(noon.getTime())) return undefined;
  if (end) noon.setUTCDate(noon.getUTCDate() + 1);
  return noon.toISOString().slice(0, 10);
}

export function Scans(): JSX.Element {
  const [filter, set_filter] = useState<Filter>({
    from: '',
    to: '',
    model: '',
    verdict: '',
    reason: '',
    part: '',
  });
  const asked = {
    from: day(filter.from, false),
    to: day(filter.to, true),
    model: filter.model,
    verdict: filter.verdict,
    reason_code: filter.reason,
    // What is typed of it so far finds it already.
    part: filter.part && `${filter.part}*`,
  };
  const { read, rows, error, load } = use_pages<ScanRow>('/scans', asked, (scan) => scan.id);
  const field = (name: keyof Filter) => ({
    value: filter[name],
    onInput: (event: { currentTarget: { value: string } }) =>
      set_filter({ ...filter, [name]: event.currentTarget.value }),
  });
  return (
    <>
      <h1>{t('nav_scans')}</h1>
      <form class="tools" onSubmit={(event) => event.preventDefault()}>
        <label>
          {t('from')} <input type="date" {...field('from')} />
        </label>
        <label>
          {t('to')} <input type="date" {...field('to')} />
        </label>
        <label>
          {t('model')} <input {...field('model')} maxLength={64} size={12} />
        </label>
        <label>
          {t('part')} <input {...field('part')} maxLength={64} size={12} />
        </label>
        <label>
          {t('verdict')}{' '}
          <select {...field('verdict')}>
            <option value="">{t('all')}</option>
            {verdicts.map((name) => (
              <option key={name} value={name}>
                {t_or(`verdict_${name}`, name)}
              </option>
            ))}
          </select>
        </label>
        <ReasonChoice from={asked.from} to={asked.to} field={field('reason')} />
        <a
          class="button"
          href={`${base}/history.csv${query({ from: asked.from, to: asked.to, model: asked.model, part: asked.part, ...csv_style() })}`}
          download="history.csv"
        >
          {t('csv')}
        </a>
      </form>
      <Failure text={error} />
      {read && rows.length === 0 && <p>{t('no_scans')}</p>}
      {rows.length > 0 && (
        <Table
          label={t('nav_scans')}
          heads={[
            t('scan'),
            t('time'),
            t('verdict'),
            t('decision'),
            t('model'),
            t('shoe'),
            t('reason'),
            t('length'),
            'U95',
            t('weak_stretches'),
            t('cycle'),
            t('operator'),
          ]}
        >
          {rows.map((scan) => (
            <tr key={scan.id}>
              <th scope="row">
                <a href={`#/scans/${scan.id}`}>{scan.id}</a>
              </th>
              <td>{time_words(scan.time)}</td>
              <td>
                <Verdict scan={scan} />
              </td>
              <td>{t_or(`decision_${scan.decision}`, scan.decision)}</td>
              <td>{scan.model ?? '–'}</td>
              <td>{shoe_words(scan)}</td>
              <td>{scan.reason_code ? t_or(`reason_${scan.reason_code}`, scan.reason_code) : '–'}</td>
              <td>{amount(scan.length_mm, 'mm', 1)}</td>
              <td>{amount(scan.u95_mm, 'mm', 2)}</td>
              <td>{scan.weak_stretches ?? '–'}</td>
              <td>{amount(scan.cycle_s, 's', 1)}</td>
              <td>{scan.operator ?? '–'}</td>
            </tr>
          ))}
        </Table>
      )}
      {load && (
        <button type="button" onClick={() => void load()}>
          {t('more')}
        </button>
      )}
      <TrendView from={asked.from} to={asked.to} model={asked.model} />
    </>
  );
}

/// The reasons that shoes of these days were ended by, the most frequent first.
function ReasonChoice(props: {
  from?: string;
  to?: string;
  field: { value: string; onInput: (event: { currentTarget: { value: string } }) => void };
}): JSX.Element {
  const { from, to } = props;
  const { value } = use_reading<Trends>(`/history/trends${query({ from, to, bucket: 'day' })}`);
  const codes = (value?.reasons ?? []).map((row) => row.reason_code);
  const chosen = props.field.value;
  return (
    <label>
      {t('reason')}{' '}
      <select {...props.field}>
        <option value="">{t('all')}</option>
        {[...codes, ...(chosen && !codes.includes(chosen) ? [chosen] : [])].map((code) => (
          <option key={code} value={code}>
            {t_or(`reason_${code}`, code)}
          </option>
        ))}
      </select>
    </label>
  );
}

function TrendView(props: { from?: string; to?: string; model: string }): JSX.Element | null {
  const [bucket, set_bucket] = useState('day');
  const { value, error } = use_reading<Trends>(`/history/trends${query({ ...props, bucket })}`);
  const charts = useMemo(() => {
    if (!value) return null;
    const x = value.buckets.map((b) => Date.parse(b.time) / 1000);
    const share = value.buckets.map((b) => (b.scans > 0 ? (100 * (b.ok + b.amber)) / b.scans : null));
    return {
      x,
      pass: [{ label: t('pass_rate'), values: share, colour: '--link' }],
      u95: [{ label: 'U95', values: value.buckets.map((b) => b.u95_mm ?? null), colour: '--link' }],
      cycle: [{ label: t('cycle'), values: value.buckets.map((b) => b.cycle_s ?? null), colour: '--link' }],
    };
  }, [value]);
  const capability = value?.capability;
  const places = useMemo(() => {
    if (!capability?.pp) return null;
    return {
      x: capability.pp.map((_, i) => i + 1),
      curves: [
        { label: 'Pp', values: capability.pp, colour: '--quiet', dash: [6, 4] },
        { label: 'Ppk', values: capability.ppk ?? [], colour: '--link' },
      ],
    };
  }, [capability]);
  if (error) return <Failure text={error} />;
  if (!value || !charts) return null;
  const total = value.buckets.reduce((sum, b) => sum + b.scans, 0);
  const good = value.buckets.reduce((sum, b) => sum + b.ok + b.amber, 0);
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
      <p>{t('trend_words', { scans: total, share: total > 0 ? number((100 * good) / total, 1) : '–' })}</p>
      {total > 0 && (
        <div class="live-grid">
          <Chart label={`${t('pass_rate')} [%]`} x={charts.x} curves={charts.pass} />
          <Chart label={t('u95_trend')} x={charts.x} curves={charts.u95} />
          <Chart label={`${t('cycle')} [s]`} x={charts.x} curves={charts.cycle} />
          {places && capability && (
            <Chart
              label={t('capability', {
                model: capability.model ?? '',
                tolerance: number(capability.tolerance_mm, 2),
                scans: capability.scans ?? 0,
              })}
              x={places.x}
              curves={places.curves}
              is_time={false}
            />
          )}
        </div>
      )}
      {value.ended_by && <p>{t('trend_ended', { ...value.ended_by })}</p>}
      {value.reasons.length > 0 && (
        <Table label={t('reasons')} heads={[t('reason'), t('ended_by'), t('count')]}>
          {value.reasons.map((row) => (
            <tr key={row.reason_code}>
              <th scope="row">{t_or(`reason_${row.reason_code}`, row.reason_code)}</th>
              <td>{row.ended_by ? t_or(`ended_${row.ended_by}`, row.ended_by) : '–'}</td>
              <td>{row.scans}</td>
            </tr>
          ))}
        </Table>
      )}
    </section>
  );
}

/// How the tool pressed: mean, least and largest force, and which share of it was as it should be.
function force_words(follow: Scan['follow']): string | null {
  const force = follow?.['force'] as Record<string, number> | undefined;
  if (!force) return null;
  const { mean_n, least_n, largest_n, within, band_percent, set_n } = force;
  return `Ø ${number(mean_n, 1)} N (${number(least_n, 1)} … ${number(largest_n, 1)} N); ${number(
    within === undefined ? undefined : 100 * within,
    1,
  )} %: ${number(set_n, 1)} N ± ${number(band_percent, 0)} %`;
}

export function OneScan({ id }: { id: string }): JSX.Element {
  const { value: scan, error } = use_reading<Scan>(`/scans/${id}`);
  const { value: listed } = use_reading<{ files: File[] }>(`/scans/${id}/files`);
  const finished = scan !== null && scan.verdict !== 'working';
  const pressed = force_words(scan?.follow ?? null);
  return (
    <>
      <h1>{id}</h1>
      <Failure text={error} />
      {scan && (
        <>
          <p
            class={`notice ${scan.verdict === 'amber' || scan.verdict === 'review' ? 'look' : scan.verdict === 'ok' ? 'good' : scan.verdict === 'working' ? '' : 'refused'}`}
          >
            <Verdict scan={scan} /> {scan.reason ?? ''}{' '}
            {scan.next_step && <strong>{`${t('next_step')} ${scan.next_step}`}</strong>}
          </p>
          <Decide scan={scan} />
          {finished && <ScanView scan={scan} files={listed?.files ?? []} />}
          <Figures
            rows={[
              [t('time'), time_words(scan.time)],
              [
                t('decision'),
                `${t_or(`decision_${scan.decision}`, scan.decision)}${scan.decided_by ? `, ${scan.decided_by}` : ''}${scan.why ? `: ${scan.why}` : ''}`,
              ],
              [t('model'), scan.model ?? '–'],
              [t('shoe'), shoe_words(scan)],
              [t('process'), scan.process ?? '–'],
              [t('length'), amount(scan.length_mm, 'mm', 1)],
              [t('colour_confidence'), number(scan.confidence, 2)],
              [t('u95_line'), amount(scan.u95_mm, 'mm', 2)],
              [t('tip_bound'), amount(scan.tip_bound_mm, 'mm', 2)],
              [
                t('followed'),
                scan.followed === true
                  ? t('yes')
                  : scan.followed === false
                    ? t('not_to_end')
                    : scan.sent
                      ? t('sent')
                      : t('no'),
              ],
              ...(pressed ? [[t('field_force'), pressed] as [string, string]] : []),
              ...(scan.work ? [[t('work'), work_words(scan.work)] as [string, string]] : []),
              ...(scan.follows ? [[t('same_shoe_as'), scan.follows] as [string, string]] : []),
              [
                t('times'),
                `${t('scan')} ${number(scan.scan_s, 1)} s, ${t('layer_line')} ${number(scan.line_s, 2)} s, ${t('cycle')} ${number(scan.cycle_s, 1)} s`,
              ],
              [t('operator'), scan.operator ?? '–'],
              [t('versions'), `${scan.version ?? '–'}, ${t('layer_line')} ${scan.line_version ?? 0}`],
            ]}
          />
          <button type="button" onClick={() => window.print()}>
            {t('print')}
          </button>
          {finished && <WorkAgain scan={scan} />}
          {finished && <Stages scan={scan} files={listed?.files ?? []} />}
        </>
      )}
    </>
  );
}

const named = [
  'line.csv',
  'cloud.ply',
  'report.json',
  'path/path.csv',
  'path/path.script',
  'path/tracking.html',
  'gate.json',
  'followed.json',
  'track.csv',
];

export function ScanView({ scan, files }: { scan: Scan; files: File[] }): JSX.Element {
  const { data, error } = use_view(scan.id, scan.line_version);
  const shown: ResultFile[] = files
    .filter((file) => named.includes(file.path))
    .map((file) => ({ file: file.path, words: file.path, bytes: file.bytes }));
  const [other, set_other] = useState('');
  const { value: others } = use_reading<{ scans: ScanRow[] }>('/scans?limit=100');
  const compared = use_view(other || null, 0);
  const beside = useMemo(
    () => (other && compared.data ? { name: other, data: compared.data } : null),
    [other, compared.data],
  );
  const [hand, set_hand] = useState<Hand | null>(null);
  return (
    <>
      <h2>{t('in_3d')}</h2>
      <Failure text={error} />
      <Failure text={compared.error} />
      {data && (
        <Viewer
          hand={data.line && may('operator') ? set_hand : undefined}
          other={beside}
          key={`${scan.id} ${scan.line_version ?? 0}`}
          data={data}
          files={shown}
          file_base={`${base}/scans/${scan.id}/files/`}
          told
        />
      )}
      {data?.line && <Mend scan={scan} data={data} hand={hand} />}
      {data?.line && (
        <label>
          {t('compare')}{' '}
          <select value={other} onChange={(e) => set_other(e.currentTarget.value)}>
            <option value="">–</option>
            {(others?.scans ?? [])
              .filter((row) => row.id !== scan.id && (row.verdict === 'ok' || row.verdict === 'amber'))
              .map((row) => (
                <option key={row.id} value={row.id}>
                  {row.id}, {time_words(row.time)}
                </option>
              ))}
          </select>
        </label>
      )}
    </>
  );
}

/// The pictures of each step, where somebody wants to know how the line was found.
function Stages({ scan, files }: { scan: Scan; files: File[] }): JSX.Element | null {
  const stages = files.filter((file) => /^stages\/.*\.png$/.test(file.path));
  if (stages.length === 0) return null;
  return (
    <details>
      <summary>{t('stages')}</summary>
      {stages.map((file) => (
        <figure key={file.path} class="card">
          <img src={file_address(scan.id, file.path)} alt={file.path} loading="lazy" />
          <figcaption>{file.path}</figcaption>
        </figure>
      ))}
    </details>
  );
}
