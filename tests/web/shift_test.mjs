// SPDX-License-Identifier: MIT
// Ten tasks of a shift on the operator's screen, on a phone, a tablet, a desk and a wall: clicks, scrolls and seconds of each.
// Nothing may have to be scrolled, nothing that is tapped is smaller than a glove, the head is one row.  Times are told only.
// shift_test.mjs PAGE_FOLDER PICTURE_FOLDER
import { existsSync, mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { check, failures, look_for_faults, open, skip, start, wide_as_screen } from './browser.mjs';
import { FakeCell } from './fake_cell.mjs';
import { Hand } from './hand.mjs';

const [page_folder, pictures] = process.argv.slice(2);
if (!existsSync(join(page_folder, 'app.js'))) skip('the page was not built');
mkdirSync(pictures, { recursive: true });

const glove_px = 56;
const refusal = {
  id: 'scan-0005', verdict: 'refused', decision: 'open', reason_code: 'no_crease', reason: 'no crease: nothing concave runs round the side',
  next_step: 'push the sole on, or transfer the line of a sample', length_mm: null, u95_mm: null, weak_stretches: null, confidence: 0.1,
};

/// Each: what a person does, from where the task before has ended.
const tasks = [
  ['log in, take control', async (hand) => {
    await hand.type(hand.page.getByLabel('Name', { exact: true }), 'otto');
    await hand.type(hand.page.getByLabel('Password', { exact: true }), 'battery staple');
    await hand.click(hand.page.getByRole('button', { name: 'Log in' }));
    await hand.click(hand.page.getByRole('button', { name: 'Take control' }));
    await hand.page.getByText('You have control', { exact: true }).waitFor();
  }],
  ['read the verdict of the shoe', (hand) => hand.see(hand.page.locator('.letters', { hasText: 'look' }))],
  ['see the line on the shoe', async (hand) => {
    await hand.see(hand.page.locator('.shoe .stage'));
    await hand.see(hand.page.locator('.shoe .scale-bar'));
  }],
  ['accept', async (hand, cell) => {
    await hand.click(hand.page.getByRole('button', { name: 'Accept' }));
    await hand.until(() => cell.scans[0].decision === 'accepted');
  }],
  ['start the next shoe by its part number', async (hand, cell) => {
    cell.state.phase = 'waiting';
    cell.push('state', cell.told_state());
    await hand.type(hand.page.getByLabel('Part number'), 'A-18');
    await hand.click(hand.page.getByRole('button', { name: 'Start a scan' }));
    await hand.until(() => cell.calls.some((one) => one.path === '/commands/start' && one.body.part === 'A-18'));
  }],
  ['reject with a reason', async (hand, cell) => {
    Object.assign(cell.scans[0], { decision: 'held' });
    cell.state.phase = 'deciding';
    cell.push('scan', cell.scans[0]);
    cell.push('state', cell.told_state());
    await hand.click(hand.page.getByRole('button', { name: 'Reject', exact: true }));
    await hand.click(hand.page.getByRole('button', { name: 'The shoe has moved' }));
    await hand.until(() => cell.scans[0].why === 'The shoe has moved');
  }],
  ['scan again', async (hand, cell) => {
    await hand.click(hand.page.getByRole('button', { name: 'Scan again' }));
    await hand.until(() => cell.calls.some((one) => one.path === '/commands/rescan'));
  }],
  ['why was it refused, and what helps', async (hand, cell) => {
    cell.scans.unshift({ ...cell.scans[0], why: null, ...refusal });
    cell.state.phase = 'waiting';
    cell.push('scan', cell.scans[0]);
    cell.push('state', cell.told_state());
    await hand.see(hand.page.locator('.letters', { hasText: 'refused' }));
    await hand.see(hand.page.getByText('nothing concave runs round the side', { exact: false }));
    await hand.see(hand.page.getByText('Longest gap of the crease: 128.4 mm (at most 100.0 mm)', { exact: false }));
    await hand.see(hand.page.getByText('push the sole on', { exact: false }));
  }],
  ['count the day, ask the robot\'s lamp', async (hand) => {
    await hand.see(hand.page.locator('.counts .refused'));
    await hand.click(hand.page.getByRole('button', { name: /^Robot/ }));
    await hand.see(hand.page.getByText('not in remote control', { exact: false }));
  }],
  ['stop, hand control to the next', async (hand, cell) => {
    await hand.click(hand.page.getByRole('button', { name: 'Stop', exact: true }));
    await hand.until(() => cell.calls.some((one) => one.path === '/commands/stop'));
    await hand.click(hand.page.getByRole('button', { name: 'You have control' }));
    await hand.type(hand.page.getByLabel('Give control to'), 'anna');
    await hand.click(hand.page.getByRole('button', { name: 'Give', exact: true }));
    await hand.page.getByText('anna has control').first().waitFor();
  }],
];

// Phone and tablet each day, desk and wall where every view is asked for.
const screens = [[390, 844, 'light'], [1024, 768, 'dark'], [1280, 900, 'light'], [3840, 2160, 'light']];
const { browser, close } = await start();
const figures = [];
for (const [width, height, scheme] of process.env.BITELINE_EVERY_VIEW === '1' ? screens : screens.slice(0, 2)) {
  const cell = new FakeCell(page_folder);
  const one = await open(browser, { width, height, scheme });
  const title = `shift_${width}`;
  await one.page.goto(await cell.listen());
  const hand = new Hand(one.page);
  for (const [task, deed] of tasks) {
    await hand.begin();
    await deed(hand, cell);
    const told = hand.end();
    figures.push({ width, height, task, ...told });
    check(told.scrolls === 0, `${title}: ${task}: ${told.scrolls} scrolls`);
    // The login is no task at the cell.
    if (task !== tasks[0][0]) for (const small of told.small(glove_px)) check(false, `${title}: ${task}: ${small}`);
    if (task === 'see the line on the shoe' || task === 'why was it refused, and what helps') {
      await one.page.waitForTimeout(300);
      await one.page.screenshot({ path: join(pictures, `${title}_${figures.length}.png`) });
      await look_for_faults(one.page, `${title}: ${task}`);
      await wide_as_screen(one.page, title);
    }
  }
  const head_px = await one.page.locator('header').evaluate((head) => head.offsetHeight);
  check(head_px <= 48, `${title}: the head is ${head_px} px high`);
  // Where a key is the only way: Stop comes first.
  await one.page.reload();
  await one.page.locator('.letters').waitFor();
  await one.page.keyboard.press('Tab');
  check((await one.page.evaluate(() => document.activeElement.textContent)) === 'Stop', `${title}: Stop is not the first that a key reaches`);
  await one.context.close();
  await cell.stop();
}
await close();
for (const { width, height, task, clicks, texts, scrolls, seconds } of figures)
  console.log(`${width}x${height}: ${task}: ${clicks} clicks, ${texts} texts, ${scrolls} scrolls, ${seconds.toFixed(1)} s`);
console.log(failures() === 0 ? 'passed' : `${failures()} failures`);
process.exit(failures() === 0 ? 0 : 1);
