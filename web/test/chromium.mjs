// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// A headless Chromium without network, driven over the DevTools protocol through pipes: nothing to install but Chromium.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { delimiter, join } from 'node:path';
import { pathToFileURL } from 'node:url';

const names = ['chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable'];

export function findChromium() {
  if (process.env.CHROMIUM) return process.env.CHROMIUM;
  for (const folder of (process.env.PATH ?? '').split(delimiter))
    for (const name of names) if (existsSync(join(folder, name))) return join(folder, name);
  throw new Error('no Chromium found: install it (apt-get install chromium) or set CHROMIUM to its path');
}

export class Browser {
  #process;
  #profile = mkdtempSync(join(tmpdir(), 'partpose_chromium_'));
  #next = 1;
  #waiting = new Map();
  #session;
  complaints = []; // errors on the console, exceptions, requests that left the page

  static async open({ width = 1280, height = 800, dark = false } = {}) {
    const browser = new Browser();
    await browser.#start(width, height, dark);
    return browser;
  }

  async #start(width, height, dark) {
    this.#process = spawn(findChromium(), [
      '--headless=new', '--no-sandbox', '--remote-debugging-pipe', `--user-data-dir=${this.#profile}`, '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-extensions',
      '--disable-dev-shm-usage', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--mute-audio',
      '--host-resolver-rules=MAP * ~NOTFOUND', 'about:blank',
    ], { stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe'] });
    let log = '';
    this.#process.stderr.on('data', (data) => (log = (log + data).slice(-4000)));
    this.#process.on('exit', (code) => {
      for (const { reject } of this.#waiting.values()) reject(new Error(`Chromium ended (${code}):\n${log}`));
      this.#waiting.clear();
    });
    let rest = Buffer.alloc(0);
    this.#process.stdio[4].on('data', (data) => {
      rest = Buffer.concat([rest, data]);
      for (let end; (end = rest.indexOf(0)) >= 0; rest = rest.subarray(end + 1)) this.#hear(JSON.parse(rest.subarray(0, end)));
    });
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank' });
    this.#session = (await this.send('Target.attachToTarget', { targetId, flatten: true })).sessionId;
    for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await this.send(`${domain}.enable`);
    await this.send('Network.emulateNetworkConditions', { offline: true, latency: 0, downloadThroughput: 0, uploadThroughput: 0 });
    await this.resize(width, height);
    await this.theme(dark);
  }

  #hear(message) {
    const { id, method, params } = message;
    if (id !== undefined) {
      const waiting = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (message.error) waiting?.reject(new Error(`${waiting.method}: ${message.error.message}`));
      else waiting?.resolve(message.result);
    } else if (method === 'Runtime.exceptionThrown') {
      this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    } else if (method === 'Runtime.consoleAPICalled' && ['error', 'warning', 'assert'].includes(params.type)) {
      this.complaints.push(`console.${params.type}: ${params.args.map((a) => a.value ?? a.description).join(' ')}`);
    } else if (method === 'Log.entryAdded' && ['error', 'warning'].includes(params.entry.level)) {
      // The software renderer of a machine without a graphics card tells how slow it is.
      if (!/swiftshader|GPU stall|GL Driver Message/i.test(params.entry.text)) this.complaints.push(`${params.entry.level}: ${params.entry.text}`);
    } else if (method === 'Network.requestWillBeSent' && !/^(file|data|blob|about):/.test(params.request.url)) {
      this.complaints.push(`request to ${params.request.url}`);
    }
  }

  send(method, params = {}) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve, reject, method });
      this.#process.stdio[3].write(JSON.stringify({ id, method, params, ...(this.#session && { sessionId: this.#session }) }) + '\0');
    });
  }

  resize(width, height) {
    return this.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
  }

  theme(dark) {
    return this.send('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }] });
  }

  /** Opens a file; resolves when `expression` is true there. Returns the milliseconds until then. */
  async goto(file, expression, hash = '') {
    const start = performance.now();
    await this.send('Page.navigate', { url: 'about:blank' });
    await this.send('Page.navigate', { url: pathToFileURL(file).href + hash });
    await this.until(expression);
    return performance.now() - start;
  }

  /** The value of a JavaScript expression in the page; promises are awaited. */
  async value(expression) {
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
    return result.value;
  }

  async until(expression, seconds = 60) {
    const end = performance.now() + 1000 * seconds;
    for (;;) {
      try {
        if (await this.value(`Boolean(${expression})`)) return;
      } catch (error) {
        if (!/navigat|context/i.test(String(error))) throw error;
      }
      if (performance.now() > end) throw new Error(`not within ${seconds} s: ${expression}`);
      await new Promise((resolve) => setTimeout(resolve, 30));
    }
  }

  /** Clicks the middle of the first element of a selector with the mouse, as a person would. */
  async click(selector) {
    const at = await this.value(`(() => {
      const element = document.querySelector(${JSON.stringify(selector)});
      if (!element) return null;
      element.scrollIntoView({ block: 'center', inline: 'center' });
      const box = element.getBoundingClientRect();
      const at = { x: box.left + box.width / 2, y: box.top + box.height / 2 };
      const top = document.elementFromPoint(at.x, at.y);
      return element === top || element.contains(top) ? at : { covered: top?.outerHTML.slice(0, 200) ?? 'nothing' };
    })()`);
    if (!at) throw new Error(`nothing to click: ${selector}`);
    if (at.covered) throw new Error(`${selector} is covered by ${at.covered}`);
    await this.mouse('mouseMoved', at);
    await this.mouse('mousePressed', at, { button: 'left', clickCount: 1 });
    await this.mouse('mouseReleased', at, { button: 'left', clickCount: 1 });
  }

  mouse(type, { x, y }, more = {}) {
    return this.send('Input.dispatchMouseEvent', { type, x, y, ...more });
  }

  async key(key, more = {}) {
    await this.send('Input.dispatchKeyEvent', { type: 'keyDown', key, ...(key.length === 1 && { text: key }), ...more });
    await this.send('Input.dispatchKeyEvent', { type: 'keyUp', key, ...more });
  }

  async screenshot(file) {
    const { data } = await this.send('Page.captureScreenshot', { format: 'png' });
    writeFileSync(file, Buffer.from(data, 'base64'));
  }

  async close() {
    const ended = new Promise((resolve) => this.#process.once('exit', resolve));
    this.send('Browser.close').catch(() => {});
    const timer = setTimeout(() => this.#process.kill('SIGKILL'), 5000);
    await ended;
    clearTimeout(timer);
    rmSync(this.#profile, { recursive: true, force: true, maxRetries: 5 });
  }
}
