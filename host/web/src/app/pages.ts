// SPDX-License-Identifier: MIT
// A long list, the newest rows first: the first page is read again as things happen, older ones when a person asks.
import { useState } from 'preact/hooks';
import { call, query } from './api';
import { tell, use_reading, words_of } from './store';

const rows_a_page = 50;

interface Page<Row> {
  scans: Row[];
  next: string | null;
}

export interface Pages<Row> {
  read: boolean; // the first page has come
  rows: Row[];
  error: string;
  load: (() => Promise<void>) | null; // one page more; null at the end
}

export function use_pages<Row>(
  path: string,
  filter: Record<string, string | undefined>,
  key_of: (row: Row) => string,
): Pages<Row> {
  const [more, set_more] = useState<{ first: string; rows: Row[]; next: string | null } | null>(null);
  const address = (cursor?: string) => `${path}${query({ ...filter, limit: rows_a_page, cursor })}`;
  const first = address();
  const { value, error } = use_reading<Page<Row>>(first);
  const older = more?.first === first ? more : null;
  // What new rows push out of the first page stays on the list.
  const newest = value?.scans ?? [];
  const among_newest = new Set(newest.map(key_of));
  const rows = [...newest, ...(older?.rows ?? []).filter((row) => !among_newest.has(key_of(row)))];
  const next = older ? older.next : (value?.next ?? null);
  const load = async () => {
    if (!next) return;
    try {
      const page = await call<Page<Row>>('GET', address(next));
      set_more({ first, rows: [...rows, ...page.scans], next: page.next });
    } catch (refused) {
      tell(words_of(refused), true);
    }
  };
  return { read: value !== null, rows, error, load: next ? load : null };
}
