// SPDX-License-Identifier: MIT
// A button that opens a small panel below itself; Escape, a click elsewhere or a done deed closes it.
import type { ComponentChildren, JSX } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';

export function Popover(props: {
  id: string;
  label: ComponentChildren;
  kind?: string;
  children: (close: () => void) => ComponentChildren;
}): JSX.Element {
  const [open, set_open] = useState(false);
  const place = useRef<HTMLDivElement>(null);
  const button = useRef<HTMLButtonElement>(null);
  useEffect(() => {
    if (!open) return;
    const elsewhere = (event: Event) => {
      if (!place.current?.contains(event.target as Node)) set_open(false);
    };
    const on_key = (event: KeyboardEvent) => {
      if (event.key !== 'Escape') return;
      set_open(false);
      button.current?.focus();
    };
    document.addEventListener('pointerdown', elsewhere);
    document.addEventListener('keydown', on_key);
    return () => {
      document.removeEventListener('pointerdown', elsewhere);
      document.removeEventListener('keydown', on_key);
    };
  }, [open]);
  return (
    <div class={`popover ${props.kind ?? ''}`} ref={place}>
      <button
        type="button"
        class="opens"
        ref={button}
        aria-expanded={open}
        aria-controls={open ? props.id : undefined}
        onClick={() => set_open(!open)}
      >
        {props.label}
      </button>
      {open && (
        <div class="panel" id={props.id}>
          {props.children(() => set_open(false))}
        </div>
      )}
    </div>
  );
}
