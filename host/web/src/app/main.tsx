// SPDX-License-Identifier: MIT
// The page: Stop always in reach, who I am, and the views of my screen.
import type { ComponentChildren, JSX } from 'preact';
import { render } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import 'uplot/dist/uPlot.min.css';
import '../colours.css';
import '../viewer/viewer.css';
import './app.css';
import type { Me } from 'openapi';
import { type Word, language, set_language, stored_language, t } from '../words';
import { Refused } from './api';
import { Devices } from './devices';
import { FleetPage, at_centre, fleet_views } from './fleet';
import { Header } from './header';
import { Live } from './live';
import { Login } from './login';
import { Models } from './models';
import { OneModel } from './one_model';
import { Log, People } from './people';
import { Processes } from './processes';
import { OneScan, Scans } from './scans';
import { type ScreenName, keep_screen, screen_of, screen_with, views } from './screens';
import { Sensor } from './sensor';
import { StopBar } from './stop_bar';
import { change, hush, log_in, may_have_session, read_me, tell, use_store, words_of } from './store';
import { Teach } from './teach';
import { Work } from './work';

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

/// The screen in use, and how another is chosen: by its first view.  A link to a view of another screen leads there.
function use_screen(me: Me | null, asked: string | undefined): [ScreenName, (name: ScreenName) => void] {
  const [, set_turn] = useState(0);
  const chosen = me ? screen_of(me.name, me.role) : 'operator';
  const screen = asked ? screen_with(asked, chosen) : chosen;
  const choose = (name: ScreenName) => {
    if (me) keep_screen(me.name, name);
    location.hash = `#/${views[name][0]}`;
    set_turn((turn) => turn + 1);
  };
  return [screen, choose];
}

function View({ view, about }: { view: string; about: string | undefined }): ComponentChildren {
  switch (view) {
    case 'work':
      return <Work />;
    case 'live':
      return <Live />;
    case 'scans':
      return about ? <OneScan key={about} id={about} /> : <Scans />;
    case 'teach':
      return <Teach />;
    case 'models':
      return about ? <OneModel key={about} name={about} /> : <Models />;
    case 'processes':
      return <Processes />;
    case 'sensor':
      return <Sensor />;
    case 'devices':
      return <Devices />;
    case 'people':
      return <People />;
    case 'log':
      return <Log />;
    default:
      return null;
  }
}

function App(): JSX.Element {
  const { me, known, linked } = use_store();
  const route = use_route();
  const [screen, choose] = use_screen(me, route[0]);
  const of_screen: readonly string[] = at_centre ? fleet_views : views[screen];
  const view = of_screen.find((name) => name === route[0]) ?? of_screen[0]!;
  // The operator's view is one picture: it fills the window, and nothing lies below.
  const fills = me !== null && view === 'work';
  useEffect(() => {
    document.title = `${route[1] ?? t(`nav_${view}` as Word)} · Biteline`;
    document.documentElement.classList.toggle('fills', fills);
  }, [view, route[1], language(), fills]);
  if (!known)
    return (
      <main id="main">
        <h1>Biteline</h1>
        <p>{linked ? t('waits') : t('link_lost')}</p>
      </main>
    );
  return (
    <>
      {!at_centre && <StopBar />}
      <button type="button" class="skip" onClick={() => document.getElementById('main')?.focus()}>
        {t('skip')}
      </button>
      {me && <Header me={me} screen={screen} choose={choose} views={of_screen} view={view} />}
      <LinkWords />
      {me ? (
        <main id="main" tabIndex={-1}>
          {at_centre && <FleetPage view={view} cell={route[1]} />}
          <View view={view} about={route[1]} />
        </main>
      ) : (
        <Login />
      )}
      <Messages />
    </>
  );
}

/// A one-time token in the address is used up and taken out of it, so that nobody copies it.
async function begin(): Promise<void> {
  const token =
    new URLSearchParams(location.hash.replace(/^#/, '')).get('token') ??
    new URLSearchParams(location.search).get('token');
  if (token) {
    history.replaceState(null, '', location.pathname);
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
