// SPDX-License-Identifier: MIT
// Robots and sensors: what is wrong with them, what to do, and how they went since the page was opened.
import type { JSX } from 'preact';
import { useMemo } from 'preact/hooks';
import type { Disk, Robot, Sensor } from 'openapi';
import { locale, number, t, t_or } from '../words';
import { MountedCard } from './mounted';
import { Chart, Failure, Figures, Table } from './parts';
import { use_reading, use_store } from './store';
import { upkeep_rows } from './upkeep';

const figures = [
  'frames',
  'frames_lost',
  'frames_damaged',
  'profiles',
  'profiles_dropped',
  'messages_lost',
  'poses_lost',
  'overruns',
] as const;
const flags = ['scanning', 'camera_connected', 'poses_flow', 'realtime'] as const;

function yes_no(value: unknown): string {
  return value === true ? t('yes') : value === false ? t('no') : '–';
}

export function Devices(): JSX.Element {
  const { value: robots, error: robot_error } = use_reading<{ robots: Robot[] }>('/robots');
  const { value: sensors, error: sensor_error } = use_reading<{ sensors: Sensor[]; disk: Disk }>('/sensors');
  const { health, state } = use_store();
  const curves = useMemo(
    () => ({
      x: health.map((sample) => sample.time_s),
      temperature: [
        {
          label: t('temperature'),
          values: health.map((s) => s.sensor.temperature_degc ?? null),
          colour: '--link',
        },
      ],
      lost: [
        {
          label: t('figure_frames_lost'),
          values: health.map((s) => s.sensor.frames_lost ?? null),
          colour: '--link',
        },
        {
          label: t('figure_profiles_dropped'),
          values: health.map((s) => s.sensor.profiles_dropped ?? null),
          colour: '--quiet',
          dash: [6, 4],
        },
      ],
    }),
    [health],
  );
  return (
    <>
      <h1>{t('nav_devices')}</h1>
      <Failure text={robot_error || sensor_error} />
      {(robots?.robots ?? []).map((robot) => (
        <section class="card" key={robot.name}>
          <h2>
            {t('lamp_robot')} {robot.name}
          </h2>
          {robot.words && <p class="notice look">{robot.words}</p>}
          <Figures
            rows={[
              [t('connected'), yes_no(robot.connected)],
              [t('powered'), yes_no(robot.powered)],
              [t('remote'), yes_no(robot.remote)],
              [t('serial'), robot.serial ?? '–'],
              [t('address'), robot.address ?? '–'],
            ]}
          />
        </section>
      ))}
      {robots && robots.robots.length > 0 && <MountedCard />}
      {robots && robots.robots.length === 0 && <p>{t('no_robots')}</p>}
      {(sensors?.sensors ?? []).map((sensor) => (
        <section class="card" key={sensor.name}>
          <h2>
            {t('sensor')} {sensor.name}
          </h2>
          {sensor.fault && (
            <p class="notice refused">
              {sensor.fault} {sensor.next_step && <strong>{`${t('next_step')} ${sensor.next_step}`}</strong>}
            </p>
          )}
          <Figures
            rows={[
              [t('connected'), yes_no(sensor.connected)],
              [
                t('lamp_laser'),
                `${t_or(`level_${String(sensor.laser)}`, String(sensor.laser ?? '–'))} ${String(sensor.laser_reason ?? '')}`,
              ],
              [t('temperature'), `${number(sensor.temperature_degc, 1)} °C`],
              ...flags.map(
                (name) => [t_or(`figure_${name}`, name), yes_no(sensor[name])] as [string, string],
              ),
              ...figures.map(
                (name) =>
                  [
                    t_or(`figure_${name}`, name),
                    sensor[name] === undefined ? '–' : Number(sensor[name]).toLocaleString(locale()),
                  ] as [string, string],
              ),
              ...upkeep_rows(sensor.upkeep),
              [t('version'), String(sensor.version ?? '–')],
            ]}
          />
          {(sensor.clocks ?? []).length > 0 && (
            <Table
              label={t('clocks')}
              heads={[
                t('clocks'),
                t('known'),
                `${t('offset')} [ms]`,
                `± [µs]`,
                `${t('drift')} [ppm]`,
                t('steps'),
              ]}
            >
              {sensor.clocks!.map((clock) => (
                <tr key={clock.name}>
                  <th scope="row">{clock.name}</th>
                  <td>{yes_no(clock.known)}</td>
                  <td>{number(clock.offset_ns === undefined ? null : clock.offset_ns / 1e6, 3)}</td>
                  <td>{number(clock.uncertainty_ns === undefined ? null : clock.uncertainty_ns / 1e3, 1)}</td>
                  <td>{number(clock.drift_ppm, 2)}</td>
                  <td>{clock.steps ?? '–'}</td>
                </tr>
              ))}
            </Table>
          )}
        </section>
      ))}
      {sensors && (
        <section class="card">
          <h2>{t('service')}</h2>
          <Figures
            rows={[
              [t('version'), state?.version ?? '–'],
              [
                t('disk'),
                t('disk_words', {
                  free: number(sensors.disk.free_bytes / 1e9, 1),
                  total: number(sensors.disk.total_bytes / 1e9, 1),
                }),
              ],
            ]}
          />
        </section>
      )}
      {health.length > 1 && (
        <div class="live-grid">
          <Chart label={`${t('temperature')} [°C]`} x={curves.x} curves={curves.temperature} />
          <Chart label={t('losses')} x={curves.x} curves={curves.lost} />
        </div>
      )}
    </>
  );
}
