// SPDX-License-Identifier: MIT
// The section across the line at one point: raw points, the line's place with its U95, the normal.
import type { JSX } from 'preact';
import { number, t } from '../words';
import { type Section, type SectionPoint, dot, u95_of_confidence_mm } from './view_data';

/// `move`: a person may drag the line's point; `moved` is where it is then.
export function SectionPlot(props: {
  cut: Section;
  reach_mm: number;
  moved?: SectionPoint;
  move?: (to: SectionPoint) => void;
}): JSX.Element {
  const { cut, reach_mm } = props;
  const size = 320;
  const x = (mm: number) => size / 2 + (mm / reach_mm) * (size / 2 - 18);
  const y = (mm: number) => size / 2 - (mm / reach_mm) * (size / 2 - 18);
  const u95 = cut.at.u95_mm ?? u95_of_confidence_mm(cut.at.confidence);
  const n = { out: dot(cut.at.normal, cut.out), up: dot(cut.at.normal, cut.up) };
  const ticks = [-10, -5, 0, 5, 10].filter((mm) => Math.abs(mm) <= reach_mm);
  const raw = cut.points.map((p) => `M${x(p.out_mm).toFixed(1)} ${y(p.up_mm).toFixed(1)}h.01`).join('');
  const words = t('section_words', {
    points: cut.points.length,
    at: number(cut.at.at_mm, 1),
    u95: number(u95),
    confidence: number(cut.at.confidence),
  });
  const drag = (event: PointerEvent) => {
    if (!props.move || event.buttons !== 1) return;
    const box = (event.currentTarget as SVGSVGElement).getBoundingClientRect();
    const mm = (px: number, extent: number) =>
      ((px / extent) * size - size / 2) * (reach_mm / (size / 2 - 18));
    props.move({
      out_mm: mm(event.clientX - box.left, box.width),
      up_mm: -mm(event.clientY - box.top, box.height),
    });
  };
  return (
    <figure class="section">
      <svg
        viewBox={`0 0 ${size} ${size}`}
        role="img"
        aria-label={words}
        class={props.move ? 'movable' : ''}
        onPointerDown={drag}
        onPointerMove={drag}
      >
        <rect x="1" y="1" width={size - 2} height={size - 2} class="plot-ground" />
        {ticks.map((mm) => (
          <g key={mm} class="tick">
            <line x1={x(mm)} x2={x(mm)} y1={8} y2={size - 18} />
            <line y1={y(mm)} y2={y(mm)} x1={8} x2={size - 8} />
            <text x={x(mm)} y={size - 5} text-anchor="middle">
              {mm}
            </text>
            {mm !== 0 && (
              <text x={4} y={y(mm) + 4}>
                {mm}
              </text>
            )}
          </g>
        ))}
        <path d={raw} class="raw" />
        <circle cx={x(0)} cy={y(0)} r={Math.max(3, x(u95) - x(0))} class="u95" />
        <path d={`M${x(0) - 7} ${y(0)}h14M${x(0)} ${y(0) - 7}v14`} class="cross" />
        <line x1={x(0)} y1={y(0)} x2={x(6 * n.out)} y2={y(6 * n.up)} class="normal" />
        <text x={x(7 * n.out)} y={y(7 * n.up)} class="normal-word">
          n
        </text>
        {props.moved && (props.moved.out_mm !== 0 || props.moved.up_mm !== 0) && (
          <path
            d={`M${x(props.moved.out_mm) - 6} ${y(props.moved.up_mm) - 6}l12 12m0 -12l-12 12`}
            class="moved"
          />
        )}
        <text x={size - 10} y={18} text-anchor="end" class="axis">
          {t('section_axes')}
        </text>
      </svg>
      <figcaption>{words}</figcaption>
    </figure>
  );
}
