// SPDX-License-Identifier: MIT
/** Row by row, then the translation in mm. */
export type Motion = Float64Array

/** One stripe; the arrays are of equal length.  Units and flags: docs/protocol.md. */
export interface Profile {
  sequence: number
  exposure_mid_ns: bigint
  T_base_flange: Motion
  T_flange_cam: Motion | null
  flags: number
  /** In the camera's frame, mm. */
  x: Float32Array
  y: Float32Array
  z: Float32Array
  sigma_mm: Float32Array
  row_px: Float32Array
  sigma_row_px: Float32Array
  amplitude: Float32Array
  width_px: Float32Array
  column: Uint16Array
  point_flags: Uint16Array
  peak_count: Uint16Array
}

export interface Scan {
  profiles: Profile[]
  /** Its end is there, it ended by itself, and no profile is missing. */
  complete: boolean
}

export interface LinePoint {
  position_mm: [number, number, number]
  normal: [number, number, number]
  tangent: [number, number, number]
  confidence: number
  /** null: not known. */
  u95_mm: number | null
}

export const NOT_USABLE: number
export const NOT_SURFACE: number
/** Throws an Error for bytes that are no recorded scan. */
export function readScan(bytes: Uint8Array): Scan
export function pointsBase(profile: Profile): [number, number, number][]
/** Throws an Error that names the row. */
export function readLine(text: string): LinePoint[]
