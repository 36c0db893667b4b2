// SPDX-License-Identifier: MIT
// refused.mjs RESULT_FOLDER PICTURE: the viewer in a refused result's own page, its shoe and its gates.
import { pathToFileURL } from 'node:url';
import { join } from 'node:path';
import { open, start } from '../../tests/web/browser.mjs';

const [folder, picture] = process.argv.slice(2);
const { browser, close } = await start();
const { page } = await open(browser, { width: 1100, height: 1200 });
await page.goto(pathToFileURL(join(folder, 'index.html')).href);
await page.locator('.viewer .scale-bar').waitFor();
await page.waitForTimeout(1000);
const first = await page.locator('.viewer .stage').boundingBox();
const last = await page.locator('.viewer .gates').boundingBox();
await page.screenshot({ path: picture, clip: { x: first.x, y: first.y, width: first.width, height: last.y + last.height - first.y }, fullPage: true });
await close();
