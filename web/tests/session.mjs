// SPDX-License-Identifier: GPL-3.0-or-later
// A browser that takes commands: one JSON object {call, with: [...]} per line, with one line of
// answer. tests/web/browser.py uses it.
import { createInterface } from 'node:readline';

import { launch } from 'puppeteer-core';

const CHROMIUM = '/usr/bin/chromium';
const SOFTWARE = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

let browser, page, requests, opening;

const calls = {
  async start(...options) {
    const settings = {
      executablePath: CHROMIUM,
      args: ['--no-sandbox', ...(options.length > 0 ? options : SOFTWARE)],
      // Disable puppeteer's limit, because browser.py ends a session that hangs.
      timeout: 0,
      protocolTimeout: 0,
    };
    browser = await launch(settings);
    return browser.version();
  },
  // A new page that records its requests and its errors.
  async open(url, { width, height, touch = false, scheme = 'dark', waits = true }) {
    if (page) await page.close();
    page = await browser.newPage();
    page.setDefaultTimeout(0);
    requests = [];
    page.on('request', (request) => requests.push(request.url()));
    page.on('pageerror', (error) => requests.push(`error: ${error.message}`));
    page.on('console', (message) => {
      if (message.type() === 'error') requests.push(`console: ${message.text()}`);
    });
    await page.setViewport({ width, height, hasTouch: touch, isMobile: touch });
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: scheme }]);
    // Ignore incomplete answers, because the page reports these errors itself.
    opening = page.goto(url).catch(() => null);
    if (waits) await calls.opened();
  },
  async opened() {
    await opening;
    await page.waitForSelector('[data-state=rest], [role=alert]');
  },
  awaits: (condition) => page.waitForFunction(condition),
  requests: () => requests,
  async resize(width, height) {
    await page.setViewport({ width, height });
    await page.waitForFunction(`innerWidth === ${width} && innerHeight === ${height}`);
  },
  atRest: () => page.waitForSelector('[data-state=rest]'),
  evaluate: (script) => page.evaluate(script),
  async press(keys, focus) {
    if (focus) await page.focus(focus);
    for (const key of keys) await page.keyboard.press(key);
  },
  click: (selector) => page.click(selector),
  async drag(from, to) {
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 3 });
    await page.mouse.up();
  },
  async wheel(at, delta) {
    await page.mouse.move(...at);
    await page.mouse.wheel({ deltaY: delta });
  },
  async touchDrag(from, to) {
    await page.touchscreen.touchStart(...from);
    await page.touchscreen.touchMove(...to);
    await page.touchscreen.touchEnd();
  },
  screenshot: (path) => page.screenshot({ path }),
  tree: () => page.accessibility.snapshot(),
  close: () => browser.close(),
};

for await (const line of createInterface({ input: process.stdin })) {
  const { call, with: given } = JSON.parse(line);
  try {
    const result = await calls[call](...given);
    // Waiting for elements returns a handle, which cannot be sent.
    const isHandle = result?.constructor?.name.includes('Handle');
    console.log(JSON.stringify({ result: isHandle ? null : (result ?? null) }));
  } catch (error) {
    console.log(JSON.stringify({ error: String(error) }));
  }
  if (call === 'close') process.exit();
}
