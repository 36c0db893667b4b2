// SPDX-License-Identifier: MIT
// Accounts, one's own password, and the log of all changes.
import type { JSX } from 'preact';
import { useState } from 'preact/hooks';
import type { LogEntry, Role, User } from 'openapi';
import { t, t_or } from '../words';
import { NewNameField, NewPasswordField } from './account_fields';
import { call, query } from './api';
import { Failure, Table } from './parts';
import { act, may, roles, time_words, use_reading, use_store } from './store';

export function People(): JSX.Element {
  const { me } = use_store();
  const admin = may('administrator');
  const { value, error } = use_reading<{ users: User[] }>(admin ? '/users' : null);
  const [asked, set_asked] = useState('');
  return (
    <>
      <h1>{t('nav_people')}</h1>
      {!admin && <p class="quiet">{t('needs_administrator')}</p>}
      <Failure text={error} />
      {value && (
        <Table
          label={t('nav_people')}
          heads={[t('name'), t('role'), t('open_account'), t('made'), t('last_login'), '']}
        >
          {value.users.map((user) => (
            <tr key={user.name}>
              <th scope="row">{user.name}</th>
              <td>
                <select
                  aria-label={`${t('role')} ${user.name}`}
                  value={user.role}
                  onChange={(e) =>
                    void act(t('done_user', { name: user.name }), () =>
                      call('PATCH', `/users/${user.name}`, { role: e.currentTarget.value }),
                    )
                  }
                >
                  {roles.map((role) => (
                    <option key={role} value={role}>
                      {t(`role_${role}`)}
                    </option>
                  ))}
                </select>
              </td>
              <td>
                <button
                  type="button"
                  aria-pressed={user.enabled}
                  onClick={() =>
                    void act(t('done_user', { name: user.name }), () =>
                      call('PATCH', `/users/${user.name}`, { enabled: !user.enabled }),
                    )
                  }
                >
                  {user.enabled ? t('account_open') : t('account_closed')}
                </button>
              </td>
              <td>{time_words(user.made)}</td>
              <td>{time_words(user.last_login)}</td>
              <td>
                {user.name !== me?.name && asked !== user.name && (
                  <button type="button" onClick={() => set_asked(user.name)}>
                    {t('remove_one', { name: user.name })}
                  </button>
                )}
                {asked === user.name && (
                  <button
                    type="button"
                    class="stop-quiet"
                    onClick={() => {
                      set_asked('');
                      void act(t('done_remove', { name: user.name }), () =>
                        call('DELETE', `/users/${user.name}`),
                      );
                    }}
                  >
                    {t('really_remove', { name: user.name })}
                  </button>
                )}
              </td>
            </tr>
          ))}
        </Table>
      )}
      {admin && <NewUser />}
      <OwnPassword />
    </>
  );
}

function NewUser(): JSX.Element {
  const [form, set_form] = useState({ name: '', role: 'operator' as Role, password: '' });
  return (
    <section class="card">
      <h2>{t('new_user')}</h2>
      <form
        class="form"
        onSubmit={(event) => {
          event.preventDefault();
          void act(t('done_user', { name: form.name }), () => call('POST', '/users', form)).then(
            (done) => done && set_form({ name: '', role: 'operator', password: '' }),
          );
        }}
      >
        <NewNameField label={t('name')} value={form.name} set={(name) => set_form({ ...form, name })} />
        <label>
          {t('role')}{' '}
          <select
            value={form.role}
            onChange={(e) => set_form({ ...form, role: e.currentTarget.value as Role })}
          >
            {roles.map((role) => (
              <option key={role} value={role}>
                {t(`role_${role}`)}
              </option>
            ))}
          </select>
        </label>
        <NewPasswordField
          label={t('password')}
          value={form.password}
          set={(password) => set_form({ ...form, password })}
        />
        <button type="submit" class="go">
          {t('save')}
        </button>
      </form>
    </section>
  );
}

function OwnPassword(): JSX.Element | null {
  const { me } = use_store();
  const [form, set_form] = useState({ old_password: '', password: '' });
  if (!me) return null;
  return (
    <section class="card">
      <h2>{t('own_password')}</h2>
      <form
        class="form"
        onSubmit={(event) => {
          event.preventDefault();
          void act(t('done_password'), () => call('PATCH', `/users/${me.name}`, form)).then(() =>
            set_form({ old_password: '', password: '' }),
          );
        }}
      >
        <label>
          {t('old_password')}{' '}
          <input
            type="password"
            required
            autocomplete="current-password"
            value={form.old_password}
            onInput={(e) => set_form({ ...form, old_password: e.currentTarget.value })}
          />
        </label>
        <NewPasswordField
          label={t('new_password')}
          value={form.password}
          set={(password) => set_form({ ...form, password })}
        />
        <button type="submit">{t('save')}</button>
      </form>
    </section>
  );
}

function short(value: unknown): string {
  if (value === null || value === undefined) return '–';
  const text = typeof value === 'string' ? value : JSON.stringify(value);
  return text.length > 200 ? `${text.slice(0, 200)}…` : text;
}

export function Log(): JSX.Element {
  const [cursors, set_cursors] = useState<string[]>([]);
  const { value, error } = use_reading<{ entries: LogEntry[]; next: string | null }>(
    may('engineer') ? `/log${query({ limit: 100, cursor: cursors[cursors.length - 1] })}` : null,
  );
  return (
    <>
      <h1>{t('nav_log')}</h1>
      {!may('engineer') && <p class="quiet">{t('needs_engineer')}</p>}
      <Failure text={error} />
      {value && (
        <Table
          label={t('nav_log')}
          heads={[t('time'), t('who'), t('door'), t('what'), t('subject'), t('before'), t('after')]}
        >
          {value.entries.map((entry) => (
            <tr key={entry.seq}>
              <th scope="row">{time_words(entry.time)}</th>
              <td>{entry.who}</td>
              <td>{entry.door ?? '–'}</td>
              <td>{t_or(`what_${entry.what}`, entry.what)}</td>
              <td>{entry.subject ?? '–'}</td>
              <td>{short(entry.before)}</td>
              <td>{short(entry.after)}</td>
            </tr>
          ))}
        </Table>
      )}
      <div class="tools">
        {cursors.length > 0 && (
          <button type="button" onClick={() => set_cursors(cursors.slice(0, -1))}>
            {t('newer')}
          </button>
        )}
        {value?.next && (
          <button type="button" onClick={() => set_cursors([...cursors, value.next!])}>
            {t('older')}
          </button>
        )}
      </div>
    </>
  );
}
