// SPDX-License-Identifier: MIT
// ros2_messages.mjs WEB FILE: the CDR messages of an MCAP file as JSON, by topic, read by the ROS 2 definitions that the
// file itself carries (OMG CDR, little-endian).  @mcap/core in WEB's packages reads the file; leaves with 77 without it.
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [web, file] = process.argv.slice(2);
const load = createRequire(path.join(web, "package.json"));
let mcap, zstd;
try {
  mcap = load("@mcap/core");
  zstd = load("@foxglove/wasm-zstd");
} catch {
  process.exit(77);
}
await zstd.isLoaded;

/// Of each type its fields, by its full name and by the last part of it.
function definitions(name, text) {
  const all = new Map();
  const parts = text.split(/={10,}\n/).map((part, i) => (i === 0 ? [name, part] : [/^MSG: (\S+)\n/.exec(part)[1], part.replace(/^MSG: .*\n/, "")]));
  for (const [type, lines] of parts) {
    const fields = lines.split("\n").filter((line) => line.trim() && !line.startsWith("#")).map((line) => {
      const [, kind, many, field] = /^(\S+?)(\[\])? (\S+)$/.exec(line);
      return { kind, many: Boolean(many), field };
    });
    for (const key of [type, type.split("/").at(-1)]) all.set(key, fields);
  }
  return all;
}

const sizes = { bool: 1, uint8: 1, int32: 4, uint32: 4, float64: 8 };
class Cdr {
  constructor(data) {
    this.view = new DataView(data.buffer, data.byteOffset, data.byteLength);
    if (this.view.getUint16(0) !== 1) throw new Error("little-endian CDR expected");
    this.at = 4;
  }
  plain(kind) {
    const size = sizes[kind];
    this.at = 4 + Math.ceil((this.at - 4) / size) * size;
    const at = this.at;
    this.at += size;
    const { view } = this;
    return { bool: () => view.getUint8(at) !== 0, uint8: () => view.getUint8(at), int32: () => view.getInt32(at, true), uint32: () => view.getUint32(at, true), float64: () => view.getFloat64(at, true) }[kind]();
  }
  value(kind, known) {
    if (kind in sizes) return this.plain(kind);
    if (kind === "string") {
      const length = this.plain("uint32");
      const text = Buffer.from(this.view.buffer, this.view.byteOffset + this.at, length - 1).toString();
      if (this.view.getUint8(this.at + length - 1) !== 0) throw new Error("a text without its end");
      this.at += length;
      return text;
    }
    return this.message(known.get(kind), known);
  }
  message(fields, known) {
    const out = {};
    for (const { kind, many, field } of fields) {
      if (!many) out[field] = this.value(kind, known);
      else out[field] = Array.from({ length: this.plain("uint32") }, () => this.value(kind, known));
    }
    return out;
  }
}

const reader = new mcap.McapStreamReader({ decompressHandlers: { zstd: (data, size) => zstd.decompress(data, Number(size)) }, validateCrcs: true });
reader.append(fs.readFileSync(file));
const schemas = new Map(), channels = new Map(), told = {};
for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
  if (record.type === "Schema") schemas.set(record.id, { name: record.name, encoding: record.encoding, text: Buffer.from(record.data).toString() });
  if (record.type === "Channel") channels.set(record.id, record);
  const channel = record.type === "Message" ? channels.get(record.channelId) : null;
  if (channel?.messageEncoding !== "cdr" || channel.topic === "/cam0/image") continue;
  const { name, encoding, text } = schemas.get(channel.schemaId);
  if (encoding !== "ros2msg") throw new Error(`${channel.topic}: ros2msg expected`);
  const known = definitions(name, text);
  const cdr = new Cdr(record.data);
  const message = cdr.message(known.get(name), known);
  if (cdr.at !== record.data.byteLength) throw new Error(`${channel.topic}: ${record.data.byteLength - cdr.at} bytes too many`);
  (told[channel.topic] ??= []).push(message);
}
console.log(JSON.stringify(told));
