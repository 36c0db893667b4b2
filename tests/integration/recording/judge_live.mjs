// SPDX-License-Identifier: MIT
// judge_live.mjs WEB FILE [FILE...]: @mcap/core (in WEB's packages) reads a sensor's own recordings with all check sums, and of
// each beginning all before the cut.  Prints {topic: messages} for each file.  Leaves with 77 without the packages.
import assert from "node:assert/strict";
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [web, ...files] = process.argv.slice(2);
let mcap;
try {
  mcap = createRequire(path.join(web, "package.json"))("@mcap/core");
} catch {
  console.log("skipped: no packages; run npm ci in host/web");
  process.exit(77);
}

function read(bytes) {
  const reader = new mcap.McapStreamReader({ validateCrcs: true });
  reader.append(bytes);
  const topics = new Map(), found = {}, attached = {};
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === "Channel") topics.set(record.id, record.topic);
    if (record.type === "Message") found[topics.get(record.channelId)] = (found[topics.get(record.channelId)] ?? 0) + 1;
    if (record.type === "Attachment") attached[record.name] = Buffer.from(record.data).toString();
  }
  return { found, attached, whole: reader.done() };
}

for (const file of files) {
  const bytes = fs.readFileSync(file);
  const all = read(bytes);
  assert(all.whole, `${file}: the file has its end`);
  assert.match(all.attached["recording.yaml"], /^complete: true$/m);
  let before = 0;
  for (const share of [0.4, 0.7, 0.95]) {
    const left = read(bytes.subarray(0, Math.floor(bytes.length * share)));
    const pictures = left.found["/cam0/image"] ?? 0;
    assert(!left.whole);
    assert.match(left.attached["recording.yaml"], /^complete: false$/m);
    assert(pictures >= before && pictures < all.found["/cam0/image"], `${share}: ${pictures} pictures`);
    before = pictures;
  }
  assert(before > 0, "a cut file has pictures");
  console.log(JSON.stringify(all.found));
}
