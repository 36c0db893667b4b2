// SPDX-License-Identifier: MIT
// read_scan.mjs READER SCAN.btln LINE.csv: what the npm package reads, as JSON for installed_test.py.
import {readFileSync} from 'node:fs'

const [, , reader, scanFile, lineFile] = process.argv
const {pointsBase, readLine, readScan} = await import(reader)
const scan = readScan(readFileSync(scanFile))
const points = scan.profiles.flatMap(pointsBase)
const line = readLine(readFileSync(lineFile, 'utf8'))
let refused = ''
try {
  readScan(new Uint8Array(64))
} catch (error) {
  refused = error.message
}
console.log(
  JSON.stringify({
    profiles: scan.profiles.length,
    complete: scan.complete,
    points: points.length,
    mean: [0, 1, 2].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length),
    line: line.length,
    first: line[0].position_mm,
    refused,
  }),
)
