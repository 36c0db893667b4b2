// SPDX-License-Identifier: MIT
// The result viewer: used by the page, and by itself in a result folder without any server.
import type { ComponentChildren, JSX } from 'preact';
import { useEffect, useMemo, useState } from 'preact/hooks';
import { number, t, t_or } from '../words';
import { gradient } from './colours';
import { Gates, failed_gates } from './gates';
import { type Layer, type LineColour, type Scene, type ViewName, line_scale } from './scene';
import { SectionPlot } from './section_plot';
import { Stage, index_at, names_of } from './stage';
import {
  type Hand,
  type ResultFile,
  type SectionPoint,
  type View,
  type ViewData,
  difference,
  in_base,
  plus,
  section,
  u95_of_confidence_mm,
  unpack,
} from './view_data';

const views: ViewName[] = ['fit', 'top', 'left', 'right', 'toe', 'heel'];
const layers: Layer[] = ['cloud', 'line', 'path', 'weak', 'candidates', 'other', 'names'];
const section_half_mm = 0.6;

export function Toggle(props: {
  on: boolean;
  change: (on: boolean) => void;
  children: ComponentChildren;
}): JSX.Element {
  return (
    <button type="button" class="toggle" aria-pressed={props.on} onClick={() => props.change(!props.on)}>
      <span aria-hidden="true">{props.on ? '☑' : '☐'}</span> {props.children}
    </button>
  );
}

function ColourBar({ view, by }: { view: View; by: LineColour }): JSX.Element {
  if (by === 'source') {
    return <p class="colour-bar">{t('source_key')}</p>;
  }
  const scale = line_scale(view, by);
  return (
    <div
      class="colour-bar"
      role="img"
      aria-label={`${t(`colour_${by}`)}: ${number(scale.low, 1)} – ${number(scale.high, 1)} ${scale.unit}`}
    >
      <span>
        {t(`colour_${by}`)} {number(scale.low, 1)}
      </span>
      <span class="gradient" style={{ background: gradient }} />
      <span>
        {number(scale.high, 1)} {scale.unit}
      </span>
    </div>
  );
}

/// `told`: the page around it has said already what to look at and what to do.
export function Viewer(props: {
  data: ViewData;
  files: ResultFile[];
  file_base?: string;
  told?: boolean;
  /// Another scan to compare with.
  other?: { name: string; data: ViewData } | null;
  /// Told of the chosen place, moved by hand; with it the section's point may be moved.
  hand?: (hand: Hand) => void;
}): JSX.Element {
  const view = useMemo(() => unpack(props.data), [props.data]);
  const other = useMemo(() => (props.other ? unpack(props.other.data) : null), [props.other]);
  const apart = useMemo(() => (other ? difference(view, other) : null), [view, other]);
  const [scene, set_scene] = useState<Scene | null>(null);
  const [hidden, set_hidden] = useState<Layer[]>([]);
  const [by, set_by] = useState<LineColour>('confidence');
  const [cloud_by, set_cloud_by] = useState<'grey' | 'height'>('grey');
  const [chosen, set_chosen] = useState(0);
  const [reach_mm, set_reach_mm] = useState(12);
  const [moved, set_moved] = useState<SectionPoint>({ out_mm: 0, up_mm: 0 });
  const weak = view.data.report.weak_stretches ?? [];
  const gates = view.data.report.gates ?? [];
  const has_line = view.line.length > 2;

  const begun = (made: Scene | null) => {
    set_scene(made);
    if (!made) return;
    made.on_pick = set_chosen;
    if (weak.length > 0) set_chosen(index_at(view, weak[0]!.from_mm + weak[0]!.length_mm / 2));
  };
  useEffect(() => scene?.colour_line(by), [by, scene]);
  useEffect(() => scene?.colour_cloud(cloud_by), [cloud_by, scene]);
  useEffect(() => scene?.compare(apart && other ? other.line.map((p) => p.shoe) : []), [other, apart, scene]);
  useEffect(() => scene?.choose(has_line ? chosen : null, reach_mm), [chosen, reach_mm, scene, has_line]);
  const cut = useMemo(
    () =>
      has_line ? section(view, Math.min(chosen, view.line.length - 1), section_half_mm, reach_mm) : null,
    [view, chosen, reach_mm, has_line],
  );

  useEffect(() => set_moved({ out_mm: 0, up_mm: 0 }), [chosen, view]);
  useEffect(() => {
    if (!cut || !props.hand) return;
    const shoe = plus(plus(cut.at.shoe, cut.out, moved.out_mm), cut.up, moved.up_mm);
    props.hand({ at_mm: cut.at.at_mm, base: in_base(view, shoe) });
  }, [cut, moved, view]);

  const show = (layer: Layer, on: boolean) => {
    set_hidden(on ? hidden.filter((name) => name !== layer) : [...hidden, layer]);
    scene?.show(layer, on);
  };
  const present = layers.filter(
    (layer) =>
      (layer !== 'path' || view.path.length > 1) &&
      (layer !== 'weak' || weak.length > 0) &&
      (layer !== 'candidates' || view.candidates.length > 0) &&
      (layer !== 'other' || apart !== null) &&
      (layer !== 'cloud' || view.cloud.length > 0) &&
      (layer !== 'line' || has_line) &&
      (layer !== 'names' || names_of(view).length > 0),
  );
  const at = has_line ? view.line[Math.min(chosen, view.line.length - 1)]! : null;

  return (
    <div class="viewer">
      {!props.told && view.data.found && weak.length > 0 && (
        <p class="notice look">
          <strong>{t('look')}</strong>{' '}
          {t('weak_total', {
            count: weak.length,
            mm: number(
              weak.reduce((sum, w) => sum + w.length_mm, 0),
              1,
            ),
          })}
        </p>
      )}
      {!props.told && !view.data.found && view.data.report.next_step && (
        <p class="notice refused">
          <strong>{t('next_step')}</strong> {view.data.report.next_step}
        </p>
      )}
      <div class="tools" role="toolbar" aria-label={t('views')}>
        {views.map((name) => (
          <button type="button" key={name} onClick={() => scene?.look(name)}>
            {t(`view_${name}`)}
          </button>
        ))}
        <button type="button" aria-label={t('zoom_in')} onClick={() => scene?.zoom(1.4)}>
          +
        </button>
        <button type="button" aria-label={t('zoom_out')} onClick={() => scene?.zoom(1 / 1.4)}>
          −
        </button>
      </div>
      <div class="tools" role="toolbar" aria-label={t('layers')}>
        {present.map((layer) => (
          <Toggle key={layer} on={!hidden.includes(layer)} change={(on) => show(layer, on)}>
            {t(`layer_${layer}`)}
          </Toggle>
        ))}
        {has_line && (
          <label>
            {t('line_colour')}{' '}
            <select value={by} onChange={(e) => set_by(e.currentTarget.value as LineColour)}>
              {(['confidence', 'u95', 'height', 'source'] as LineColour[]).map((name) => (
                <option key={name} value={name}>
                  {t(`colour_${name}`)}
                </option>
              ))}
            </select>
          </label>
        )}
        {view.cloud.length > 0 && (
          <label>
            {t('cloud_colour')}{' '}
            <select
              value={cloud_by}
              onChange={(e) => set_cloud_by(e.currentTarget.value as 'grey' | 'height')}
            >
              <option value="grey">{t('colour_grey')}</option>
              <option value="height">{t('colour_height')}</option>
            </select>
          </label>
        )}
      </div>
      <Stage view={view} begun={begun} />
      {has_line && <ColourBar view={view} by={by} />}
      {view.candidates.length > 0 && <p class="colour-bar">{t('failed_places')}</p>}
      {gates.length > 0 && failed_gates(gates).length > 0 && <Gates gates={gates} />}
      {cloud_by === 'height' && view.cloud.length > 0 && (
        <div class="colour-bar">
          <span>
            {t('layer_cloud')}: {t('colour_height')} {number(0, 0)}
          </span>
          <span class="gradient" style={{ background: gradient }} />
          <span>{number(view.high[2] - view.low[2], 0)} mm</span>
        </div>
      )}
      {view.data.cloud && view.data.cloud.every > 1 && (
        <p class="quiet">
          {t('thinned', { every: view.data.cloud.every, of: view.data.cloud.of.toLocaleString() })}
        </p>
      )}
      {props.other && (
        <p class="notice">
          {apart
            ? t('difference', {
                name: props.other.name,
                mean: number(apart.mean_mm, 2),
                p95: number(apart.p95_mm, 2),
                max: number(apart.max_mm, 2),
                at: number(apart.max_at_mm, 0),
              })
            : t('no_difference', { name: props.other.name })}
        </p>
      )}
      {at && cut && (
        <section class="two">
          <div>
            <h3>{t('section')}</h3>
            <label class="wide">
              {t('along_line')} {number(at.at_mm, 1)} mm / {number(view.length_mm, 1)} mm
              <input
                type="range"
                min={0}
                max={view.line.length - 1}
                step={1}
                value={chosen}
                onInput={(e) => set_chosen(Number(e.currentTarget.value))}
              />
            </label>
            <label>
              {t('section_reach')}{' '}
              <select value={reach_mm} onChange={(e) => set_reach_mm(Number(e.currentTarget.value))}>
                {[4, 8, 12, 20].map((mm) => (
                  <option key={mm} value={mm}>
                    ± {mm} mm
                  </option>
                ))}
              </select>
            </label>{' '}
            <button type="button" onClick={() => scene?.look_at(chosen)}>
              {t('look_here')}
            </button>
            <dl class="figures">
              <dt>{t('place_base')}</dt>
              <dd>{at.base.map((v) => number(v, 2)).join(', ')} mm</dd>
              <dt>{t('colour_confidence')}</dt>
              <dd>{number(at.confidence, 2)}</dd>
              <dt>{t('u95_words')}</dt>
              <dd>
                {at.u95_mm === null
                  ? `${t('about')} ${number(u95_of_confidence_mm(at.confidence), 2)}`
                  : number(at.u95_mm, 2)}{' '}
                mm
              </dd>
              <dt>{t('colour_source')}</dt>
              <dd>{t_or(`source_${at.source}`, at.source)}</dd>
            </dl>
          </div>
          <div>
            <SectionPlot
              cut={cut}
              reach_mm={reach_mm}
              moved={moved}
              move={props.hand ? set_moved : undefined}
            />
            {props.hand && (
              <div class="tools">
                {(['out_mm', 'up_mm'] as const).map((axis) => (
                  <label key={axis}>
                    {t(`move_${axis}`)}{' '}
                    <input
                      type="number"
                      step={0.1}
                      min={-20}
                      max={20}
                      value={Number(moved[axis].toFixed(2))}
                      onInput={(e) => set_moved({ ...moved, [axis]: Number(e.currentTarget.value) || 0 })}
                    />
                  </label>
                ))}
              </div>
            )}
          </div>
        </section>
      )}
      {has_line && (
        <section>
          <h3>{t('weak_stretches')}</h3>
          {weak.length === 0 && <p>{t('weak_none')}</p>}
          {weak.length > 0 && (
            <ol class="cards">
              {weak.map((stretch) => (
                <li key={stretch.from_mm}>
                  <span>
                    <strong>{stretch.place}</strong>:{' '}
                    {t('weak_row', {
                      from: number(stretch.from_mm, 1),
                      length: number(stretch.length_mm, 1),
                      error: (stretch.u95_is_guessed ? `${t('about')} ` : '') + number(stretch.u95_mm, 2),
                      confidence: number(stretch.least_confidence, 2),
                    })}
                  </span>
                  <button
                    type="button"
                    onClick={() => {
                      const index = index_at(view, stretch.from_mm + stretch.length_mm / 2);
                      set_chosen(index);
                      scene?.look_at(index);
                    }}
                  >
                    {t('look_here')}
                  </button>
                </li>
              ))}
            </ol>
          )}
        </section>
      )}
      {props.files.length > 0 && (
        <section>
          <h3>{t('files')}</h3>
          <ul class="files">
            {props.files.map((file) => (
              <li key={file.file}>
                <a href={(props.file_base ?? '') + file.file}>
                  {t_or(`file_${file.file.replace(/\W/g, '_')}`, file.words)}
                </a>{' '}
                <span class="quiet">
                  {file.file}, {bytes(file.bytes)}
                </span>
              </li>
            ))}
          </ul>
        </section>
      )}
    </div>
  );
}

function bytes(count: number): string {
  return count > 2e6 ? `${number(count / 1e6, 1)} MB` : `${number(count / 1e3, 1)} kB`;
}
