// SPDX-License-Identifier: MIT
// What each gate of the line measured, and how far that is from its limit; the least sure first.
import type { JSX } from 'preact';
import { number, t, t_or } from '../words';
import type { Gate } from './view_data';

/// A value with the unit at the end of its measure's name.
function with_unit(measure: string, value: number): string {
  if (measure.endsWith('_mm')) return `${number(value, 1)} mm`;
  if (measure.endsWith('_deg')) return `${number(value, 1)}°`;
  if (measure.endsWith('_share')) return `${number(100 * value, 0)} %`;
  return number(value, 2);
}

function limit_words(gate: Gate): string {
  return gate.at_most !== undefined
    ? t('gate_at_most', { limit: with_unit(gate.measure, gate.at_most) })
    : t('gate_at_least', { limit: with_unit(gate.measure, gate.at_least ?? 0) });
}

/// In one line: what was measured, and its limit.
export function gate_words(gate: Gate): string {
  return `${t_or(`gate_${gate.measure}`, gate.measure)}: ${with_unit(gate.measure, gate.value)} (${limit_words(gate)})`;
}

/// Those that say no: of the reason that was told first, then the worst first.
export function failed_gates(gates: Gate[], reason_code?: string | null): Gate[] {
  const told = (gate: Gate) => (gate.reason_code === reason_code ? 0 : 1);
  return gates.filter((gate) => !(gate.sure >= 0.5)).sort((a, b) => told(a) - told(b) || a.sure - b.sure);
}

export function Gates({ gates }: { gates: Gate[] }): JSX.Element {
  const sorted = [...gates].sort((a, b) => a.sure - b.sure);
  return (
    <section class="scroll" tabIndex={0} aria-label={t('gates')}>
      <table class="gates">
        <thead>
          <tr>
            <th scope="col">{t('gates')}</th>
            <th scope="col">{t('gate_value')}</th>
            <th scope="col">{t('gate_limit')}</th>
          </tr>
        </thead>
        <tbody>
          {sorted.map((gate) => (
            <tr key={gate.measure} class={gate.sure >= 0.5 ? '' : 'fails'}>
              <th scope="row">
                <span aria-hidden="true">{gate.sure >= 0.5 ? '✔' : '✖'}</span>{' '}
                {t_or(`gate_${gate.measure}`, gate.measure)}
              </th>
              <td>{with_unit(gate.measure, gate.value)}</td>
              <td>{limit_words(gate)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}
