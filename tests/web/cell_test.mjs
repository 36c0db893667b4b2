// SPDX-License-Identifier: MIT
// The whole way in a browser: first account, login, control, a scan of the simulated cell, decision, the arm follows it;
// a second browser watches; the service is killed and comes back.  Real: sensor, service, web program, page.
// cell_test.mjs BIN SOURCE PICTURE_FOLDER
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { check, check_answers, failures, look_for_faults, open, skip, start, whole_page } from './browser.mjs';

const [bin, source, pictures] = process.argv.slice(2);
for (const name of ['biteline-cell', 'biteline-sensor', 'biteline-host', 'biteline-web']) {
  if (!existsSync(join(bin, name))) skip(`${name} was not built`);
}
if (!existsSync(join(bin, '../share/biteline/web/app.js'))) skip('the page was not built');
if (!spawnSync(join(bin, 'biteline-host'), ['--help'], { encoding: 'utf8' }).stdout.includes('--control')) skip('this biteline-host has no control end');
mkdirSync(pictures, { recursive: true });
const say = (text) => console.log(`${(process.uptime()).toFixed(1).padStart(6)} s  ${text}`);

const out = mkdtempSync(join(tmpdir(), 'biteline-cell-'));
const started = [];

/// A program of this test; its lines are kept for the report of a failure.
function run(name, args) {
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
function line_of(one, wanted, patience_s = 120) {
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
const json = (line) => (line.startsWith('{') ? JSON.parse(line) : undefined);

function free_port() {
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

class Busy extends Error {
  constructor(scans) {
    super(`none of ${scans} scans was whole: this machine is too busy for the simulated cell`);
  }
}

async function whole_way() {
  const cell = run('biteline-cell', ['serve', '--seed', '5', '--shoe', 'deep', '--size', '0', '--arm', 'ur5e', '--place', '0', '--out', join(out, 'cell'), '--exit-with-parent']);
  const places = await line_of(cell, json);
  // With real-time rights where there are any: then no other program on this machine holds the sensor up.
  const sensor_with = (rt) => line_of(run('biteline-sensor', ['--source', `board:${places.board}`, '--sensor', places.sensor, '--rt', rt, '--exit-with-parent']), json);
  const { endpoint } = await sensor_with('required').catch(() => sensor_with('ignore'));
  // Row 3, column 4 of T_base_shoe: the table's height, which an integrator knows of his cell.
  const table_z = readFileSync(join(out, 'cell/truth/T_base_shoe.txt'), 'utf8').split(/\s+/).filter(Boolean)[11];
  const control = `tcp://127.0.0.1:${await free_port()}`;
  // A person decides, so that there is time to mend what was found.
  const process_file = join(out, 'process.yaml');
  const rough = readFileSync(join(source, 'host/robot/path/processes/rough.yaml'), 'utf8');
  check(/\ngate:\n[^\n]*\n$/.test(rough), 'rough.yaml no longer ends with its gate');
  writeFileSync(process_file, `${rough}  approval: person\n`);
  const host_arguments = [
    '--sensor', endpoint, '--out', join(out, 'results'), '--robot', 'ur5e', '--process', process_file, '--table-z', table_z,
    '--rtde', places.rtde, '--script', places.script, '--dashboard', places.dashboard, '--send', '--control', control, '--exit-with-parent',
  ];
  let host = run('biteline-host', host_arguments);
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

  const { browser, close } = await start();
  const anna = await open(browser, { height: 1100 });
  await anna.page.goto(address);
  await anna.page.getByText('No account yet?').click();
  await anna.page.getByLabel("Administrator's name").fill('anna');
  await anna.page.getByLabel('New password').fill('correct horse');
  await anna.page.getByRole('button', { name: 'Make the account' }).click();
  await anna.page.getByRole('heading', { name: 'Live' }).waitFor();
  await anna.page.getByText('anna, administrator').waitFor();
  say('the first account is made and logged in');

  await anna.page.goto(`${address}#/people`);
  await anna.page.locator('form').first().getByLabel('Name').fill('vera');
  await anna.page.locator('form').first().getByLabel('Role').selectOption('viewer');
  await anna.page.locator('form').first().getByLabel('Password').fill('only looking');
  await anna.page.locator('form').first().getByRole('button', { name: 'Save' }).click();
  await anna.page.getByRole('row', { name: /vera/ }).waitFor();
  const vera = await open(browser, { width: 390, height: 844, scheme: 'dark' });
  await vera.page.goto(address);
  await vera.page.getByLabel('Name', { exact: true }).fill('vera');
  await vera.page.getByLabel('Password', { exact: true }).fill('only looking');
  await vera.page.getByRole('button', { name: 'Log in' }).click();
  await vera.page.getByText('vera, viewer').waitFor();

  await anna.page.goto(`${address}#/live`);
  await anna.page.getByRole('button', { name: 'Take control' }).click();
  await anna.page.getByText('You have control', { exact: true }).waitFor();
  await vera.page.getByText('anna has control').waitFor();
  // The service asks for scans by itself; a person starts one only while it waits.
  const phase = await anna.page.evaluate(async () => (await (await fetch('/api/v1/state')).json()).phase);
  if (phase === 'waiting' || phase === 'stopped') await anna.page.getByRole('button', { name: 'Start a scan' }).click();
  say(`the service is ${phase}`);
  await anna.page.getByText(/Profile \d+\./).waitFor({ timeout: 120_000 });
  await vera.page.getByText(/Profile \d+\./).waitFor({ timeout: 120_000 });
  await anna.page.locator('figure img').waitFor({ timeout: 60_000 });
  await anna.page.waitForTimeout(3000);
  await whole_page(anna.page, join(pictures, 'cell_live_1280.png'), 1500);
  await whole_page(vera.page, join(pictures, 'cell_live_390.png'));
  say('live pictures and profiles are on both screens');

  // A busy machine may spoil a scan: the service says so and scans again, or a person asks for it.
  const row_of = async (wanted, patience_s) => {
    const deadline = Date.now() + 1000 * patience_s;
    for (;;) {
      const rows = await anna.page.evaluate(async () => (await (await fetch('/api/v1/scans')).json()).scans ?? []);
      const row = rows.find(wanted);
      if (row) return row;
      if (Date.now() > deadline) {
        // The laser's guard, rightly, ends scans whose frames come late.
        if (rows.length > 0 && rows.every((one) => one.reason_code === 'scan_not_complete' || one.verdict === 'working')) throw new Busy(rows.length);
        throw new Error(`no such scan: ${JSON.stringify(rows.slice(0, 3))}`);
      }
      await anna.page.waitForTimeout(500);
    }
  };
  const scan = await row_of((row) => row.verdict === 'ok' || row.verdict === 'amber', 240);
  say(`${scan.id}: ${scan.verdict}, ${scan.decision}`);
  await anna.page.goto(`${address}#/scans/${scan.id}`);
  await anna.page.getByText('Section across the line', { exact: true }).waitFor();
  await look_for_faults(anna.page, 'a real scan');
  // In a tab of its own: a window that changes its size moves what is clicked next.
  const shown = await anna.context.newPage();
  await shown.setViewportSize({ width: 1280, height: 1500 });
  await shown.goto(`${address}#/scans/${scan.id}`);
  await shown.getByText('Section across the line', { exact: true }).waitFor({ timeout: 60_000 });
  await shown.waitForTimeout(1000);
  await shown.screenshot({ path: join(pictures, 'cell_scan_1280.png') });
  await shown.close();
  await row_of((row) => row.id === scan.id && row.decision === 'held', 60);
  // A place of the found line itself: led through it, the line stays where it is, and is the hand's.
  const middle = await anna.page.evaluate(async (id) => {
    const rows = (await (await fetch(`/api/v1/scans/${id}/files/line.csv`)).text()).split('\n').filter((row) => /^[-\d]/.test(row));
    return rows[240].split(',').slice(0, 3).join(', ');
  }, scan.id);
  await anna.page.getByText('Mend the line').click();
  await anna.page.getByLabel('A [mm]').fill('100');
  await anna.page.getByLabel('B [mm]').fill('140');
  await anna.page.getByLabel('Points x, y, z', { exact: false }).fill(middle);
  await anna.page.getByRole('button', { name: 'Redo through the points' }).click();
  await anna.page.locator('details').filter({ hasText: 'Mend the line' }).getByLabel('Why').fill('to be sure of the heel');
  await anna.page.getByRole('button', { name: 'Save as a new version' }).click();
  await anna.page.getByText('The line is mended.').waitFor({ timeout: 60_000 });
  const mended = await row_of((row) => row.id === scan.id && row.line_version === 1, 60);
  check(Math.abs(mended.length_mm - scan.length_mm) < 1, `mended: ${mended.length_mm} mm, found ${scan.length_mm} mm`);
  check(mended.confidence <= scan.confidence, 'a hand raised the confidence');
  say(`${scan.id} is mended`);
  // Its path is planned and checked anew before anybody can accept it.
  for (let turn = 0; turn < 240; ++turn) {
    const state = await anna.page.evaluate(async () => (await (await fetch('/api/v1/state')).json()));
    if (state.phase === 'deciding') break;
    await anna.page.waitForTimeout(250);
  }
  await anna.page.getByRole('button', { name: 'Accept' }).click();
  const followed = await row_of((row) => row.id === scan.id && row.followed === true, 240);
  say(`${followed.id} was followed by the arm`);
  await anna.page.goto(`${address}#/scans`);
  await anna.page.getByRole('row', { name: new RegExp(scan.id) }).waitFor();
  await vera.page.goto(`${address}#/scans/${scan.id}`);
  await vera.page.getByText('An operator may do this.').first().waitFor();

  say('the service is killed');
  anna.may_fail = true;
  vera.may_fail = true;
  host.child.kill('SIGKILL');
  await anna.page.getByRole('alert').filter({ hasText: 'The service is away' }).waitFor();
  host = run('biteline-host', host_arguments);
  await anna.page.getByRole('alert').filter({ hasText: 'The service is away' }).waitFor({ state: 'detached', timeout: 120_000 });
  await anna.page.goto(`${address}#/log`);
  await anna.page.getByRole('row', { name: /anna/ }).first().waitFor();
  await anna.page.goto(`${address}#/scans`);
  await anna.page.getByRole('row', { name: new RegExp(scan.id) }).waitFor();
  say('the service is back, with its memory');
  await anna.page.evaluate(async (id) => {
    for (const path of ['state', 'me', 'control', 'robots', 'sensors', 'models', 'processes', 'processes/schema', 'processes/rough', 'users', 'log', 'history/trends', `scans/${id}`, `scans/${id}/files`, 'nothing']) {
      await (await fetch(`/api/v1/${path}`)).text();
    }
  }, scan.id);
  await close();
  check_answers();
}

try {
  await whole_way();
} catch (error) {
  if (error instanceof Busy && failures() === 0) {
    say(`skipped: ${error.message}`);
    await finish(77);
  }
  check(false, error.stack);
}
say(failures() === 0 ? 'all good' : `${failures()} checks failed`);
await finish(failures() === 0 ? 0 : 1);
