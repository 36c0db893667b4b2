// SPDX-License-Identifier: MIT
// What a sensor's unit has been through since it was first started, as rows of figures.
import type { Upkeep } from 'openapi';
import { amount, number, t } from '../words';

const hour_s = 3600;

/// None where the unit does not count.
export function upkeep_rows(upkeep: Upkeep | null | undefined): [string, string][] {
  if (!upkeep) return [];
  const { starts, boots, run_s, laser_s, lightings, frames, coldest_degc, hottest_degc } = upkeep;
  return [
    [t('unit_starts'), t('unit_starts_words', { starts: number(starts, 0), boots: number(boots, 0) })],
    [t('unit_run'), amount(run_s / hour_s, 'h', 1)],
    [
      t('unit_laser'),
      t('unit_laser_words', { hours: number(laser_s / hour_s, 2), times: number(lightings, 0) }),
    ],
    [t('unit_frames'), number(frames, 0)],
    [
      t('unit_degc'),
      coldest_degc === null || hottest_degc === null
        ? '–'
        : t('unit_degc_words', { coldest: number(coldest_degc, 1), hottest: number(hottest_degc, 1) }),
    ],
  ];
}
