// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// node build.mjs [FILE]: bundles src/ into one page without data, dist/report.html, which the library carries.
import { build } from 'esbuild';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, 'dist', 'report.html');

const bundled = await build({
  absWorkingDir: here,
  entryPoints: ['src/main.ts', 'src/style.css'],
  outdir: 'unused',
  write: false,
  bundle: true,
  minify: true,
  charset: 'ascii',
  format: 'iife',
  target: ['chrome100', 'firefox113', 'safari16.4'],  // the first with DecompressionStream, or nearly
  legalComments: 'none',
});
const text = (end) => bundled.outputFiles.find((file) => file.path.endsWith(end)).text.trim();
const license = readFileSync(join(here, 'node_modules/three/LICENSE'), 'utf8').trim();
const script = text('.js').replaceAll('</script', '<\\/script');
const page = readFileSync(join(here, 'src/page.html'), 'utf8')
  .replace('/*style*/', () => text('.css'))
  .replace('/*script*/', () => `/* Includes three.js:\n${license}\n*/\n${script}`);
if (!page.includes('<!--partpose-report-data-->')) throw new Error('page.html has no place for the data');
mkdirSync(dirname(out), { recursive: true });
writeFileSync(out, page);
console.log(`${out}: ${(page.length / 1024).toFixed(0)} KiB`);
