// SPDX-License-Identifier: MIT
// Teaching in a browser, by the clock: one shoe of the simulated cell from its scan to a model and a worked shoe.
// It tells the time and the number of decisions, and asserts neither.
// teach_test.mjs BIN SOURCE PICTURE_FOLDER [CLASS SEED]: a shoe of its own, with the gate as it is shipped, for the bench.
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { check, check_answers, look_for_faults, open, start, who_is } from './browser.mjs';
import { Busy, out, run_test, say, start_cell } from './cell_programs.mjs';

const [, , pictures, ...shoe] = process.argv.slice(2);
mkdirSync(pictures, { recursive: true });
const name_of_shoe = shoe.join(' ') || 'deep 5';
const row = (what, value, unit, target) => console.log(JSON.stringify({ bench: 'web.teach', what: `${name_of_shoe}: ${what}`, ours: value, unit, target }));

async function teach() {
  // A slow browser must not let the scan grow too old.
  const patient = shoe.length === 0 ? { scan_age_s: 3600 } : {};
  const { address } = await start_cell({
    add_to_gate: shoe.length === 0 ? '  scan_age_s: 3600\n' : '',
    host_more: ['--models', '--library', join(out, 'models')],
    ...(shoe.length === 0 ? {} : { shoe }),
  });
  const { browser, close } = await start();
  const { page } = await open(browser, { height: 1100 });
  await page.goto(address);
  await page.getByText('No account yet?').click();
  await page.getByLabel("Administrator's name").fill('anna');
  await page.getByLabel('New password').fill('correct horse');
  await page.getByRole('button', { name: 'Make the account' }).click();
  await who_is(page, 'anna, administrator');
  await page.getByRole('button', { name: 'Take control' }).click();
  await page.getByText('You have control', { exact: true }).waitFor();
  const ask = (method, path, body) =>
    page.evaluate(
      async ([method, path, body]) => {
        const answer = await fetch(`/api/v1${path}`, { method, headers: { 'content-type': 'application/json' }, body: body && JSON.stringify(body) });
        return answer.json();
      },
      [method, path, body],
    );
  // As an engineer prepares it: a process that asks nobody.  What is taught waits all the same.
  const { process: rough } = await ask('GET', '/processes/rough');
  await ask('PUT', '/processes/taught', { ...rough, name: 'taught', gate: { ...rough.gate, ...patient } });

  await page.goto(`${address}#/teach`);
  await page.getByRole('heading', { name: 'Teach' }).waitFor();
  let begun = Date.now();
  let decisions = 0;
  const decide = async (button) => {
    decisions += 1;
    await button.click();
  };
  const scan_button = page.getByRole('button', { name: 'Scan the sample' });
  await page.waitForFunction((button) => !button.disabled, await scan_button.elementHandle());
  await decide(scan_button);
  const held = page.getByText(/^scan-\d+ is held\.$/);
  for (let deadline = Date.now() + 300_000, tries = 1; !(await held.isVisible()); await page.waitForTimeout(200)) {
    const { scans } = await ask('GET', '/scans');
    // The laser's guard, rightly, ends scans whose frames come late: then nobody has decided anything yet.
    const late = scans.filter((one) => one.reason_code === 'scan_not_complete').length;
    if (late === 5) throw new Busy(late);
    if (late === tries && (await scan_button.isEnabled())) {
      tries += 1;
      deadline = Date.now() + 300_000;
      begun = Date.now();
      await scan_button.click();
    }
    if (Date.now() > deadline) throw new Error(`no scan is held: ${JSON.stringify(scans.slice(0, 3))}`);
  }
  const scan = (await held.textContent()).split(' ')[0];
  say(`${scan} is held: nobody knows its model`);

  const step = (name) => page.getByRole('region', { name });
  await step('Process and dry run').getByLabel('Process').selectOption('taught');
  await page.getByText('passes every check', { exact: false }).waitFor({ timeout: 120_000 });
  await decide(page.getByRole('button', { name: 'Plan with this process' }));
  await page.frameLocator('iframe').locator('canvas').first().waitFor({ timeout: 120_000 });
  say('its path is planned, and the dry run is shown');
  await look_for_faults(page, 'teach with a dry run');
  await page.screenshot({ path: join(pictures, 'cell_teach_1280.png'), fullPage: true });

  const run_in_air = page.getByRole('button', { name: 'Run in the air' });
  await page.waitForFunction((button) => !button.disabled, await run_in_air.elementHandle());
  const air_begun = Date.now();
  await decide(run_in_air);
  const air = step('First run in the air').locator('.notice');
  await air.filter({ hasText: /^(The arm has run|Refused|Stopped)/ }).waitFor({ timeout: 900_000 });
  const air_s = (Date.now() - air_begun) / 1000;
  check((await air.textContent()).startsWith('The arm has run the whole path in the air'), `in the air: ${await air.textContent()}`);
  say('the arm has run in the air');
  const waiting = await ask('GET', `/scans/${scan}`);
  const { teaching } = await ask('GET', '/state');
  check(teaching?.step === 'model', `after the run in the air the teaching stands at ${teaching?.step}`);
  check(waiting.sent === false && waiting.decision === 'held', `after the run in the air: ${waiting.decision}, sent ${waiting.sent}`);

  await step('Save the model').getByLabel('Name').fill('sample-42');
  await decide(step('Save the model').getByRole('button', { name: 'Save' }));
  await page.getByText('Work this shoe now as sample-42.', { exact: false }).waitFor();
  const saved_s = (Date.now() - begun) / 1000;
  const taught = await ask('GET', `/teachings/${teaching?.id}`);
  const ran = taught.followed?.scan === scan && taught.followed.process_sha256 === taught.process_sha256;
  check(ran && taught.ended_how === 'saved' && taught.model === 'sample-42', `taught ${JSON.stringify(taught)}`);
  if (shoe.length > 0) {
    row('from the start to the saved model, without the run in the air', saved_s - air_s, 's', 60);
    row('run in the air', air_s, 's', null);
  }
  // The gate's limit counts here, too: after a slow run in the air the shoe is scanned again, and known by then.
  const fresh = page.getByRole('button', { name: 'Work this shoe' });
  const again = page.getByRole('button', { name: 'Scan it again and work it' });
  await page.waitForFunction((button) => !button.disabled, await again.elementHandle());
  const too_old = await fresh.isDisabled();
  await decide(too_old ? again : fresh);
  let worked;
  for (const deadline = Date.now() + 600_000; ; await page.waitForTimeout(500)) {
    worked = (await ask('GET', '/scans?limit=1')).scans[0];
    if (worked.followed === true) break;
    // What is taught is told above; a machine that spoils the next scan spoils no more than that.
    if (worked.reason_code === 'scan_not_complete') throw new Busy(1);
    if (Date.now() > deadline || worked.followed === false || worked.verdict === 'refused')
      throw new Error(`not followed: ${worked.id} ${worked.decision} ${worked.reason}`);
  }
  const all_s = (Date.now() - begun) / 1000;
  check(too_old === (worked.id !== scan), `worked ${worked.id}, taught ${scan}`);
  if (too_old) check(worked.model === 'sample-42' && worked.process === 'taught', `worked as ${worked.model} with ${worked.process}`);
  const { models } = await ask('GET', '/models');
  check(models.length === 1 && models[0].name === 'sample-42' && models[0].process === 'taught', `models ${JSON.stringify(models)}`);
  say(`taught in ${all_s.toFixed(0)} s with ${decisions} decisions; the run in the air took ${air_s.toFixed(0)} s of it, the path of the shoe ${(worked.cycle_s ?? 0).toFixed(0)} s with its scan`);
  if (shoe.length > 0) {
    row('whole way to the worked shoe', all_s, 's', null);
    row('decisions', decisions, '', 5);
  }
  await close();
  check_answers();
}

await run_test(teach);
