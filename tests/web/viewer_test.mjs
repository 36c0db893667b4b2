// SPDX-License-Identifier: MIT
// The result viewer by itself, from a disk: section, slider, colours, views, light and dark.
// viewer_test.mjs PAGE_FOLDER PICTURE_FOLDER
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { check, failures, look_for_faults, open, skip, start } from './browser.mjs';
import { made_view } from './fake_cell.mjs';

const [page_folder, pictures] = process.argv.slice(2);
if (!existsSync(join(page_folder, 'viewer.js'))) skip('the page was not built');

const { browser, close } = await start();
const folder = join(pictures, 'result');
mkdirSync(folder, { recursive: true });
writeFileSync(join(folder, 'viewer.js'), readFileSync(join(page_folder, 'viewer.js')));
writeFileSync(join(folder, 'view_data.js'), `window.biteline_view = ${JSON.stringify(made_view())};\n`);
writeFileSync(join(folder, 'files.js'), 'window.biteline_files = [{"file":"line.csv","words":"the line","bytes":10}];\n');
writeFileSync(
  join(folder, 'index.html'),
  '<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>made</title><style>:root{color-scheme:light dark}body{background:#fff}@media(prefers-color-scheme:dark){body{background:#14171a;color:#e8eaed}}</style></head><body><main><h1>Made</h1><h2>In 3-D</h2><div id="viewer"></div>' +
    '<script defer src="files.js"></script><script defer src="view_data.js"></script><script defer src="viewer.js"></script></main></body></html>',
);
for (const scheme of ['light', 'dark']) {
  const disk = await open(browser, { scheme });
  await disk.page.goto(pathToFileURL(join(folder, 'index.html')).href);
  await disk.page.getByText('Section across the line', { exact: true }).waitFor();
  await look_for_faults(disk.page, `viewer ${scheme}`);
  const points = async () => Number(/: (\d+) raw points/.exec(await disk.page.locator('svg[role=img]').getAttribute('aria-label'))[1]);
  check((await points()) > 20, 'the section shows no raw points');
  // The first weak stretch is chosen at the start; the slider, the list and a click choose others.
  const slider = disk.page.locator('input[type=range]');
  check(Math.abs(Number(await slider.inputValue()) - 304) < 30, `weak stretch not chosen: ${await slider.inputValue()}`);
  await slider.focus();
  const before = Number(await slider.inputValue());
  await disk.page.keyboard.press('ArrowRight');
  check(Number(await slider.inputValue()) === before + 1, 'the slider does not follow the keys');
  const picture = async () => (await disk.page.locator('.stage').screenshot()).toString('base64');
  await disk.page.getByRole('button', { name: 'Top' }).click();
  await disk.page.waitForTimeout(500);
  const from_top = await picture();
  await disk.page.getByRole('button', { name: 'Toe', exact: true }).click();
  await disk.page.waitForTimeout(500);
  check((await picture()) !== from_top, 'the toe view looks like the top view');
  await disk.page.getByRole('button', { name: 'Top' }).click();
  await disk.page.waitForTimeout(500);
  await disk.page.getByRole('button', { name: 'Points' }).click();
  await disk.page.waitForTimeout(500);
  check((await picture()) !== from_top, 'hiding the points changes nothing');
  await disk.page.getByLabel("Line's colour").selectOption('u95');
  check((await disk.page.locator('.colour-bar').first().textContent()).includes('mm'), 'the colour bar has no unit');
  await disk.page.locator('.stage').focus();
  await disk.page.keyboard.press('ArrowLeft');
  const box = await disk.page.locator('.stage').boundingBox();
  await disk.page.getByRole('button', { name: 'Top' }).click();
  await disk.page.waitForTimeout(500);
  // The toe's tip lies right of the middle in the top view.
  let picked = false;
  for (let x = 0.6; x < 1 && !picked; x += 0.02) {
    await disk.page.mouse.click(box.x + x * box.width, box.y + box.height / 2);
    await disk.page.waitForTimeout(30);
    picked = Number(await slider.inputValue()) < 60 || Number(await slider.inputValue()) > 1140;
  }
  check(picked, 'a click at the toe picks no point there');
  await disk.page.screenshot({ path: join(pictures, `viewer_disk_${scheme}.png`), fullPage: true });
  await disk.context.close();
}

await close();
console.log(failures() === 0 ? 'all good' : `${failures()} checks failed`);
process.exit(failures() === 0 ? 0 : 1);
