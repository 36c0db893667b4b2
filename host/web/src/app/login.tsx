// SPDX-License-Identifier: MIT
// Who is not logged in sees this: log in, the cell's first account, and the language.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import { language, languages, set_language, t } from '../words';
import { NewNameField, NewPasswordField } from './account_fields';
import { call } from './api';
import { act, change, log_in, tell, words_of } from './store';

export function Login(): JSX.Element {
  const [name, set_name] = useState('');
  const [password, set_password] = useState('');
  const [error, set_error] = useState('');
  const [busy, set_busy] = useState(false);
  return (
    <main id="main" class="login">
      <h1>Biteline</h1>
      <form
        class="form card"
        onSubmit={(event) => {
          event.preventDefault();
          set_busy(true);
          log_in({ name, password })
            .catch((refused) => set_error(words_of(refused)))
            .finally(() => set_busy(false));
        }}
      >
        <label>
          {t('name')}{' '}
          <input
            autocomplete="username"
            required
            value={name}
            onInput={(e) => set_name(e.currentTarget.value)}
          />
        </label>
        <label>
          {t('password')}{' '}
          <input
            type="password"
            autocomplete="current-password"
            required
            value={password}
            onInput={(e) => set_password(e.currentTarget.value)}
          />
        </label>
        <div aria-live="assertive">{error && <p class="notice refused">{error}</p>}</div>
        <button type="submit" class="go" disabled={busy}>
          {t('log_in')}
        </button>
      </form>
      <FirstAccount />
      <LanguageChoice />
    </main>
  );
}

/// The service takes it only on the cell's own machine, and only while there is no account.
function FirstAccount(): JSX.Element {
  const [name, set_name] = useState('');
  const [password, set_password] = useState('');
  const make = async () => {
    const made = await act(t('done_user', { name }), () =>
      call('POST', '/users', { name, password, role: 'administrator' }),
    );
    if (made) await log_in({ name, password }).catch((refused) => tell(words_of(refused), true));
  };
  return (
    <details class="card">
      <summary>{t('first_account')}</summary>
      <p>{t('first_account_words')}</p>
      <form
        class="form"
        onSubmit={(event) => {
          event.preventDefault();
          void make();
        }}
      >
        <NewNameField label={t('administrator_name')} value={name} set={set_name} />
        <NewPasswordField label={t('new_password')} value={password} set={set_password} />
        <button type="submit">{t('make_account')}</button>
      </form>
    </details>
  );
}

export function LanguageChoice(): JSX.Element {
  return (
    <label>
      {t('language')}{' '}
      <select
        value={language()}
        onChange={(e) => {
          void set_language(e.currentTarget.value).then(() => change({}));
        }}
      >
        {Object.entries(languages).map(([code, { name, locale }]) => (
          <option key={code} value={code} lang={locale}>
            {name}
          </option>
        ))}
      </select>
    </label>
  );
}
