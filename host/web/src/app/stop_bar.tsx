// SPDX-License-Identifier: MIT
// Stop and Laser off: always in sight, and the first that the keyboard reaches.
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';
import { t } from '../words';
import { call } from './api';
import { tell, words_of } from './store';

/// What stands above the bar keeps clear of it: its height is told as --bar.
function use_told_height(): { current: HTMLElement | null } {
  const bar = useRef<HTMLElement>(null);
  useEffect(() => {
    const { style } = document.documentElement;
    const watcher = new ResizeObserver(() =>
      style.setProperty('--bar', `${bar.current?.getBoundingClientRect().height ?? 0}px`),
    );
    if (bar.current) watcher.observe(bar.current);
    return () => {
      watcher.disconnect();
      style.removeProperty('--bar');
    };
  }, []);
  return bar;
}

/// Stop and Laser off need no login on the cell's own machine; from elsewhere the server asks for one.
export function StopBar(): JSX.Element {
  const bar = use_told_height();
  const send = async (path: string, done: string) => {
    try {
      await call('POST', path, {});
      tell(done);
    } catch (error) {
      tell(`${t('stop_failed')} ${words_of(error)}`, true);
    }
  };
  return (
    <aside class="stop-bar" ref={bar} aria-label={t('stop_bar')}>
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
