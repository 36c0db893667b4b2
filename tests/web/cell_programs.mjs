// SPDX-License-Identifier: MIT
// The real programs with the simulated cell, for the tests of the page: started, named in a failure's report, ended.
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { check, failures, skip } from './browser.mjs';

const [bin, source] = process.argv.slice(2);
for (const name of ['biteline-cell', 'biteline-sensor', 'biteline-host', 'biteline-web']) {
  if (!existsSync(join(bin, name))) skip(`${name} was not built`);
}
if (!existsSync(join(bin, '../share/biteline/web/app.js'))) skip('the page was not built');
if (!spawnSync(join(bin, 'biteline-host'), ['--help'], { encoding: 'utf8' }).stdout.includes('--control')) skip('this biteline-host has no control end');
export const say = (text) => console.log(`${process.uptime().toFixed(1).padStart(6)} s  ${text}`);

export const out = mkdtempSync(join(tmpdir(), 'biteline-cell-'));
const started = [];

/// A program of this test; its lines are kept for the report of a failure.
export function run(name, args) {
  const child = spawn(join(bin, name), args, { stdio: ['ignore', 'pipe', 'pipe'] });
  const one = { name, child, lines: [], ended: false, wait: [] };
  for (const stream of [child.stdout, child.stderr]) {
    createInterface({ input: stream }).on('line', (line) => {
      one.lines.push(line);
      for (const waiter of one.wait) waiter(line);
    });
  }
  child.on('exit', () => {
    one.ended = true;
  });
  started.push(one);
  return one;
}

/// The first line that `wanted` accepts.
export function line_of(one, wanted, patience_s = 120) {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`${one.name}: no such line in ${patience_s} s:\n${one.lines.slice(-20).join('\n')}`)), 1000 * patience_s);
    const take = (line) => {
      const value = wanted(line);
      if (value === undefined) return;
      clearTimeout(timer);
      resolve(value);
    };
    one.wait.push(take);
    one.lines.forEach(take);
    one.child.on('exit', (status) => {
      clearTimeout(timer);
      reject(new Error(`${one.name} ended with ${status}:\n${one.lines.slice(-20).join('\n')}`));
    });
  });
}
export const json = (line) => (line.startsWith('{') ? JSON.parse(line) : undefined);

export function free_port() {
  return new Promise((resolve) => {
    const server = createServer().listen(0, '127.0.0.1', () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

async function finish(status) {
  for (const one of [...started].reverse()) {
    if (one.ended) continue;
    one.child.kill('SIGTERM');
    await Promise.race([new Promise((done) => one.child.on('exit', done)), new Promise((done) => setTimeout(done, 10_000))]);
    if (!one.ended) one.child.kill('SIGKILL');
  }
  if (status === 1) for (const one of started) console.log(`--- ${one.name}\n${one.lines.slice(-25).join('\n')}`);
  rmSync(out, { recursive: true, force: true });
  process.exit(status);
}

export class Busy extends Error {
  constructor(scans) {
    super(`none of ${scans} scans was whole: this machine is too busy for the simulated cell`);
  }
}

/// How long a thread of the programs was ready to run within half a second and had no processor: the worst one so far.
/// The kernel counts it (proc(5), schedstat).
const worst_wait = { of: '', s: 0 };
const waited_before = new Map();
function note_waits() {
  for (const { name, child, ended } of started) {
    if (ended) continue;
    const folder = `/proc/${child.pid}/task`;
    for (const thread of existsSync(folder) ? readdirSync(folder) : []) {
      try {
        const waited_s = Number(readFileSync(`${folder}/${thread}/schedstat`, 'utf8').split(' ')[1]) * 1e-9;
        const more_s = waited_s - (waited_before.get(thread) ?? 0);
        waited_before.set(thread, waited_s);
        if (more_s > worst_wait.s) Object.assign(worst_wait, { of: name, s: more_s });
      } catch {
        // It ended meanwhile.
      }
    }
  }
}
/// The arm's state may be a second old; a program that waits so long twice tells it too late.
const most_wait_s = 0.4;

/// The whole test to its verdict, the programs' end and this one's; a busy machine skips what has not failed.
export async function run_test(test) {
  const watch = setInterval(note_waits, 500);
  try {
    await test();
  } catch (error) {
    const busy = error instanceof Busy || worst_wait.s > most_wait_s;
    if (busy && failures() === 0) {
      say(`skipped: ${error.message}`);
      if (worst_wait.s > most_wait_s) say(`${worst_wait.of} was ready for ${worst_wait.s.toFixed(2)} s and had no processor: this machine is too busy`);
      await finish(77);
    }
    check(false, error.stack);
  }
  clearInterval(watch);
  say(failures() === 0 ? 'all good' : `${failures()} checks failed`);
  say(`longest wait for a processor in half a second: ${worst_wait.s.toFixed(2)} s (${worst_wait.of})`);
  await finish(failures() === 0 ? 0 : 1);
}

/// Ends a program and waits for its end.
export async function end(one, signal = 'SIGTERM') {
  if (one.ended) return;
  const gone = new Promise((done) => one.child.on('exit', done));
  one.child.kill(signal);
  await gone;
}

/// The simulated cell with its camera, arm and shoe; `more`: options of `biteline-cell serve`.
export async function start_world(folder, more) {
  const cell = run('biteline-cell', ['serve', '--arm', 'ur5e', '--out', folder, '--exit-with-parent', ...more]);
  return { cell, places: await line_of(cell, json) };
}

/// The sensor on the cell's devices, with real-time rights where there are any: then no other program on this machine
/// holds it up.
export async function start_sensor(places, more = []) {
  for (const rt of ['required', 'ignore']) {
    const sensor = run('biteline-sensor', ['--source', `board:${places.board}`, '--sensor', places.sensor, '--rt', rt, '--exit-with-parent', ...more]);
    try {
      return { sensor, endpoint: (await line_of(sensor, json)).endpoint };
    } catch (error) {
      if (rt === 'ignore') throw error;
    }
  }
}

/// Cell, sensor, service and web program; `add_to_gate`: lines of the process's gate, `host_more`: options of the service,
/// `shoe`: class and seed.  The service has jobs, so each start is one scan: nothing is scanned before somebody asks for it.
export async function start_cell({ add_to_gate, host_more = [], shoe: [kind, seed] = ['deep', '5'] }) {
  const { cell, places } = await start_world(join(out, 'cell'), ['--seed', seed, '--shoe', kind, '--size', '0', '--place', '0']);
  // It counts what it goes through, and keeps a scan on request; no pictures, so that the disk is no part of it.
  mkdirSync(join(out, 'unit'));
  const unit = ['--upkeep', join(out, 'unit'), '--record', join(out, 'kept'), '--record-asked', '--record-pictures', '0'];
  const { sensor, endpoint } = await start_sensor(places, unit);
  // Row 3, column 4 of T_base_shoe: the table's height, which an integrator knows of his cell.
  const table_z = readFileSync(join(out, 'cell/truth/T_base_shoe.txt'), 'utf8').split(/\s+/).filter(Boolean)[11];
  const control = `tcp://127.0.0.1:${await free_port()}`;
  const process_file = join(out, 'process.yaml');
  const rough = readFileSync(join(source, 'host/robot/path/processes/rough.yaml'), 'utf8');
  check(/\ngate:\n(  [^\n]*\n)+$/.test(rough), 'rough.yaml no longer ends with its gate');
  writeFileSync(process_file, rough + add_to_gate);
  const jobs = join(out, 'jobs.yaml');
  writeFileSync(jobs, 'jobs:\n  1: {}\n');
  const host_arguments = [
    '--sensor', endpoint, '--out', join(out, 'results'), '--robot', 'ur5e', '--process', process_file, '--table-z', table_z,
    '--rtde', places.rtde, '--script', places.script, '--dashboard', places.dashboard, '--send', '--control', control, '--jobs', jobs, '--exit-with-parent', ...host_more,
  ];
  const host = run('biteline-host', host_arguments);
  const port = await free_port();
  run('biteline-web', ['--listen', `127.0.0.1:${port}`, '--control', control, '--sensor', endpoint, '--exit-with-parent']);
  const address = `http://127.0.0.1:${port}/`;
  for (let turn = 0; ; ++turn) {
    try {
      await fetch(address);
      break;
    } catch (error) {
      if (turn > 240) throw error;
      await new Promise((done) => setTimeout(done, 250));
    }
  }
  say('the four programs run');
  return { address, host, host_arguments, process_file, cell, places, sensor, endpoint };
}
