// SPDX-License-Identifier: MIT
// All texts of the page: one file per language in words/.  English is complete; another falls back to it.
import de from '../words/de.json';
import en from '../words/en.json';

export type Language = 'en' | 'de';
export type Word = keyof typeof en;

const languages: Record<Language, Partial<Record<Word, string>>> = { en, de };
export const language_names: [Language, string][] = [
  ['en', 'English'],
  ['de', 'Deutsch'],
];

let current: Language = 'en';

export function language(): Language {
  return current;
}

/// Kept for the next visit where the browser lets us.
export function set_language(wanted: string | null): void {
  current = wanted === 'de' ? 'de' : 'en';
  document.documentElement.lang = current;
  try {
    localStorage.setItem('biteline_language', current);
  } catch {
    // A page from a disk may have no storage: the choice holds for this visit.
  }
}

export function stored_language(): string | null {
  try {
    return localStorage.getItem('biteline_language') ?? navigator.language.slice(0, 2);
  } catch {
    return null;
  }
}

/// The words of `key`, with {name} replaced by `values.name`.
export function t(key: Word, values: Record<string, string | number> = {}): string {
  const text = languages[current][key] ?? en[key];
  return text.replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ''));
}

/// As t() for a key that the server names; its own text where the page has no words for it.
export function t_or(key: string, otherwise: string): string {
  return key in en ? t(key as Word) : otherwise;
}

/// A field's help.  In English the service says it itself (`otherwise`); the other languages' files have it.
export function help_words(key: string, otherwise: string): string {
  return (languages[current] as Record<string, string>)[key] ?? otherwise;
}

/// For numbers and dates: English here is that of the metric world.
export function locale(): string {
  return current === 'en' ? 'en-GB' : current;
}

let zone: string | undefined;

/// Times are the cell's own, wherever the page is read; a zone that the browser does not know leaves its own.
export function set_zone(wanted: string | undefined): void {
  if (wanted === zone) return;
  try {
    new Intl.DateTimeFormat('en', { timeZone: wanted });
    zone = wanted;
  } catch {
    zone = undefined;
  }
}

export function time_zone(): string | undefined {
  return zone;
}

/// How a table is written that this language's spreadsheets open as one.
export function csv_style(): Record<string, string> {
  return current === 'en' ? {} : { separator: 'semicolon', decimal: 'comma', byte_mark: 'yes' };
}

export function number(value: number | null | undefined, digits = 2): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  return value.toLocaleString(locale(), { minimumFractionDigits: digits, maximumFractionDigits: digits });
}

/// As number() with its unit; a dash alone where there is none.
export function amount(value: number | null | undefined, unit: string, digits = 2): string {
  const text = number(value, digits);
  return text === '–' ? text : `${text} ${unit}`;
}
