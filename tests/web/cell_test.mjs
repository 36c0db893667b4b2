// SPDX-License-Identifier: MIT
// The whole way in a browser: first account, login, control, a scan of the simulated cell, decision, the arm follows it;
// a second browser watches; the service is killed and comes back.  Real: sensor, service, web program, page.
// cell_test.mjs BIN SOURCE PICTURE_FOLDER
import { existsSync, mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { check, check_answers, look_for_faults, open, start, who_is, whole_page } from './browser.mjs';
import { Busy, out, run, run_test, say, start_cell } from './cell_programs.mjs';

const [, , pictures] = process.argv.slice(2);
mkdirSync(pictures, { recursive: true });

async function whole_way() {
  // A person decides, so that there is time to mend what was found; a slow browser must not let the scan grow too old.
  const { address, host: first_host, host_arguments } = await start_cell({ add_to_gate: '  approval: person\n  scan_age_s: 3600\n' });
  let host = first_host;

  const { browser, close } = await start();
  const anna = await open(browser, { height: 1100 });
  await anna.page.goto(address);
  await anna.page.getByText('No account yet?').click();
  await anna.page.getByLabel("Administrator's name").fill('anna');
  await anna.page.getByLabel('New password').fill('correct horse');
  await anna.page.getByRole('button', { name: 'Make the account' }).click();
  await anna.page.getByRole('heading', { name: 'Live' }).waitFor();
  await who_is(anna.page, 'anna, administrator');
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
  await who_is(vera.page, 'vera, viewer');
  await vera.page.goto(`${address}#/live`);

  await anna.page.goto(`${address}#/live`);
  await anna.page.getByRole('button', { name: 'Take control' }).click();
  await anna.page.getByText('You have control', { exact: true }).waitFor();
  await vera.page.getByText('anna has control').waitFor();
  const ask = (path) => anna.page.evaluate(async (path) => (await fetch(`/api/v1/${path}`)).json(), path);
  const start_button = anna.page.getByRole('button', { name: 'Start a scan' });
  // A start that came before the sensor was there has ended at once: then a person asks again.
  const start_where_it_waits = async () => {
    const waits = async () => (await ask('state')).phase === 'waiting';
    if ((await waits()) && (await start_button.isEnabled())) {
      await start_button.click();
      for (let turn = 0; turn < 40 && (await waits()); ++turn) await anna.page.waitForTimeout(250);
    }
    await anna.page.waitForTimeout(500);
  };
  const profile_of = ({ page }) => page.getByText(/Profile \d+\./);
  for (const deadline = Date.now() + 120_000; !((await profile_of(anna).isVisible()) && (await profile_of(vera).isVisible())); ) {
    if (Date.now() > deadline) throw new Error(`no profile is on both screens: ${JSON.stringify(await ask('state'))}`);
    await start_where_it_waits();
  }
  await anna.page.locator('figure img').waitFor({ timeout: 60_000 });
  await anna.page.waitForTimeout(3000);
  await whole_page(anna.page, join(pictures, 'cell_live_1280.png'), 1500);
  await whole_page(vera.page, join(pictures, 'cell_live_390.png'));
  say('live pictures and profiles are on both screens');

  // A busy machine may spoil a scan: the service says so and scans again, or a person asks for it.
  const row_of = async (wanted, patience_s, meanwhile = () => anna.page.waitForTimeout(500)) => {
    const deadline = Date.now() + 1000 * patience_s;
    for (;;) {
      const rows = (await ask('scans')).scans ?? [];
      const row = rows.find(wanted);
      if (row) return row;
      if (Date.now() > deadline) {
        // The laser's guard, rightly, ends scans whose frames come late.
        if (rows.length > 0 && rows.every((one) => one.reason_code === 'scan_not_complete' || one.verdict === 'working')) throw new Busy(rows.length);
        throw new Error(`no such scan: ${JSON.stringify(rows.slice(0, 3))}`);
      }
      await meanwhile();
    }
  };
  const has_line = (row) => row.verdict === 'ok' || row.verdict === 'amber';
  const scan = await row_of(has_line, 240, start_where_it_waits);
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
  await row_of((row) => row.id === scan.id && row.decision === 'held', 60);
  // The operator's screen: the shoe with its line, and a yes within reach.
  await shown.setViewportSize({ width: 1280, height: 900 });
  await shown.goto(`${address}#/work`);
  await shown.locator('.shoe .scale-bar').waitFor();
  await shown.getByRole('button', { name: 'Accept' }).waitFor();
  await shown.waitForTimeout(1000);
  await shown.screenshot({ path: join(pictures, 'cell_work_1280.png') });
  await shown.close();
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
    if ((await ask('state')).phase === 'deciding') break;
    await anna.page.waitForTimeout(250);
  }
  await anna.page.getByRole('button', { name: 'Accept' }).click();
  const followed = await row_of((row) => row.id === scan.id && row.followed === true, 240);
  say(`${followed.id} was followed by the arm`);
  // The sensor kept this scan's recording until somebody asks for it, and counts what it goes through.
  await anna.page.goto(`${address}#/sensor`);
  await anna.page.getByRole('button', { name: "Keep the last scan's recording" }).click();
  await anna.page.getByText(`kept: ${join(out, 'kept')}`, { exact: true }).waitFor();
  check(existsSync(join(out, 'kept/recording.yaml')), 'the recording is not there');
  const { upkeep } = (await ask('sensors')).sensors[0];
  check(upkeep.starts === 1 && upkeep.lightings >= 1 && upkeep.laser_s > 1 && upkeep.laser_s < upkeep.run_s, `upkeep ${JSON.stringify(upkeep)}`);
  await anna.page.getByText('1 of the program, 1 of the machine', { exact: true }).waitFor();
  const metrics = await anna.page.evaluate(async () => (await fetch('/metrics')).text());
  check(/\nbiteline_sensor_laser_seconds_total\{sensor="[^"]*"\} [1-9]/.test(metrics), 'the metrics do not tell the laser hours');
  say('the recording is kept, the unit tells what it has been through');
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

await run_test(whole_way);
