// SPDX-License-Identifier: MIT
// Which views stand before whom.  A screen hides nothing: every view is reached from another screen, by who may.
import type { Role } from 'openapi';

export const views = {
  operator: ['work', 'scans'],
  engineer: ['teach', 'models', 'processes', 'scans', 'live'],
  maintainer: ['live', 'sensor', 'devices', 'scans', 'people', 'log'],
} as const;
export type ScreenName = keyof typeof views;
export type CellView = (typeof views)[ScreenName][number];
export const screen_names = Object.keys(views) as ScreenName[];

const of_role: Record<Role, ScreenName> = {
  viewer: 'operator',
  operator: 'operator',
  engineer: 'engineer',
  administrator: 'maintainer',
};

const kept = (who: string) => `biteline_screen_${who}`;

/// What this person has switched to here before, else what the role works with.
export function screen_of(who: string, role: Role): ScreenName {
  try {
    const name = localStorage.getItem(kept(who));
    if (name !== null && name in views) return name as ScreenName;
  } catch {
    // Without storage the role decides at each visit.
  }
  return of_role[role];
}

export function keep_screen(who: string, name: ScreenName): void {
  try {
    localStorage.setItem(kept(who), name);
  } catch {
    // As above.
  }
}

export function has_view(name: ScreenName, view: string): boolean {
  return (views[name] as readonly string[]).includes(view);
}

/// The screen that a link leads to: the one in use where it has the view.
export function screen_with(view: string, now: ScreenName): ScreenName {
  return has_view(now, view) ? now : (screen_names.find((name) => has_view(name, view)) ?? now);
}
