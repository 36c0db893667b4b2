// SPDX-License-Identifier: MIT
// Who holds control, in the page's head; taken, given and released here.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import { t, t_or } from '../words';
import { call } from './api';
import { AskWhy } from './parts';
import { Popover } from './popover';
import { act, holds_control, may, use_store } from './store';

// Who has control is told by its event: an answer that comes late would put back what was before.
function post(body: Record<string, string>, done: string): Promise<boolean> {
  return act(done, async () => {
    await call('POST', '/control', body);
  });
}

function Mine({ close }: { close: () => void }): JSX.Element {
  const [to, set_to] = useState('');
  return (
    <>
      <button
        type="button"
        onClick={() => {
          close();
          void post({ action: 'release' }, t('done_release'));
        }}
      >
        {t('control_release')}
      </button>
      <form
        class="ask"
        onSubmit={(event) => {
          event.preventDefault();
          close();
          void post({ action: 'give', to }, t('done_give', { name: to }));
        }}
      >
        <label>
          {t('control_give')}{' '}
          <input
            value={to}
            required
            maxLength={64}
            size={10}
            onInput={(e) => set_to(e.currentTarget.value)}
          />
        </label>
        <button type="submit">{t('give')}</button>
      </form>
    </>
  );
}

export function ControlBox(): JSX.Element | null {
  const { state, me } = use_store();
  if (!state || !me) return null;
  const { holder, door, why } = state.control;
  const words = holds_control()
    ? t('control_mine')
    : holder
      ? t('control_other', { name: holder })
      : t('control_free');
  const how = `${door && holder ? ` (${t_or(`door_${door}`, door)})` : ''}${why ? `: ${why}` : ''}`;
  const told = <strong>{words}</strong>;
  return (
    <div class="control" aria-live="polite">
      {(!holder || !may('operator')) && <p title={how}>{told}</p>}
      {!holder && may('operator') && (
        <button type="button" onClick={() => void post({ action: 'take' }, t('done_control'))}>
          {t('control_take')}
        </button>
      )}
      {holder && may('operator') && (
        <Popover id="control" label={told}>
          {(close) => (
            <>
              {how && (
                <p>
                  {words}
                  {how}
                </p>
              )}
              {holds_control() ? (
                <Mine close={close} />
              ) : (
                <AskWhy
                  label={t('control_take')}
                  at_once
                  act={(word) => {
                    close();
                    void post({ action: 'take', why: word }, t('done_control'));
                  }}
                  cancel={close}
                />
              )}
            </>
          )}
        </Popover>
      )}
    </div>
  );
}
