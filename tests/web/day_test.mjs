// SPDX-License-Identifier: MIT
// A day at the cell, in a browser: a sample becomes a model and is rejected; the sensor is killed in a scan and comes back;
// two uppers without a sole are known, get the sample's line, are accepted and followed; the history has it all.
// Real: sensor, service, web program, page, on the simulated cell.  day_test.mjs BIN SOURCE PICTURE_FOLDER
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { check, check_answers, look_for_faults, open, start, who_is } from './browser.mjs';
import { Busy, end, out, run_test, say, start_cell, start_sensor, start_world } from './cell_programs.mjs';

const [, , pictures] = process.argv.slice(2);
mkdirSync(pictures, { recursive: true });
const shoe = ['--seed', '5', '--shoe', 'deep', '--size', '0'];

async function day() {
  let { address, cell, places, sensor, endpoint } = await start_cell({
    add_to_gate: '  approval: person\n  scan_age_s: 3600\n',
    host_more: ['--models', '--library', join(out, 'models')],
  });
  const { browser, close } = await start();
  const anna = await open(browser, { height: 1100 });
  const { page } = anna;
  await page.goto(address);
  await page.getByText('No account yet?').click();
  await page.getByLabel("Administrator's name").fill('anna');
  await page.getByLabel('New password').fill('correct horse');
  await page.getByRole('button', { name: 'Make the account' }).click();
  await who_is(page, 'anna, administrator');
  await page.getByRole('button', { name: 'Take control' }).click();
  await page.getByText('You have control', { exact: true }).waitFor();
  const ask = (path) => page.evaluate(async (path) => (await fetch(`/api/v1/${path}`)).json(), path);
  const phase_is = async (wanted, patience_s) => {
    for (const deadline = Date.now() + 1000 * patience_s; ; await page.waitForTimeout(250)) {
      const state = await ask('state');
      if (wanted.includes(state.phase)) return state;
      if (Date.now() > deadline) throw new Error(`not ${wanted}: ${JSON.stringify(state)}`);
    }
  };
  const begin_scan = async () => {
    await page.goto(`${address}#/live`);
    await page.getByRole('heading', { name: 'Live', level: 1 }).waitFor();
    await phase_is(['waiting'], 120);
    await page.getByRole('button', { name: 'Start a scan' }).click();
    await phase_is(['scanning', 'working', 'deciding'], 120);
  };
  /// The row of a new scan, once `wanted` says so; a machine that spoils a scan is asked again.
  const scan_until = async (wanted) => {
    for (let tries = 1; tries <= 4; ++tries) {
      const known = new Set((await ask('scans?limit=50')).scans.map((row) => row.id));
      await begin_scan();
      for (const deadline = Date.now() + 300_000; ; await page.waitForTimeout(500)) {
        const row = (await ask('scans?limit=50')).scans.find((one) => !known.has(one.id));
        if (row && wanted(row)) return row;
        // The laser's guard, rightly, ends scans whose frames come late.
        if (row?.reason_code === 'scan_not_complete') break;
        if (Date.now() > deadline) throw new Error(`no such scan: ${JSON.stringify(row)}`);
      }
    }
    throw new Busy(4);
  };
  const is_held = (row) => row.decision === 'held';

  say('a sample: its model is not known, it becomes one and is rejected');
  const sample = await scan_until(is_held);
  check(sample.reason_code === 'model_unknown', `the sample: ${sample.reason_code}`);
  await page.goto(`${address}#/models`);
  await page.getByLabel('Name', { exact: true }).fill('sample-5');
  await page.locator('form').getByLabel('Scan').selectOption(sample.id);
  await page.getByRole('button', { name: 'Save' }).click();
  await page.getByRole('row', { name: /sample-5/ }).waitFor();
  await page.goto(`${address}#/scans/${sample.id}`);
  await page.getByRole('button', { name: 'Reject' }).click();
  await page.getByLabel('Why').first().fill('a sample, and no work');
  await page.getByRole('button', { name: 'Reject' }).click();
  await page.getByText('Rejected.').waitFor();

  say('the sensor is killed in mid-scan');
  anna.may_fail = true;
  await begin_scan();
  await phase_is(['scanning'], 60);
  await page.waitForTimeout(1500);
  await end(sensor, 'SIGKILL');
  for (const deadline = Date.now() + 60_000; (await ask('state')).lamps.camera.level === 'ok'; await page.waitForTimeout(250)) {
    if (Date.now() > deadline) throw new Error(`the camera's lamp is ok without a sensor: ${JSON.stringify(await ask('state'))}`);
  }
  await page.screenshot({ path: join(pictures, 'cell_without_sensor_1280.png') });
  const listen = ['--listen', endpoint];
  ({ sensor } = await start_sensor(places, listen));
  const cut = await (async () => {
    for (const deadline = Date.now() + 120_000; ; await page.waitForTimeout(500)) {
      const row = (await ask('scans?limit=1')).scans[0];
      if (row.id !== sample.id && row.verdict === 'refused') return row;
      if (Date.now() > deadline) throw new Error(`the cut scan: ${JSON.stringify(row)}`);
    }
  })();
  check(cut.reason_code === 'scan_not_complete', `cut: ${cut.reason_code}`);
  check(cut.sent === false, 'a cut scan was sent');
  await phase_is(['waiting'], 120);
  say('the sensor is back, and the service waits for the next start');

  // The arm stays where the service knows it; only shoe and head are other programs.
  const ports = ['rtde', 'script', 'dashboard'].flatMap((name) => [`--${name}-port`, places[name].split(':').at(-1)]);
  const followed = [];
  for (const [number, place] of [[1, '0'], [2, '3']]) {
    say(`upper ${number}: known as the sample, carried over, accepted, followed`);
    await end(sensor);
    await end(cell);
    ({ cell, places } = await start_world(join(out, `upper-${number}`), [...shoe, '--upper', '--place', place, ...ports]));
    ({ sensor } = await start_sensor(places, listen));
    const upper = await scan_until((row) => is_held(row) || row.verdict === 'refused');
    check(upper.decision === 'held' && upper.model === 'sample-5', `upper ${number}: ${upper.decision}, ${upper.model}, ${upper.reason}`);
    check(upper.u95_mm > 0 && upper.u95_mm < 1, `upper ${number}: U95 ${upper.u95_mm} mm`);
    await page.goto(`${address}#/scans/${upper.id}`);
    await phase_is(['deciding'], 60);
    await page.getByRole('button', { name: 'Accept' }).click();
    for (const deadline = Date.now() + 300_000; ; await page.waitForTimeout(500)) {
      const row = await ask(`scans/${upper.id}`);
      if (row.followed === true) break;
      if (Date.now() > deadline || row.followed === false) throw new Error(`upper ${number}: ${JSON.stringify(row)}`);
    }
    followed.push(upper.id);
    await look_for_faults(page, `upper ${number}`);
  }

  say('the history: what was rejected, cut and followed, and why');
  await page.goto(`${address}#/scans`);
  await page.getByRole('row', { name: new RegExp(`${sample.id}.*rejected`) }).waitFor();
  for (const id of followed) await page.getByRole('row', { name: new RegExp(`${id}.*sample-5`) }).waitFor();
  const csv = await page.evaluate(async () => (await fetch('/api/v1/history.csv')).text());
  for (const id of [sample.id, cut.id, ...followed]) check(csv.includes(id), `${id} is not in the CSV`);
  const trends = await ask('history/trends');
  check(trends.reasons.some((one) => one.reason_code === 'scan_not_complete'), `reasons ${JSON.stringify(trends.reasons)}`);
  await look_for_faults(page, 'the history of a day');
  await page.screenshot({ path: join(pictures, 'cell_history_1280.png'), fullPage: true });
  await close();
  check_answers();
}

await run_test(day);
