// SPDX-License-Identifier: MIT
// A person at the page, who counts: clicks, texts typed, and how often the screen is scrolled before the thing is in sight.

/// How far a thing is from being in sight, px up (negative) or down: in the window above what lies fixed at its end, and in
/// each box around it that scrolls by itself.
function away_px(element) {
  const box = element.getBoundingClientRect();
  const bar = document.querySelector('.stop-bar');
  let first = 0;
  let last = bar && !bar.contains(element) ? bar.getBoundingClientRect().top : innerHeight;
  for (let around = element.parentElement; around; around = around.parentElement) {
    if (around.scrollHeight <= around.clientHeight || getComputedStyle(around).overflowY === 'visible' || around === document.documentElement) continue;
    const room = around.getBoundingClientRect();
    first = Math.max(first, room.top);
    last = Math.min(last, room.bottom);
  }
  const room = Math.max(1, last - first);
  if (box.top < first) return { px: box.top - first, room };
  // What is higher than the room is in sight once its begin is.
  return { px: Math.max(0, Math.min(box.bottom, box.top + room) - last), room };
}

export class Hand {
  constructor(page) {
    this.page = page;
  }
  async begin() {
    Object.assign(this, { clicks: 0, texts: 0, scrolls: 0, tapped: [], since: Date.now() });
  }
  end() {
    const { clicks, texts, scrolls, tapped } = this;
    const small = (least_px) => tapped.filter((one) => one.px < least_px - 0.5).map((one) => `${one.words} is ${one.px} px high, ${least_px} px wanted`);
    return { clicks, texts, scrolls, seconds: (Date.now() - this.since) / 1000, small };
  }
  /// Comes into sight, by as many scrolls as a person needs.
  async see(locator) {
    await locator.waitFor();
    const { px, room } = await locator.evaluate(away_px);
    if (Math.abs(px) > 1) {
      this.scrolls += Math.ceil(Math.abs(px) / room);
      await locator.evaluate((element) => element.scrollIntoView({ block: 'center' }));
    }
  }
  async click(locator) {
    await this.see(locator);
    // The page's head is for a mouse or a bare finger; what is worked with is not in it.
    const tapped = await locator.evaluate((element) => ({
      px: element.closest('header') ? Infinity : element.getBoundingClientRect().height,
      words: element.textContent.trim(),
    }));
    this.tapped.push(tapped);
    this.clicks += 1;
    await locator.click();
  }
  async type(locator, text) {
    await this.click(locator);
    this.texts += 1;
    await locator.fill(text);
  }
  async until(is_so, patience_ms = 10_000) {
    for (const deadline = Date.now() + patience_ms; !is_so(); await this.page.waitForTimeout(20))
      if (Date.now() > deadline) throw new Error(`did not happen: ${is_so}`);
  }
}
