// SPDX-License-Identifier: MIT
// All texts of the page: one file per language in words/.  English is complete and a part of the page; another is
// fetched when it is asked for.
import en from '../words/en.json';

export type Word = keyof typeof en;

interface Tongue {
  name: string; ///< in its own words
  locale: string; ///< of numbers and dates; English here is that of the metric world
  decimal_comma: boolean;
}
export const languages = {
  en: { name: 'English', locale: 'en-GB', decimal_comma: false },
  de: { name: 'Deutsch', locale: 'de', decimal_comma: true },
  es: { name: 'Español', locale: 'es', decimal_comma: true },
  hi: { name: 'हिन्दी', locale: 'hi', decimal_comma: false },
  id: { name: 'Bahasa Indonesia', locale: 'id', decimal_comma: true },
  it: { name: 'Italiano', locale: 'it', decimal_comma: true },
  pt: { name: 'Português (Brasil)', locale: 'pt-BR', decimal_comma: true },
  tr: { name: 'Türkçe', locale: 'tr', decimal_comma: true },
  vi: { name: 'Tiếng Việt', locale: 'vi', decimal_comma: true },
  zh: { name: '中文', locale: 'zh-CN', decimal_comma: false },
} satisfies Record<string, Tongue>;
export type Language = keyof typeof languages;

let current: Language = 'en';
let words: Record<string, string> = en;

export function language(): Language {
  return current;
}

/// Kept for the next visit where the browser lets us.  Words that do not come leave what is there.
export async function set_language(wanted: string | null): Promise<void> {
  const known: Language = wanted !== null && wanted in languages ? (wanted as Language) : 'en';
  if (known === 'en') {
    words = en;
  } else {
    try {
      const answer = await fetch(`words/${known}.json`);
      if (!answer.ok) return;
      words = { ...en, ...(await answer.json()) };
    } catch {
      return;
    }
  }
  current = known;
  document.documentElement.lang = languages[current].locale;
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
  return words[key].replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ''));
}

/// As t() for a key that the server names; its own text where the page has no words for it.
export function t_or(key: string, otherwise: string): string {
  return key in en ? t(key as Word) : otherwise;
}

/// A field's help.  In English the service says it itself (`otherwise`); the other languages' files have it.
export function help_words(key: string, otherwise: string): string {
  return words[key] ?? otherwise;
}

/// For numbers and dates.
export function locale(): string {
  return languages[current].locale;
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
  return !languages[current].decimal_comma
    ? {}
    : { separator: 'semicolon', decimal: 'comma', byte_mark: 'yes' };
}

/// A number as people of this language write it; not a number where it is none.
export function read_number(text: string): number {
  const plain = languages[current].decimal_comma ? text.replace(',', '.') : text;
  return text.trim() === '' ? Number.NaN : Number(plain);
}

/// Several, with blanks between them, and commas where a comma is no decimal sign.
export function read_numbers(text: string): number[] {
  const between = languages[current].decimal_comma ? /,?\s+/ : /[\s,]+/;
  return text.trim().split(between).map(read_number);
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
