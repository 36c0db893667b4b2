// SPDX-License-Identifier: MIT
// Start a scan, and say whose shoe comes next where somebody knows.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import { t } from '../words';
import { call } from './api';
import { act, offered } from './store';

/// `short`: where there is little room, what nobody says is a dash.
export function StartForm({ enabled, short }: { enabled: boolean; short?: boolean }): JSX.Element {
  const [shoe, set_shoe] = useState({ part: '', foot: '', size: '' });
  const field = (name: keyof typeof shoe) => ({
    value: shoe[name],
    disabled: !enabled,
    onInput: (event: { currentTarget: { value: string } }) => {
      const { value } = event.currentTarget;
      set_shoe((now) => ({ ...now, [name]: value }));
    },
  });
  const start = async () => {
    const body = Object.fromEntries(Object.entries(shoe).filter(([, text]) => text !== ''));
    const done = await act(t('done_start'), () => call('POST', '/commands/start', body));
    // The number was of this scan alone.
    if (done) set_shoe((now) => ({ ...now, part: '' }));
  };
  return (
    // A scanner's Enter behind its number moves nothing: the button alone starts.
    <form class="tools" onSubmit={(event) => event.preventDefault()}>
      <button type="button" class="go" disabled={!enabled || !offered('start')} onClick={() => void start()}>
        {t('start')}
      </button>
      <label>
        {t('part')} <input maxLength={64} size={14} autocomplete="off" {...field('part')} />
      </label>
      <label>
        {t('foot')}{' '}
        <select {...field('foot')}>
          <option value="">{short ? '–' : t('as_recognised')}</option>
          <option value="left">{t('left')}</option>
          <option value="right">{t('right')}</option>
        </select>
      </label>
      <label>
        {t('size')}{' '}
        <input maxLength={20} size={8} placeholder={short ? '–' : t('as_recognised')} {...field('size')} />
      </label>
    </form>
  );
}
