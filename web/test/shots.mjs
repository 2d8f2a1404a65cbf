// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// node test/shots.mjs REPORT FOLDER HASH...: a picture of each page, light (and dark with DARK=1).
import { Browser } from './chromium.mjs';
import { join } from 'node:path';

const [file, folder, ...hashes] = process.argv.slice(2);
const browser = await Browser.open({ dark: Boolean(process.env.DARK), width: Number(process.env.W ?? 1280), height: Number(process.env.H ?? 800) });
let i = 0;
for (const hash of hashes) {
  const [address, ...keys] = hash.split('!');
  console.log(address, Math.round(await browser.goto(file, "document.querySelector('main') && !document.querySelector('.loading')", address)), 'ms');
  for (const key of keys) await browser.key(key);
  await new Promise((resolve) => setTimeout(resolve, 700));
  await browser.screenshot(join(folder, `shot${i++}.png`));
}
for (const complaint of browser.complaints) console.log('COMPLAINT', complaint);
await browser.close();
