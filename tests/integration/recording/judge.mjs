// SPDX-License-Identifier: MIT
// judge.mjs BITELINE SESSION WEB: @mcap/core (in WEB's packages) reads what the tool writes, and the tool what @mcap/core
// writes.  Leaves with 77 (skipped) without the packages.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { createHash } from "node:crypto";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";

const [tool, session, web] = process.argv.slice(2);
const load = createRequire(path.join(web, "package.json"));
let mcap, zstd;
try {
  mcap = load("@mcap/core");
  zstd = load("@foxglove/wasm-zstd");
} catch {
  console.log("skipped: no packages; run npm ci in host/web");
  process.exit(77);
}
await zstd.isLoaded;
const decompressHandlers = { zstd: (data, size) => zstd.decompress(data, Number(size)) };
const KINDS = ["Header", "Footer", "Schema", "Channel", "Message", "Chunk", "MessageIndex", "ChunkIndex", "Attachment",
  "AttachmentIndex", "Statistics", "Metadata", "MetadataIndex", "SummaryOffset", "DataEnd"];
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "biteline-mcap-"));
process.on("exit", () => fs.rmSync(folder, { recursive: true, force: true }));

const run = (...args) => spawnSync(tool, args, { encoding: "utf8" });
function must(...args) {
  const done = run(...args);
  assert.equal(done.status, 0, `${args.join(" ")}: ${done.stderr}`);
  return done.stdout;
}
const verdict = (file) => JSON.parse(must("record", "verify", file, "--json"));

function records(bytes) {
  const reader = new mcap.McapStreamReader({ includeChunks: true, decompressHandlers, validateCrcs: true });
  reader.append(bytes);
  const all = [];
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    // Data belong to the reader's buffer.
    all.push(record.data ? { ...record, data: new Uint8Array(record.data) } : record);
  }
  assert(reader.done(), "the file is complete");
  return all;
}

/// As `biteline record verify` tells them.
function topics(all) {
  const channels = new Map(), found = {};
  for (const record of all) {
    if (record.type === "Channel") channels.set(record.id, record.topic);
    if (record.type !== "Message") continue;
    const topic = (found[channels.get(record.channelId)] ??= { messages: 0, sha: createHash("sha256") });
    topic.messages += 1;
    topic.sha.update(record.data);
  }
  return Object.fromEntries(Object.entries(found).sort().map(([name, t]) => [name, { messages: t.messages, sha256: t.sha.digest("hex") }]));
}

async function readIndexed(bytes) {
  const readable = { size: async () => BigInt(bytes.length), read: async (at, size) => bytes.subarray(Number(at), Number(at + size)) };
  return mcap.McapIndexedReader.Initialize({ readable, decompressHandlers });
}

async function theirsReadsOurs(file) {
  const bytes = fs.readFileSync(file);
  const all = records(bytes);
  for (const kind of KINDS) assert(all.some((record) => record.type === kind), `a ${kind}`);
  assert.deepEqual(topics(all), verdict(file).topics);
  const indexed = await readIndexed(bytes);
  let messages = 0, last = -1n;
  for await (const message of indexed.readMessages()) {
    assert(message.logTime >= last, "by time");
    last = message.logTime;
    messages += 1;
  }
  assert.equal(BigInt(messages), indexed.statistics.messageCount);
  assert.equal(messages, verdict(file).messages);
  const window = [];
  for await (const message of indexed.readMessages({ topics: ["/cam0/image"], startTime: 1700000001230000000n, endTime: 1700000001250000000n }))
    window.push(message.logTime);
  assert.equal(window.length, 3, "the index finds three pictures");
  const files = [];
  for await (const attachment of indexed.readAttachments({ name: "cam0/sensor.yaml" })) files.push(Buffer.from(attachment.data));
  assert.deepEqual(files, [fs.readFileSync(path.join(session, "cam0/sensor.yaml"))]);
  const build = [];
  for await (const metadata of indexed.readMetadata({ name: "biteline.build" })) build.push(metadata.metadata.get("program"));
  assert.match(build[0], /^biteline \d/);
  console.log(`theirs reads ours: ${all.length} records of ${new Set(all.map((r) => r.type)).size} kinds, ${messages} messages`);
  return all;
}

function theyNoticeAFlip(file) {
  const bytes = fs.readFileSync(file);
  const at = bytes.indexOf("\x89PNG", 0, "latin1") + 1000;  // in a stored picture
  bytes[at] ^= 1;
  assert.throws(() => records(bytes), /CRC/i);
}

/// The same messages, files and facts through their writer.
async function written(all, options) {
  const parts = [];
  let size = 0n;
  const writable = { position: () => size, write: async (part) => { parts.push(Buffer.from(part)); size += BigInt(part.length); } };
  const writer = new mcap.McapWriter({ writable, ...options });
  await writer.start({ profile: "", library: "another" });
  const schemas = new Map([[0, 0]]), channels = new Map();
  for (const record of all) {
    if (record.type === "Footer" || record.type === "DataEnd") break;
    if (record.type === "Schema" && !schemas.has(record.id)) schemas.set(record.id, await writer.registerSchema(record));
    if (record.type === "Channel" && !channels.has(record.id))
      channels.set(record.id, await writer.registerChannel({ ...record, schemaId: schemas.get(record.schemaId) }));
    if (record.type === "Message") await writer.addMessage({ ...record, channelId: channels.get(record.channelId) });
    if (record.type === "Attachment") await writer.addAttachment(record);
    if (record.type === "Metadata" && record.name !== "biteline.chain") await writer.addMetadata(record);
  }
  await writer.end();
  return Buffer.concat(parts);
}

const tree = (root) => fs.readdirSync(root, { recursive: true }).filter((name) => fs.statSync(path.join(root, name)).isFile()).sort();

async function oursReadsTheirs(all, name, options) {
  const file = path.join(folder, `${name}.mcap`), out = path.join(folder, name);
  const bytes = await written(all, options);
  fs.writeFileSync(file, bytes);
  const told = verdict(file);
  assert.deepEqual(told.topics, topics(all), name);
  assert.equal(told.library, "another");
  assert.equal(told.links, 0);
  assert.equal(told.attachments, all.filter((r) => r.type === "Attachment").length);
  must("record", "import", file, "--out", out);
  const direct = path.join(folder, "direct");
  assert.deepEqual(tree(out), tree(direct));
  for (const one of tree(out)) assert(fs.readFileSync(path.join(out, one)).equals(fs.readFileSync(path.join(direct, one))), one);
  // A byte in the middle of the messages.
  const spoiled = Buffer.from(bytes);
  spoiled[Math.floor(bytes.length / 3)] ^= 4;
  fs.writeFileSync(file, spoiled);
  const found = run("record", "verify", file);
  assert.equal(found.status, 3, `${name}: ${found.stdout}`);
  console.log(`ours reads theirs, ${name}: ${bytes.length} bytes; a flipped one: ${found.stderr.trim().split(": ").slice(1).join(": ")}`);
}

const packed = path.join(folder, "packed.mcap"), stored = path.join(folder, "stored.mcap");
must("record", "export", session, "--out", packed);
must("record", "export", session, "--out", stored, "--stored");
must("record", "import", packed, "--out", path.join(folder, "direct"));
await theirsReadsOurs(packed);
const all = await theirsReadsOurs(stored);
theyNoticeAFlip(stored);
await oursReadsTheirs(all, "plain", {});
await oursReadsTheirs(all, "zstd", { compressChunk: (data) => ({ compression: "zstd", compressedData: new Uint8Array(zstd.compress(data, 3)) }) });
await oursReadsTheirs(all, "one-chunk", { chunkSize: 1 << 26 });
await oursReadsTheirs(all, "no-chunks", { useChunks: false });
await oursReadsTheirs(all, "bare", { useStatistics: false, useSummaryOffsets: false, useMessageIndex: false, useChunkIndex: false,
  useAttachmentIndex: false, useMetadataIndex: false, repeatSchemas: false, repeatChannels: false });
