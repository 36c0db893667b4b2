// SPDX-License-Identifier: MIT
// What the sensor says of itself some times a second: JSON, as openapi.yaml's /live describes it.
import type { Setting } from './sensor_settings';
import type { Upkeep } from './upkeep';

export interface SensorState {
  name: string;
  version: string;
  simulated: boolean;
  recording: boolean;
  scanning: boolean;
  laser: 'on' | 'off' | 'fault';
  laser_reason: string;
  region_px: [number, number, number, number];
  frames: number;
  frames_lost: number;
  frames_damaged: number;
  profiles: number;
  triggered_by_software: boolean;
  temperature_degc?: number;
  rate_max_hz?: number;
  changes?: number;
  trigger?: { edges: number; edges_missed: number; frames_without_edge: number };
  upkeep?: Upkeep;
  settings?: Setting[];
}
