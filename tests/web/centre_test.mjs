// SPDX-License-Identifier: MIT
// The centre's page in a browser, over real daemons that page_test.py has started: first account, cells, alarms, the odd cell,
// history, releases, a recording that is fetched; and nothing on it that would command an arm.
// centre_test.mjs ADDRESS PICTURE_FOLDER
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { check, check_answers, failures, look_for_faults, open, start, whole_page, wide_as_screen } from './browser.mjs';

const [address, pictures] = process.argv.slice(2);
mkdirSync(pictures, { recursive: true });

/// Whoever reads the page finds no word and no button that moves or lights anything.
async function commands_nothing(page, name) {
  for (const words of [/^stop/i, /laser/i, /^start/i, /^send/i, /accept/i, /take control/i]) {
    check((await page.getByRole('button', { name: words }).count()) === 0, `${name}: a button ${words}`);
  }
}

async function picture(page, name) {
  await wide_as_screen(page, name);
  await look_for_faults(page, name);
  await commands_nothing(page, name);
  await whole_page(page, join(pictures, `centre_${name}.png`));
}

const { browser, close } = await start();
try {
  const anna = await open(browser, { height: 1000 });
  await anna.page.goto(address);
  await commands_nothing(anna.page, 'login');
  await anna.page.getByText('No account yet?').click();
  await anna.page.getByLabel("Administrator's name").fill('anna');
  await anna.page.getByLabel('New password').fill('correct horse');
  await anna.page.getByRole('button', { name: 'Make the account' }).click();
  await anna.page.getByRole('heading', { name: 'Cells', exact: true }).waitFor();

  // Health, alarms, the odd cell, each model in each cell.
  await anna.page.getByRole('row', { name: /cell-1/ }).first().waitFor();
  await anna.page.getByText(/cell-3 is away/).waitFor();
  await anna.page.getByText(/odd-4 lays its lines of loafer 0\.[23]\d mm off/).waitFor();
  const odd = anna.page.getByRole('region', { name: 'The odd cell out' });
  check((await odd.getByRole('row').count()) === 2, 'one odd cell, and the heads');
  check(/odd-4.*wider or narrower/s.test(await odd.innerText()), 'which cell is odd, and how');
  await anna.page.getByRole('region', { name: 'By model and cell' }).getByRole('row', { name: /boot cell-2/ }).waitFor();
  await picture(anna.page, 'cells');

  // The history of one cell, and its trends.
  await anna.page.getByRole('link', { name: 'cell-2' }).first().click();
  await anna.page.getByRole('heading', { name: 'Shoes' }).first().waitFor();
  const shoes = anna.page.getByRole('region', { name: 'Shoes', exact: true });
  await shoes.getByRole('row', { name: /cell-2/ }).first().waitFor();
  check((await shoes.getByRole('row', { name: /cell-1/ }).count()) === 0, 'only the cell that was asked for');
  await anna.page.getByRole('heading', { name: 'Trends' }).waitFor();

  // A recording on request.
  await anna.page.getByRole('button', { name: 'Fetch cell-2/scan-0005' }).click();
  const fetches = anna.page.getByRole('region', { name: 'Recordings' });
  await fetches.getByRole('row', { name: /cell-2 scan-0005 here 100/ }).waitFor();
  // It stays whatever its age, and goes again.
  await fetches.getByRole('button', { name: 'Keep cell-2/scan-0005' }).click();
  await fetches.getByRole('row', { name: /cell-2 scan-0005 here, marked 100/ }).waitFor();
  await fetches.getByRole('button', { name: 'Let go cell-2/scan-0005' }).click();
  await fetches.getByRole('row', { name: /cell-2 scan-0005 here 100/ }).waitFor();
  await fetches.getByRole('button', { name: 'Keep cell-2/scan-0005' }).click();
  await fetches.getByRole('row', { name: /here, marked/ }).waitFor();
  await picture(anna.page, 'shoes');

  await anna.page.getByRole('link', { name: 'Releases' }).click();
  await anna.page.getByRole('heading', { name: /autumn/ }).waitFor();
  await anna.page.getByRole('row', { name: /cell-1 not ready/ }).waitFor();
  await picture(anna.page, 'releases');

  // A viewer looks on, in the dark, on a telephone.
  await anna.page.goto(`${address}#/people`);
  const form = anna.page.locator('form').first();
  await form.getByLabel('Name').fill('vera');
  await form.getByLabel('Role').selectOption('viewer');
  await form.getByLabel('Password').fill('only looking');
  await form.getByRole('button', { name: 'Save' }).click();
  await anna.page.getByRole('row', { name: /vera/ }).waitFor();
  await anna.page.getByRole('link', { name: 'Log' }).click();
  await anna.page.getByText('fetch recording').first().waitFor();
  await anna.page.getByText('let recording go').first().waitFor();
  const vera = await open(browser, { width: 390, height: 844, scheme: 'dark' });
  await vera.page.goto(address);
  await vera.page.getByLabel('Name', { exact: true }).fill('vera');
  await vera.page.getByLabel('Password', { exact: true }).fill('only looking');
  await vera.page.getByRole('button', { name: 'Log in' }).click();
  await vera.page.getByRole('row', { name: /cell-1/ }).first().waitFor();
  await picture(vera.page, 'cells_390_dark');
  await vera.page.goto(`${address}#/shoes/cell-2`);
  const button = vera.page.getByRole('button', { name: 'Fetch cell-2/scan-0005' });
  await button.waitFor();
  check(await button.isDisabled(), 'a viewer fetches nothing');
  const let_go = vera.page.getByRole('button', { name: 'Let go cell-2/scan-0005' });
  await let_go.waitFor();
  check(await let_go.isDisabled(), 'a viewer keeps nothing');

  check_answers();
} catch (error) {
  check(false, error.stack);
} finally {
  await close();
}
console.log(failures() === 0 ? 'the page of all cells shows them, and commands none' : `${failures()} failures`);
process.exit(failures() === 0 ? 0 : 1);
