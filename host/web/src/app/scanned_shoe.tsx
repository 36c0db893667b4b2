// SPDX-License-Identifier: MIT
// The one picture of the operator's screen: the shoe as it comes in, then with its line.
import type { JSX } from 'preact';
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import type { ScanRow } from 'openapi';
import type { Scene } from '../viewer/scene';
import { Stage } from '../viewer/stage';
import { type View, unpack } from '../viewer/view_data';
import { t } from '../words';
import { watch_live } from './live_data';
import { LiveScene } from './live_scene';
import { use_view } from './scan_view';

/// The cloud as it grows.
function Incoming(): JSX.Element {
  const box = useRef<HTMLDivElement>(null);
  const [without, set_without] = useState('');
  useEffect(() => {
    if (!box.current) return;
    let scene: LiveScene;
    try {
      scene = new LiveScene(box.current);
    } catch {
      set_without(t('no_webgl'));
      return;
    }
    const stop = watch_live((message) => {
      if (message.kind === 'cloud') scene.add_cloud(message.scan, message.points);
      else if (message.kind === 'line') scene.set_line(message.values);
      else if (message.kind === 'arm') scene.move_tip(message.tip_mm);
    });
    return () => {
      stop();
      scene.dispose();
    };
  }, []);
  return (
    <div class="stage" ref={box} role="img" aria-label={t('live_cloud')}>
      {without && <p class="notice refused">{without}</p>}
    </div>
  );
}

/// What there is to look at of a finished scan, unpacked.
export function use_shoe(scan: ScanRow | null): { view: View | null; error: string } {
  const finished = scan !== null && scan.verdict !== 'working';
  const { data, error } = use_view(finished ? scan.id : null, scan?.line_version);
  const view = useMemo(() => (data ? unpack(data) : null), [data]);
  return { view, error };
}

export function ShoePicture(props: {
  scan: ScanRow | null;
  shoe: { view: View | null; error: string };
  scanning?: boolean;
  begun?: (scene: Scene | null) => void;
}): JSX.Element {
  const { scan, shoe } = props;
  const finished = scan !== null && scan.verdict !== 'working';
  return (
    <figure class="viewer shoe" aria-label={t('work_picture')}>
      {props.scanning ? (
        <Incoming />
      ) : shoe.view ? (
        <Stage key={`${scan?.id} ${scan?.line_version ?? 0}`} view={shoe.view} begun={props.begun} />
      ) : (
        <p class="quiet">{shoe.error || (finished ? t('waits') : t('work_none'))}</p>
      )}
    </figure>
  );
}

export function ScannedShoe({ scan }: { scan: ScanRow }): JSX.Element {
  return <ShoePicture scan={scan} shoe={use_shoe(scan)} />;
}
