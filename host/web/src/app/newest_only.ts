// SPDX-License-Identifier: MIT
// Questions that overtake each other: one is on its way at most, and of those that came meanwhile the newest is next.

export interface NewestOnly<Q> {
  ask(question: Q): void;
  /// What is on its way, and what waits, is not wanted any more.
  forget(): void;
  /// As forget(), for ever.
  close(): void;
}

/// `work` asks, and takes the answer only while `is_newest()`; it throws nothing.
export function newest_only<Q>(
  work: (question: Q, is_newest: () => boolean) => Promise<void>,
): NewestOnly<Q> {
  let busy = false;
  let closed = false;
  let turn = 0;
  let waiting: { question: Q } | null = null;
  const begin = async (question: Q): Promise<void> => {
    busy = true;
    const mine = turn;
    await work(question, () => !closed && mine === turn);
    busy = false;
    const next = waiting;
    waiting = null;
    if (next && !closed) void begin(next.question);
  };
  return {
    ask(question) {
      if (closed) return;
      turn += 1;
      if (busy) waiting = { question };
      else void begin(question);
    },
    forget() {
      turn += 1;
      waiting = null;
    },
    close() {
      closed = true;
      waiting = null;
    },
  };
}
