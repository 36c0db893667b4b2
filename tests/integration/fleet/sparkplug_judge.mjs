// SPDX-License-Identifier: MIT
// sparkplug_judge.mjs WEB rebirth: the command that asks for a birth, as hex.
// sparkplug_judge.mjs WEB read: lines "TOPIC HEX" on stdin, as JSON lines.
// Both by sparkplug-payload (in WEB's packages).  Leaves with 77 (skipped) without it.
import { createRequire } from "node:module";
import path from "node:path";
import readline from "node:readline";

const [web, task] = process.argv.slice(2);
let codec;
try {
  codec = createRequire(path.join(web, "package.json"))("sparkplug-payload").get("spBv1.0");
} catch {
  console.log("skipped: no packages; run npm ci in host/web");
  process.exit(77);
}
if (task === "rebirth") {
  const metrics = [{ name: "Node Control/Rebirth", type: "Boolean", value: true }];
  console.log(Buffer.from(codec.encodePayload({ timestamp: Date.now(), seq: 0, metrics })).toString("hex"));
} else {
  for await (const line of readline.createInterface({ input: process.stdin })) {
    const [topic, hex] = line.split(" ");
    const payload = codec.decodePayload(Buffer.from(hex, "hex"));
    const plain = (value) => (value instanceof Date ? value.getTime() : typeof value?.toNumber === "function" ? value.toNumber() : value);
    const metrics = Object.fromEntries(payload.metrics.map((one) => [one.name, { type: one.type, value: plain(one.value) ?? null }]));
    console.log(JSON.stringify({ topic, seq: payload.seq === undefined ? null : plain(payload.seq), metrics }));
  }
}
