// SPDX-License-Identifier: MIT
// The page: who I am, who holds control, Stop always in reach, and the views.
import type { ComponentChildren, JSX } from 'preact';
import { render } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import 'uplot/dist/uPlot.min.css';
import '../colours.css';
import '../viewer/viewer.css';
import './app.css';
import { language, set_language, stored_language, t, t_or } from '../words';
import { Refused, call } from './api';
import { Devices } from './devices';
import { FleetPage, at_centre, fleet_views } from './fleet';
import { Live } from './live';
import { Models } from './models';
import { LanguageChoice, Login } from './login';
import { AskWhy } from './parts';
import { Log, People } from './people';
import { Processes } from './processes';
import { OneScan, Scans } from './scans';
import { Sensor } from './sensor';
import {
  act,
  change,
  holds_control,
  hush,
  log_in,
  log_out,
  may,
  may_have_session,
  read_me,
  tell,
  use_store,
  words_of,
} from './store';
import { Teach } from './teach';

const cell_views = [
  'live',
  'scans',
  'teach',
  'models',
  'processes',
  'sensor',
  'devices',
  'people',
  'log',
] as const;
const views = at_centre ? fleet_views : cell_views;

function use_route(): string[] {
  const read = () => location.hash.replace(/^#\/?/, '').split('/').filter(Boolean);
  const [route, set] = useState(read);
  useEffect(() => {
    const changed = () => set(read());
    window.addEventListener('hashchange', changed);
    return () => window.removeEventListener('hashchange', changed);
  }, []);
  return route;
}

/// Stop and Laser off need no login on the cell's own machine; from elsewhere the server asks for one.
function StopBar(): JSX.Element {
  const send = async (path: string, done: string) => {
    try {
      await call('POST', path, {});
      tell(done);
    } catch (error) {
      tell(`${t('stop_failed')} ${words_of(error)}`, true);
    }
  };
  return (
    <aside class="stop-bar" aria-label={t('stop_bar')}>
      <button type="button" class="stop" onClick={() => void send('/commands/stop', t('done_stop'))}>
        {t('stop')}
      </button>
      <button
        type="button"
        class="stop laser"
        onClick={() => void send('/commands/laser-off', t('done_laser_off'))}
      >
        {t('laser_off')}
      </button>
      <p>{t('no_emergency_stop')}</p>
    </aside>
  );
}

function ControlBox(): JSX.Element | null {
  const { state, me } = use_store();
  const [to, set_to] = useState('');
  if (!state || !me) return null;
  const { holder, door, why } = state.control;
  const mine = holds_control();
  const post = (body: Record<string, string>, done: string) =>
    // Who has control is told by its event: an answer that comes late would put back what was before.
    act(done, async () => {
      await call('POST', '/control', body);
    });
  return (
    <div class="control" aria-live="polite">
      <p>
        <strong>
          {mine ? t('control_mine') : holder ? t('control_other', { name: holder }) : t('control_free')}
        </strong>
        {door && holder ? ` (${t_or(`door_${door}`, door)})` : ''}
        {why ? `: ${why}` : ''}
      </p>
      {may('operator') && (
        <div class="tools">
          {!mine && !holder && (
            <button type="button" onClick={() => void post({ action: 'take' }, t('done_control'))}>
              {t('control_take')}
            </button>
          )}
          {!mine && holder && (
            <AskWhy
              label={t('control_take')}
              act={(word) => void post({ action: 'take', why: word }, t('done_control'))}
            />
          )}
          {mine && (
            <>
              <button type="button" onClick={() => void post({ action: 'release' }, t('done_release'))}>
                {t('control_release')}
              </button>
              <form
                class="ask"
                onSubmit={(event) => {
                  event.preventDefault();
                  void post({ action: 'give', to }, t('done_give', { name: to }));
                  set_to('');
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
          )}
        </div>
      )}
    </div>
  );
}

function Messages(): JSX.Element {
  const { told } = use_store();
  return (
    <div class="told" role="status" aria-live="polite">
      {told.map((one) => (
        <p key={one.id} class={`notice ${one.bad ? 'refused' : 'good'}`}>
          <span aria-hidden="true">{one.bad ? '✖' : '✔'}</span> {one.text}{' '}
          <button type="button" aria-label={t('close')} onClick={() => hush(one.id)}>
            ×
          </button>
        </p>
      ))}
    </div>
  );
}

function LinkWords(): ComponentChildren {
  const { linked, host } = use_store();
  if (!linked)
    return (
      <p class="notice refused" role="alert">
        {t('link_lost')}
      </p>
    );
  if (!host)
    return (
      <p class="notice refused" role="alert">
        {t('host_lost')}
      </p>
    );
  return null;
}

function App(): JSX.Element {
  const { me, known, linked } = use_store();
  const route = use_route();
  const view = views.find((name) => name === route[0]) ?? views[0]!;
  useEffect(() => {
    document.title = `${route[1] ?? t(`nav_${view}`)} · Biteline`;
  }, [view, route[1], language()]);
  if (!known)
    return (
      <main id="main">
        <h1>Biteline</h1>
        <p>{linked ? t('waits') : t('link_lost')}</p>
      </main>
    );
  return (
    <>
      <button type="button" class="skip" onClick={() => document.getElementById('main')?.focus()}>
        {t('skip')}
      </button>
      {me && (
        <header>
          <nav aria-label={t('nav')}>
            {views.map((name) => (
              <a key={name} href={`#/${name}`} aria-current={view === name ? 'page' : undefined}>
                {t(`nav_${name}`)}
              </a>
            ))}
          </nav>
          <div class="who">
            <span>
              {me.name}, {t(`role_${me.role}`)}
            </span>
            <LanguageChoice />
            <button type="button" onClick={() => void log_out()}>
              {t('log_out')}
            </button>
          </div>
          <ControlBox />
        </header>
      )}
      <LinkWords />
      {me ? (
        <main id="main" tabIndex={-1}>
          {view === 'live' && <Live />}
          {view === 'scans' && (route[1] ? <OneScan key={route[1]} id={route[1]} /> : <Scans />)}
          {view === 'teach' && <Teach />}
          {view === 'models' && <Models />}
          {view === 'processes' && <Processes />}
          {view === 'sensor' && <Sensor />}
          {view === 'devices' && <Devices />}
          {at_centre && <FleetPage view={view} cell={route[1]} />}
          {view === 'people' && <People />}
          {view === 'log' && <Log />}
        </main>
      ) : (
        <Login />
      )}
      <Messages />
      {!at_centre && <StopBar />}
    </>
  );
}

/// A one-time token in the address is used up and taken out of it, so that nobody copies it.
async function begin(): Promise<void> {
  const token =
    new URLSearchParams(location.hash.replace(/^#/, '')).get('token') ??
    new URLSearchParams(location.search).get('token');
  if (token) {
    history.replaceState(null, '', `${location.pathname}#/${views[0]}`);
    try {
      await log_in({ token });
      return;
    } catch (error) {
      if (error instanceof Refused) tell(words_of(error), true);
    }
  }
  if (may_have_session()) await read_me();
  else change({ known: true });
}

/// In the language of the last visit from the first picture on; in English where its words do not come.
async function show(): Promise<void> {
  await set_language(stored_language());
  const place = document.getElementById('app');
  if (place) render(<App />, place);
  await begin();
}

void show();
