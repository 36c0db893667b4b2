// SPDX-License-Identifier: MIT
// Where the tip runs, as a section across the line and a view along it.  Handles are dragged; the fields say the same.
import type { JSX, TargetedPointerEvent } from 'preact';
import { useState } from 'preact/hooks';
import { amount, t, t_or } from '../words';
import type { Schema } from './json_schema';
import type { Value } from './process_field';

type Key = 'outward_mm' | 'up_mm' | 'standoff_mm' | 'tilt_deg' | 'lead_deg';
type Spot = [number, number];

const rad_per_deg = Math.PI / 180;
/// What a drag sets: round numbers.
const step = { mm: 0.5, deg: 1 };

/// Room round the line for the longest offsets and the tool behind them.
const view_box = '-20 -50 460 350';
/// The line is at `line`, +x is outwards (or the way of travel), +y is up.
const line: Spot = [170, 200];
const grip_px = 62;
const end_px = 124;
/// So many mm are from the line to the picture's edge, unless the offsets are longer.
const least_reach_mm = 25;
const reach_px = 90;

/// From the aim to the tool's body, as seen across the line; the service's tool_path does the same in space.
export function body_across(tilt_deg: number): Spot {
  return [Math.cos(tilt_deg * rad_per_deg), Math.sin(tilt_deg * rad_per_deg)];
}

/// As seen along the line: above 0 the body leans back against the way of travel.
export function body_along(lead_deg: number): Spot {
  return [-Math.sin(lead_deg * rad_per_deg), Math.cos(lead_deg * rad_per_deg)];
}

/// `value` at the next whole step within the schema's range.
export function rounded(value: number, by: number, schema: Schema | undefined): number {
  const next = Math.round(value / by) * by;
  return Math.min(schema?.maximum ?? next, Math.max(schema?.minimum ?? next, next));
}

function Handle(props: { at: Spot; label: string; drag: (to: Spot) => void; done: () => void }): JSX.Element {
  const [x, y] = props.at;
  const move = (event: TargetedPointerEvent<SVGGElement>) => {
    const matrix = event.currentTarget.ownerSVGElement?.getScreenCTM();
    if (!event.currentTarget.hasPointerCapture(event.pointerId) || !matrix) return;
    const to = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    props.drag([to.x, to.y]);
  };
  return (
    <g
      class="handle"
      data-handle={props.label}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={move}
      onLostPointerCapture={props.done}
    >
      <title>{props.label}</title>
      <circle class="reach" cx={x} cy={y} r={40} />
      <circle cx={x} cy={y} r={9} />
    </g>
  );
}

function Tool({ tip, body }: { tip: Spot; body: Spot }): JSX.Element {
  const at = (px: number) => `${tip[0] + px * body[0]} ${tip[1] - px * body[1]}`;
  return (
    <>
      <path class="tool" d={`M${at(14)}L${at(end_px)}`} />
      <path class="tip" d={`M${tip[0]} ${tip[1]}L${at(14)}`} />
    </>
  );
}

export function PlacementPicture(props: {
  value: Value;
  schema: Schema;
  change: (value: Value) => void;
}): JSX.Element {
  const given = (props.value ?? {}) as Record<string, unknown>;
  const read = (key: Key): number => (typeof given[key] === 'number' ? (given[key] as number) : 0);
  const set = (changes: Partial<Record<Key, number>>) => {
    const next = { ...given };
    for (const [key, to] of Object.entries(changes))
      next[key] = rounded(to, key.endsWith('_deg') ? step.deg : step.mm, props.schema.properties?.[key]);
    props.change(next);
  };
  // A scale that changed under the finger would run away with it.
  const [held_scale, hold_scale] = useState<number | null>(null);
  const longest_mm =
    Math.abs(read('standoff_mm')) + Math.max(Math.abs(read('outward_mm')), Math.abs(read('up_mm')));
  const px_per_mm = held_scale ?? reach_px / Math.max(least_reach_mm, longest_mm);
  const hold = (drag: (to: Spot) => void) => (to: Spot) => {
    hold_scale(px_per_mm);
    drag(to);
  };
  const done = () => hold_scale(null);

  const name = (key: Key) => t_or(`field_placement.${key}`, key);
  const aim: Spot = [line[0] + read('outward_mm') * px_per_mm, line[1] - read('up_mm') * px_per_mm];
  const body = body_across(read('tilt_deg'));
  const along = (from: Spot, way: Spot, px: number): Spot => [from[0] + px * way[0], from[1] - px * way[1]];
  const standoff_px = read('standoff_mm') * px_per_mm;
  const tip = along(aim, body, standoff_px);
  const lean = body_along(read('lead_deg'));
  const far = along(line, lean, end_px);
  return (
    <div class="placement-picture">
      <figure>
        <svg viewBox={view_box} role="img" aria-label={t('picture_across')}>
          <path
            class="upper"
            d={`M-20 ${line[1]}H${line[0]}C${line[0] - 8} 150 ${line[0] - 25} 90 ${line[0] - 60} -30L-20 -50Z`}
          />
          <path class="sole" d={`M-20 ${line[1]}H${line[0] + 26}V270H-20Z`} />
          <path class="ray" d={`M${aim[0]} ${aim[1]}L${tip[0]} ${tip[1]}`} />
          <Tool tip={tip} body={body} />
          <circle class="bite" cx={line[0]} cy={line[1]} r={4} />
          <Handle
            at={along(tip, body, end_px)}
            label={name('tilt_deg')}
            drag={([x, y]) => set({ tilt_deg: Math.atan2(aim[1] - y, x - aim[0]) / rad_per_deg })}
            done={done}
          />
          <Handle
            at={along(tip, body, grip_px)}
            label={name('standoff_mm')}
            drag={hold(([x, y]) => {
              const from_aim_px = (x - aim[0]) * body[0] + (aim[1] - y) * body[1];
              set({ standoff_mm: (from_aim_px - grip_px) / px_per_mm });
            })}
            done={done}
          />
          <Handle
            at={aim}
            label={name('outward_mm')}
            drag={hold(([x, y]) =>
              set({ outward_mm: (x - line[0]) / px_per_mm, up_mm: (line[1] - y) / px_per_mm }),
            )}
            done={done}
          />
        </svg>
        <figcaption>
          {t('picture_across')} · {name('outward_mm')} {amount(read('outward_mm'), 'mm', 1)} · {name('up_mm')}{' '}
          {amount(read('up_mm'), 'mm', 1)} · {name('standoff_mm')} {amount(read('standoff_mm'), 'mm', 1)} ·{' '}
          {name('tilt_deg')} {amount(read('tilt_deg'), '°', 0)}
        </figcaption>
      </figure>
      <figure>
        <svg viewBox={view_box} role="img" aria-label={t('picture_along')}>
          <path class="sole" d={`M-20 ${line[1]}H440V270H-20Z`} />
          <path class="bite" d={`M20 ${line[1]}H370l-12 -7m12 7l-12 7`} />
          <Tool tip={line} body={lean} />
          <Handle
            at={far}
            label={name('lead_deg')}
            drag={([x, y]) => set({ lead_deg: Math.atan2(line[0] - x, line[1] - y) / rad_per_deg })}
            done={done}
          />
        </svg>
        <figcaption>
          {t('picture_along')} · {name('lead_deg')} {amount(read('lead_deg'), '°', 0)}
        </figcaption>
      </figure>
    </div>
  );
}
