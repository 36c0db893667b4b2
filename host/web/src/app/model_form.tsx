// SPDX-License-Identifier: MIT
// The one form that makes a model of a scan: name, size, foot and whose sample it is; what else it asks for is its caller's.
import type { ComponentChildren, JSX } from 'preact';
import { useState } from 'preact/hooks';
import { t } from '../words';
import { call } from './api';
import { act } from './store';

export const name_pattern = '[A-Za-z0-9][A-Za-z0-9._\\-]*';

export function ModelForm(props: {
  look: 'form' | 'tools';
  names: string[];
  scan: string;
  /// Another one than the scan was planned with; empty: the scan's own.
  process: string;
  enabled: boolean;
  /// Its line and process were not run in the air so, and that is meant.
  not_run?: boolean;
  /// The name under which it was saved; empty: not yet.
  saved?: string;
  children?: ComponentChildren;
}): JSX.Element {
  const [form, set_form] = useState({ name: '', size: '', foot: '', of: '' });
  const field = (key: keyof typeof form) => ({
    value: form[key],
    disabled: !props.enabled,
    onInput: (event: { currentTarget: { value: string } }) =>
      set_form({ ...form, [key]: event.currentTarget.value }),
  });
  const exists = props.names.includes(form.name);
  const save = () => {
    const wish = { ...form, scan: props.scan, process: props.process };
    const body = Object.fromEntries(Object.entries(wish).filter(([, text]) => text !== ''));
    return act(t('done_model', { name: form.name }), () =>
      call('POST', '/models', {
        ...body,
        ...(props.process === '' ? {} : { other_process: true }),
        ...(exists ? { replace: true } : {}),
        ...(props.not_run ? { not_run: true } : {}),
      }),
    );
  };
  return (
    <form
      class={props.look}
      onSubmit={(event) => {
        event.preventDefault();
        void save();
      }}
    >
      <label>
        {t('name')} <input required maxLength={64} pattern={name_pattern} {...field('name')} />
      </label>
      {props.children}
      <label>
        {t('size')} <input maxLength={20} size={8} placeholder="EU 42" {...field('size')} />
      </label>
      <label>
        {t('foot')}{' '}
        <select {...field('foot')}>
          <option value="">–</option>
          <option value="left">{t('left')}</option>
          <option value="right">{t('right')}</option>
        </select>
      </label>
      <label>
        {t('sample_of')}{' '}
        <input
          maxLength={64}
          size={12}
          pattern={name_pattern}
          placeholder={t('own_name')}
          list="models-of"
          {...field('of')}
        />
        <datalist id="models-of">
          {props.names.map((name) => (
            <option key={name} value={name} />
          ))}
        </datalist>
      </label>
      {exists && props.saved !== form.name && <p class="notice look">{t('replaces', { name: form.name })}</p>}
      <button type="submit" class={props.saved ? '' : 'go'} disabled={!props.enabled}>
        {exists ? t('replace') : t('save')}
      </button>
    </form>
  );
}
