// SPDX-License-Identifier: MIT
// The cell's lamps in one row; the words of one stand below: of the worst, or of the one that was tapped.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { State } from 'openapi';
import { t, t_or } from '../words';

export const lamp_signs: Record<string, string> = {
  ok: '●',
  warning: '▲',
  fault: '✖',
  off: '○',
  unknown: '?',
};
const order = ['laser', 'camera', 'robot', 'poses', 'clock'] as const;
type Lamp = State['lamps'];
const worst_first = ['fault', 'warning', 'unknown'];

/// The lamps that this cell has, in their order.
export function lamps_of(lamps: Lamp): (keyof Lamp)[] {
  const more = (['work', 'centre'] as const).filter((name) => lamps[name]);
  return [...order, ...more];
}

/// What a lamp says.  A reason from the sensor, the controller or the centre stands as it was told, in English.
export function LampWords({ lamp }: { lamp: Lamp[keyof Lamp] }): JSX.Element {
  if (!lamp?.code) return <span lang="en">{lamp?.words ?? ''}</span>;
  return (
    <>
      {t_or(`lamp_said_${lamp.code}`, lamp.words)}
      {lamp.detail && (
        <>
          : <span lang="en">{lamp.detail}</span>
        </>
      )}
    </>
  );
}

export function Lamps({ lamps }: { lamps: Lamp }): JSX.Element {
  const [asked, set_asked] = useState<keyof Lamp | null>(null);
  const names = lamps_of(lamps);
  const level = (name: keyof Lamp) => lamps[name]?.level ?? 'unknown';
  const worst = worst_first.flatMap((bad) => names.filter((name) => level(name) === bad))[0] ?? null;
  const told = asked ?? worst;
  return (
    <section class="lamp-row" aria-label={t('lamps')}>
      <div class="tools">
        {names.map((name) => (
          <button
            type="button"
            key={name}
            class={`lamp ${level(name)}`}
            aria-pressed={told === name}
            onClick={() => set_asked(name)}
          >
            <span aria-hidden="true">{lamp_signs[level(name)] ?? '?'}</span> {t_or(`lamp_${name}`, name)}
            <span class="unseen">: {t_or(`level_${level(name)}`, level(name))}</span>
          </button>
        ))}
      </div>
      {told && (
        <p aria-live="polite">
          <strong>{t_or(`lamp_${told}`, told)}</strong>: {t_or(`level_${level(told)}`, level(told))},{' '}
          <LampWords lamp={lamps[told]} />
        </p>
      )}
    </section>
  );
}
