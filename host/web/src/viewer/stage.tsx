// SPDX-License-Identifier: MIT
// The shoe in 3-D: names, scale bar, turned by keys.  Frame: the shoe's.
import type { JSX } from 'preact';
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { t } from '../words';
import { type Label, type Overlay, Scene } from './scene';
import type { View } from './view_data';

/// Heel, toe and sides at the ends of the shoe's box.
export function names_of(view: View): Label[] {
  if (!view.data.T_base_shoe) return [];
  const { low, high } = view;
  const middle_x = (low[0] + high[0]) / 2;
  const middle_y = (low[1] + high[1]) / 2;
  const inner = view.data.inner_side;
  const side = (which: 'left' | 'right') =>
    t(which) +
    (inner === 'left' || inner === 'right' ? `, ${t(inner === which ? 'medial' : 'lateral')}` : '');
  return [
    { key: 'heel', text: t('heel'), at: [low[0] - 8, middle_y, low[2]] },
    { key: 'toe', text: t('toe'), at: [high[0] + 8, middle_y, low[2]] },
    { key: 'left', text: side('left'), at: [middle_x, high[1] + 8, low[2]] },
    { key: 'right', text: side('right'), at: [middle_x, low[1] - 8, low[2]] },
  ];
}

/// 1, 2 or 5 times a power of ten, about `px` long.
function bar_mm(px_per_mm: number, px: number): number {
  const wanted = px / Math.max(1e-9, px_per_mm);
  const power = 10 ** Math.floor(Math.log10(wanted));
  return ([5, 2, 1].find((n) => n * power <= wanted) ?? 1) * power;
}

/// The line's point at a place along it, which may lie behind its end.
export function index_at(view: View, at_mm: number): number {
  const wanted = ((at_mm % view.length_mm) + view.length_mm) % view.length_mm;
  const index = view.line.findIndex((p) => p.at_mm >= wanted);
  return Math.max(0, index);
}

/// `begun`: told of the scene once it is there, and of null when it goes.
export function Stage(props: { view: View; begun?: (scene: Scene | null) => void }): JSX.Element {
  const { view } = props;
  const box = useRef<HTMLDivElement>(null);
  const scene = useRef<Scene | null>(null);
  const [without, set_without] = useState('');
  const [overlay, set_overlay] = useState<Overlay>({ labels: [], px_per_mm: 1 });
  const names = useMemo(() => names_of(view), [view]);
  useEffect(() => {
    if (!box.current) return;
    try {
      const made = new Scene(box.current, view, names);
      made.on_overlay = set_overlay;
      scene.current = made;
      props.begun?.(made);
    } catch {
      set_without(t('no_webgl'));
    }
    return () => {
      scene.current?.dispose();
      scene.current = null;
      props.begun?.(null);
    };
  }, [view, names]);
  const key = (event: KeyboardEvent) => {
    const turns: Record<string, () => void> = {
      ArrowLeft: () => scene.current?.turn(0.1, 0),
      ArrowRight: () => scene.current?.turn(-0.1, 0),
      ArrowUp: () => scene.current?.turn(0, -0.1),
      ArrowDown: () => scene.current?.turn(0, 0.1),
      '+': () => scene.current?.zoom(1.2),
      '-': () => scene.current?.zoom(1 / 1.2),
      Home: () => scene.current?.look('fit'),
    };
    const turn = turns[event.key];
    if (!turn) return;
    event.preventDefault();
    turn();
  };
  // On a wall letters are larger, and so is the bar below them.
  const rem_px = Number.parseFloat(getComputedStyle(document.documentElement).fontSize) || 16;
  const bar = bar_mm(overlay.px_per_mm, 7.5 * rem_px);
  return (
    <div
      class="stage"
      ref={box}
      tabIndex={0}
      role="application"
      aria-label={t('stage_words')}
      onKeyDown={key}
    >
      {without && <p class="notice refused">{without}</p>}
      {!without &&
        overlay.labels
          .filter((label) => !label.hidden)
          .map((label) => (
            <span key={label.key} class="name" style={{ left: `${label.x}px`, top: `${label.y}px` }}>
              {label.text}
            </span>
          ))}
      {!without && (
        <span class="scale-bar" style={{ width: `${(bar * overlay.px_per_mm).toFixed(1)}px` }}>
          {bar} mm
        </span>
      )}
    </div>
  );
}
