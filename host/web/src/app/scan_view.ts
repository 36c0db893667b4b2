// SPDX-License-Identifier: MIT
// What there is to look at of a scan.
import { useEffect, useRef, useState } from 'preact/hooks';
import { parse_view_data, type ViewData } from '../viewer/view_data';
import { t } from '../words';
import { Refused, file_address } from './api';
import { use_store } from './store';

/// view_data.js of a scan; null while it is read, or a word why there is none.
export function use_view(
  id: string | null,
  version: number | undefined,
): { data: ViewData | null; error: string } {
  const [got, set] = useState<{ data: ViewData | null; error: string }>({ data: null, error: '' });
  const { turn } = use_store();
  const shown = useRef('');
  useEffect(() => {
    let alive = true;
    // After a lost link the same is read anew; what a person does on it meanwhile is not thrown away.
    const wanted = `${id} ${version}`;
    if (shown.current !== wanted) set({ data: null, error: '' });
    shown.current = wanted;
    if (id === null) return;
    fetch(file_address(id, 'view_data.js'), { credentials: 'same-origin' })
      .then(async (answer) => {
        if (!answer.ok) throw new Refused(answer.status, 'not_found', t('no_view'), []);
        return parse_view_data(await answer.text());
      })
      .then((data) => alive && set({ data, error: '' }))
      // What is shown stays: a person may be at work on it.
      .catch(
        (error: Error) =>
          alive && set((before) => ({ data: before.data, error: error.message || t('no_view') })),
      );
    return () => {
      alive = false;
    };
  }, [id, version, turn]);
  return got;
}
