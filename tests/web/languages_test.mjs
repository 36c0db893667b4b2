// SPDX-License-Identifier: MIT
// The page in each language, on a phone and on a tablet: no word of English is left, nothing is cut, nothing is wider
// than the screen, numbers are typed as it writes them.  Pictures of each view lie beside those of the page's test.
// languages_test.mjs PAGE_FOLDER PICTURE_FOLDER
import { existsSync, mkdirSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { check, failures, look_for_faults, open, skip, start, web, wide_as_screen } from './browser.mjs';
import { FakeCell } from './fake_cell.mjs';

const [page_folder, pictures] = process.argv.slice(2);
if (!existsSync(join(page_folder, 'app.js'))) skip('the page was not built');
mkdirSync(pictures, { recursive: true });

const read = (code) => JSON.parse(readFileSync(join(web, 'words', `${code}.json`), 'utf8'));
const english = read('en');
// Long words, a tall script, many marks; all of them where every language is asked for.
const daily = ['de', 'hi', 'vi'];
const codes = readdirSync(join(web, 'words')).map((file) => file.replace('.json', '')).sort();
const views = ['work', 'live', 'scans', 'models', 'processes', 'teach', 'sensor', 'devices', 'people', 'log', 'scans/scan-0004', 'scans/scan-0003', 'models/runner-42'];

/// A view that has not read its cell yet shows fewer texts than any that has.
const few = 20;

/// What stands on the page, and what of it is cut: text that needs more room than its box shows.
function seen() {
  const texts = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const text = walk.currentNode.textContent.trim();
    if (text && walk.currentNode.parentElement.checkVisibility()) texts.push(text);
  }
  const cut = [];
  for (const element of document.querySelectorAll('button, a, label, th, dt, h1, h2, h3, legend, summary, .lamp, option')) {
    const style = getComputedStyle(element);
    const hides = style.overflowX !== 'visible' || style.overflowY !== 'visible' || element.tagName === 'BUTTON';
    if (element.checkVisibility() && !element.closest('.unseen') && hides && element.scrollWidth > element.clientWidth + 1) cut.push(element.textContent.trim().slice(0, 60));
  }
  const told = [...document.querySelectorAll('[lang=en]')].filter((element) => !element.matches('option') && element.checkVisibility()).map((element) => element.textContent.trim());
  return { texts, cut, told };
}

/// A text that stands in English where the language has another for it.
function english_in(texts, words) {
  const own = new Set(Object.values(words));
  return Object.entries(english)
    .filter(([key, text]) => /[a-z]{3}/i.test(text) && words[key] !== text && !own.has(text) && texts.includes(text))
    .map(([key]) => key);
}

const cell = new FakeCell(page_folder);
// Only what a lamp's source itself tells may stand as it was told.
const details = Object.values(cell.state.lamps).map((lamp) => lamp.detail).filter(Boolean);
const address = await cell.listen();
const { browser, close } = await start();
const anna = await open(browser);
await anna.page.goto(address);
await anna.page.getByLabel('Name', { exact: true }).fill('anna');
await anna.page.getByLabel('Password', { exact: true }).fill('correct horse');
await anna.page.getByRole('button', { name: 'Log in' }).click();
await anna.page.getByRole('heading', { name: 'Live' }).waitFor();
cell.begin_teaching('berta');

check(codes.length >= 10, `${codes.length} languages`);
await anna.page.getByRole('button', { name: 'Menu', exact: true }).click();
const offered = await anna.page.locator('select option[lang]').evaluateAll((all) => all.map((one) => one.value).sort());
check(offered.join() === codes.join(), `offered: ${offered.join()}; in words/: ${codes.join()}`);

for (const [width, height] of [[390, 844], [1024, 768]]) {
  for (const code of process.env.BITELINE_EVERY_LANGUAGE === '1' ? codes : daily) {
    const words = read(code);
    const one = await open(browser, { width, height });
    await one.context.addCookies(await anna.context.cookies());
    await one.context.addInitScript((language) => {
      localStorage.setItem('biteline_session', '1');
      localStorage.setItem('biteline_language', language);
    }, code);
    for (const view of views) {
      const title = `${view.replace('/', '_')}_${code}_${width}`;
      await one.page.goto(`${address}#/${view}`);
      await one.page.getByRole('heading', { level: 1 }).waitFor();
      // What the view reads comes when the machine has time for it.
      for (const until = Date.now() + 60_000; Date.now() < until && (await one.page.evaluate(seen)).texts.length <= few; )
        await one.page.waitForTimeout(100);
      await one.page.waitForTimeout(250);
      const { texts, cut, told } = await one.page.evaluate(seen);
      check(texts.length > few, `${title}: only ${texts.length} texts`);
      check((await one.page.getAttribute('html', 'lang')).startsWith(code), `${title}: another language`);
      if (code !== 'en') for (const key of english_in(texts, words)) check(false, `${title}: in English: ${key}: ${english[key]}`);
      for (const text of told) check(details.includes(text), `${title}: said in English: ${text}`);
      for (const text of cut) check(false, `${title}: cut: ${text}`);
      await wide_as_screen(one.page, title);
      const [head_px, needs_px, has_px] = await one.page.locator('header').evaluate((head) => [head.offsetHeight, head.scrollWidth, head.clientWidth]);
      check(head_px <= 48 && needs_px <= has_px, `${title}: the head is ${head_px} px high, needs ${needs_px} px of ${has_px} px`);
      await one.page.screenshot({ path: join(pictures, `${title}.png`) });
    }
    await look_for_faults(one.page, code);
    await one.context.close();
  }
}

// Numbers are typed as the language writes them.
for (const [code, typed, other] of [['en', '10.5', '10,5x'], ['de', '10,5', '1.0,5']]) {
  const words = read(code);
  const one = await open(browser);
  await one.context.addCookies(await anna.context.cookies());
  await one.context.addInitScript((language) => {
    localStorage.setItem('biteline_session', '1');
    localStorage.setItem('biteline_language', language);
  }, code);
  await one.page.goto(`${address}#/scans/scan-0004`);
  if (code === 'en') await one.page.getByRole('button', { name: words.control_take, exact: true }).click();
  await one.page.locator('summary', { hasText: words.mend }).first().click();
  const redo = one.page.getByRole('button', { name: words.mend_through, exact: true });
  await one.page.getByLabel('A [mm]').fill(typed);
  await one.page.getByLabel('B [mm]').fill('30');
  await one.page.getByLabel(words.mend_points).fill(`${typed} ${typed} 3; 1 2 ${typed}`);
  check(await redo.isEnabled(), `${code}: ${typed} is no number`);
  await one.page.getByLabel('A [mm]').fill(other);
  check(await redo.isDisabled(), `${code}: ${other} is a number`);
  await one.context.close();
}

// Words that do not come leave the page as it is.
const last = await open(browser);
last.may_fail = true;
await last.context.route('**/words/*.json', (route) => route.abort());
await last.page.goto(address);
await last.page.getByLabel('Language').selectOption('tr');
await last.page.getByRole('heading', { name: 'Biteline' }).waitFor();
check((await last.page.getByLabel('Language').count()) === 1, 'the page lost its words');

await close();
await cell.stop();
console.log(failures() === 0 ? 'passed' : `${failures()} failures`);
process.exit(failures() === 0 ? 0 : 1);
