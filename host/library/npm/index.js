// SPDX-License-Identifier: MIT
// Recorded scans and lines, from their bytes and text: for Node and for a browser.  The formats: docs/protocol.md, docs/formats.md.

/** Profiles with one of these flags stay out of a cloud; points likewise. */
export const NOT_USABLE = 0x1a3
export const NOT_SURFACE = 0x322

const FLOATS = ['x', 'y', 'z', 'sigma_mm', 'row_px', 'sigma_row_px', 'amplitude', 'width_px']
const INTEGERS = [['column', 1], ['point_flags', 0], ['peak_count', 0]]
const SENSOR_HELLO = 2
const PROFILE = 3
const END_OF_SCAN = 5
const MOST_POINTS = 5184
const DENSE = [1, 2, 3, 4]
const SPARSE = [0, 1, 2, 4]

const CRC = Uint32Array.from({length: 256}, (_, byte) => {
  let crc = byte
  for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (0x82f63b78 & -(crc & 1))
  return crc
})

/** CRC-32C, as RFC 3720 has it. */
function crc32c(bytes) {
  let crc = 0xffffffff
  for (const byte of bytes) crc = (crc >>> 8) ^ CRC[(crc ^ byte) & 0xff]
  return ~crc >>> 0
}

/** A FlatBuffers table; slots as in protocol.fbs.  What lies beyond the bytes is a RangeError of DataView. */
class Table {
  constructor(view, at) {
    this.view = view
    this.at = at
    this.vtable = at - view.getInt32(at, true)
  }
  place(slot) {
    const entry = 4 + 2 * slot
    if (entry + 2 > this.view.getUint16(this.vtable, true)) return 0
    const offset = this.view.getUint16(this.vtable + entry, true)
    return offset && this.at + offset
  }
  number(slot, kind) {
    const place = this.place(slot)
    return place ? this.view[`get${kind}`](place, true) : 0
  }
  big(slot, kind) {
    const place = this.place(slot)
    return place ? this.view[`get${kind}`](place, true) : 0n
  }
  motion(slot) {
    const place = this.need(slot)
    return Float64Array.from({length: 12}, (_, i) => this.view.getFloat64(place + 8 * i, true))
  }
  need(slot) {
    const place = this.place(slot)
    if (!place) throw new RangeError('a field is missing')
    return place
  }
  table(slot) {
    return new Table(this.view, this.follow(slot))
  }
  follow(slot) {
    const place = this.need(slot)
    return place + this.view.getUint32(place, true)
  }
  bytes(slot) {
    const at = this.follow(slot)
    return new Uint8Array(this.view.buffer, this.view.byteOffset + at + 4, this.view.getUint32(at, true))
  }
}

/** A packed column (docs/protocol.md, "A profile's numbers") as 32-bit words. */
function unpack(packed, count, lengths, step) {
  const values = new Uint32Array(count)
  let next = (count + 3) >> 2
  let predicted = 0
  for (let i = 0; i < count; ++i) {
    const length = lengths[(packed[i >> 2] >> (2 * (i & 3))) & 3]
    if (next + length > packed.length) throw new RangeError('a column is cut')
    let coded = 0
    for (let k = 0; k < length; ++k) coded |= packed[next + k] << (8 * k)
    next += length
    values[i] = predicted + ((coded >>> 1) ^ -(coded & 1))
    predicted = values[i] + step
  }
  return values
}

function profileOf(body, T_flange_cam) {
  const count = body.number(6, 'Uint32')
  if (count > MOST_POINTS) throw new RangeError('a profile of too many points')
  const profile = {
    sequence: Number(body.big(0, 'BigUint64')),
    exposure_mid_ns: body.big(2, 'BigInt64'),
    T_base_flange: body.motion(3),
    T_flange_cam,
    flags: body.number(5, 'Uint32'),
  }
  FLOATS.forEach((name, i) => {
    profile[name] = new Float32Array(unpack(body.bytes(7 + i), count, DENSE, 0).buffer)
  })
  INTEGERS.forEach(([name, step], i) => {
    profile[name] = Uint16Array.from(unpack(body.bytes(15 + i), count, SPARSE, step))
  })
  return profile
}

/** Each whole message's envelope, up to the first damage. */
function* messages(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
  for (let at = 8; at + 4 <= bytes.length; ) {
    const size = view.getUint32(at, true)
    at += 4
    if (size < 12 || at + size > bytes.length) return
    if (crc32c(bytes.subarray(at, at + size - 4)) !== view.getUint32(at + size - 4, true)) return
    const message = new DataView(bytes.buffer, bytes.byteOffset + at, size - 4)
    yield new Table(message, message.getUint32(0, true))
    at += size
  }
}

/** Reads the bytes of scan.btln.  A cut or damaged file gives what stands before the damage, and is not complete. */
export function readScan(bytes) {
  if (new TextDecoder().decode(bytes.subarray(0, 8)) !== 'BTLNSCAN')
    throw new Error('not a recorded scan: it does not begin with BTLNSCAN')
  const scan = {profiles: [], complete: false}
  let T_flange_cam = null
  try {
    for (const envelope of messages(bytes)) {
      const kind = envelope.number(3, 'Uint8')
      const body = envelope.table(4)
      if (kind === SENSOR_HELLO) T_flange_cam = body.table(9).motion(11)
      if (kind === PROFILE) scan.profiles.push(profileOf(body, T_flange_cam))
      if (kind === END_OF_SCAN) scan.complete = endsWell(body, scan.profiles)
    }
  } catch (error) {
    if (!(error instanceof RangeError)) throw error // damage behind a good checksum
  }
  return scan
}

/** It ended by itself, and no profile is missing. */
function endsWell(body, profiles) {
  return body.number(0, 'Uint16') === 0 && profiles.every((profile, i) => profile.sequence === i)
}

function apply(T, [x, y, z]) {
  return [0, 1, 2].map((row) => T[3 * row] * x + T[3 * row + 1] * y + T[3 * row + 2] * z + T[9 + row])
}

/** The surface's points of a profile, [x, y, z] in base, mm; none of one that is not usable. */
export function pointsBase(profile) {
  const points = []
  if (profile.flags & NOT_USABLE || !profile.T_flange_cam) return points
  for (let i = 0; i < profile.x.length; ++i) {
    if (profile.point_flags[i] & NOT_SURFACE) continue
    points.push(apply(profile.T_base_flange, apply(profile.T_flange_cam, [profile.x[i], profile.y[i], profile.z[i]])))
  }
  return points
}

/** Reads the text of a result folder's line.csv: a closed line, one object for each point. */
export function readLine(text) {
  const rows = text.split('\n').filter((row) => row.trim() && !row.startsWith('#'))
  const points = rows.map((row, i) => {
    const fields = row.split(',')
    const numbers = fields.slice(0, 10).map(Number)
    if (numbers.length < 10 || numbers.some((number) => !Number.isFinite(number)))
      throw new Error(`line.csv, row ${i + 1}: ten numbers expected`)
    const u95 = fields[10]?.trim()
    return {
      position_mm: numbers.slice(0, 3),
      normal: numbers.slice(3, 6),
      tangent: numbers.slice(6, 9),
      confidence: numbers[9],
      u95_mm: u95 ? Number(u95) : null,
    }
  })
  if (points.length < 3) throw new Error('line.csv: at least 3 rows expected')
  return points
}
