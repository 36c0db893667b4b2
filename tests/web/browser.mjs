// SPDX-License-Identifier: MIT
// Debian's chromium for the tests of the page: no network of its own, its own profile, every console error noted.
import { spawnSync } from 'node:child_process';
import { appendFileSync, existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

export const web = process.env.BITELINE_WEB_SOURCE;
const require = createRequire(join(web, 'package.json'));

export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}
const chromium_path = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
if (!chromium_path) skip('no chromium; ./run test installs it');
if (!existsSync(join(web, 'node_modules/playwright-core'))) skip('no packages; run npm ci in host/web');

const { chromium } = require('playwright-core');
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

let failed = 0;
export function check(good, what) {
  if (good) return;
  failed += 1;
  console.log(`FAILED: ${what}`);
}
export function failures() {
  return failed;
}

/// Every answer of the API and every event that a page of open() gets, one JSON object a line.
const noted = mkdtempSync(join(tmpdir(), 'biteline-answers-'));
const answers = join(noted, 'answers');
process.on('exit', () => rmSync(noted, { recursive: true, force: true }));

function note_answers(page) {
  const note = (line) => appendFileSync(answers, `${JSON.stringify(line)}\n`);
  page.on('response', async (response) => {
    const path = /\/api\/v1(\/[^?]*)/.exec(response.url())?.[1];
    const type = response.headers()['content-type'] ?? '';
    if (!path || (!type.startsWith('application/json') && response.status() !== 204)) return;
    // A body that went with its page is nobody's fault.
    const body = response.status() === 204 ? null : await response.json().catch(() => undefined);
    if (body !== undefined) note({ method: response.request().method(), path, status: response.status(), type: type.split(';')[0], body });
  });
  page.on('websocket', (socket) => {
    if (socket.url().includes('/events')) socket.on('framereceived', ({ payload }) => note({ event: payload.toString() }));
  });
}

/// They are what openapi.yaml says.
export function check_answers() {
  const checker = join(web, '../../tests/web/check_api_answers.py');
  const { status, stdout, stderr } = spawnSync('python3', [checker, join(web, 'openapi.yaml'), answers], { encoding: 'utf8' });
  console.log(`answers against openapi.yaml: ${stdout.trim()}`);
  check(status === 0 || status === 77, `answers against openapi.yaml: ${stderr}`);
}

export async function start() {
  const profile = mkdtempSync(join(tmpdir(), 'biteline-browser-'));
  const browser = await chromium.launch({
    executablePath: chromium_path,
    args: [
      '--headless', '--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update',
      '--disable-sync', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', `--crash-dumps-dir=${profile}`,
    ],
  });
  return {
    browser,
    async close() {
      await browser.close();
      rmSync(profile, { recursive: true, force: true });
    },
  };
}

/// A page whose console errors count as failures, unless `may_fail` says they are expected now.
export async function open(browser, { width = 1280, height = 900, scheme = 'light' } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, locale: 'en-GB', reducedMotion: 'reduce' });
  const page = await context.newPage();
  const state = { page, context, may_fail: false };
  page.on('console', (message) => {
    if (message.type() === 'error' && !state.may_fail) check(false, `console: ${message.text()} ${message.location().url}`);
  });
  page.on('pageerror', (error) => check(false, `page: ${error.message}`));
  page.setDefaultTimeout(60_000);
  note_answers(page);
  return state;
}

/// The page, down to `most` pixels, in a window as high as that: the bar that sticks to the window's end stands at the picture's end.
export async function whole_page(page, path, most = 8000) {
  const before = page.viewportSize();
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  await page.setViewportSize({ width: before.width, height: Math.min(Math.max(before.height, height), most) });
  await page.waitForTimeout(250);
  await page.screenshot({ path });
  await page.setViewportSize(before);
}

export async function look_for_faults(page, name) {
  // As a value: a script tag would be blocked by the page's own policy.
  await page.evaluate(axe);
  const found = await page.evaluate(() => globalThis.axe.run({ runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice'] }));
  for (const violation of found.violations) {
    check(false, `${name}: axe ${violation.id}: ${violation.help}: ${violation.nodes.slice(0, 3).map((node) => node.target.join(' ')).join(' | ')}`);
  }
}

export async function wide_as_screen(page, name) {
  const [content, window] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  check(content <= window, `${name}: ${content} px wide on a screen of ${window} px`);
}

/// Who is logged in stands in the menu.
export async function who_is(page, words) {
  const menu = page.getByRole('button', { name: 'Menu', exact: true });
  await menu.click();
  await page.locator('#menu').getByText(words).waitFor();
  await menu.click();
}

/// In the menu; `now` is what the language's own label is called now.
export async function choose_language(page, code, { menu = 'Menu', label = 'Language' } = {}) {
  await page.getByRole('button', { name: menu, exact: true }).click();
  await page.getByLabel(label).selectOption(code);
  await page.keyboard.press('Escape');
}

export async function release_control(page) {
  await page.getByRole('button', { name: 'You have control' }).click();
  await page.getByRole('button', { name: 'Release control' }).click();
}

/// From somebody who has it: with a word.
export async function take_control_from(page, holder, why) {
  await page.getByRole('button', { name: `${holder} has control` }).click();
  const panel = page.locator('#control');
  // The question has the focus at once: nobody reaches for it.
  await page.waitForFunction(() => document.activeElement?.closest('#control input'));
  await panel.getByLabel('Why').fill(why);
  await panel.getByRole('button', { name: 'Take control' }).click();
}
