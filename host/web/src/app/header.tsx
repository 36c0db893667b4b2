// SPDX-License-Identifier: MIT
// The page's head, in one row of 48 px: menu, screen, the screen's views, who holds control.
import type { JSX } from 'preact';
import type { Me } from 'openapi';
import { type Word, t } from '../words';
import { ControlBox } from './control_box';
import { at_centre } from './fleet';
import { LanguageChoice } from './login';
import { Popover } from './popover';
import { type ScreenName, screen_names } from './screens';
import { log_out } from './store';

function Views(props: { views: readonly string[]; view: string; chosen?: () => void }): JSX.Element {
  return (
    <nav aria-label={t('nav')}>
      {props.views.map((name) => (
        <a
          key={name}
          href={`#/${name}`}
          aria-current={props.view === name ? 'page' : undefined}
          onClick={props.chosen}
        >
          {t(`nav_${name}` as Word)}
        </a>
      ))}
    </nav>
  );
}

function ScreenChoice(props: { now: ScreenName; choose: (name: ScreenName) => void }): JSX.Element {
  return (
    <select
      class="screen"
      aria-label={t('screen')}
      value={props.now}
      onChange={(event) => props.choose(event.currentTarget.value as ScreenName)}
    >
      {screen_names.map((name) => (
        <option key={name} value={name}>
          {t(`screen_${name}`)}
        </option>
      ))}
    </select>
  );
}

export function Header(props: {
  me: Me;
  screen: ScreenName;
  choose: (name: ScreenName) => void;
  views: readonly string[];
  view: string;
}): JSX.Element {
  return (
    <header>
      <Popover
        id="menu"
        kind="menu"
        label={
          <>
            <span aria-hidden="true">☰</span>
            <span class="unseen">{t('menu')}</span>
          </>
        }
      >
        {(close) => (
          <>
            <p>
              {props.me.name}, {t(`role_${props.me.role}`)}
            </p>
            <div class="narrow">
              <Views views={props.views} view={props.view} chosen={close} />
            </div>
            <LanguageChoice />
            <button type="button" onClick={() => void log_out()}>
              {t('log_out')}
            </button>
          </>
        )}
      </Popover>
      {!at_centre && <ScreenChoice now={props.screen} choose={props.choose} />}
      <div class="wide-only">
        <Views views={props.views} view={props.view} />
      </div>
      <ControlBox />
    </header>
  );
}
