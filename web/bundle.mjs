// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the page without a bake, one file: node bundle.mjs [OUT.html] (dist/page.html).
import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, 'dist', 'page.html');

const built = await build({
  absWorkingDir: here,
  entryPoints: { page: 'src/main.ts', style: 'src/style.css' },
  outdir: 'dist',
  bundle: true,
  minify: true,
  write: false,
  format: 'iife',
  target: 'es2022',
  charset: 'ascii',
  loader: { '.glsl': 'text' },
  legalComments: 'inline',
});
const textOf = (suffix) => built.outputFiles.find((file) => file.path.endsWith(suffix)).text;
const [shell, panel] = await Promise.all(
  ['page.html', 'panel.html'].map((name) => readFile(join(here, 'src', name), 'utf8')),
);
// Pass functions, because a replacement text would interpret $ in the script.
const page = shell
  .replace('/*leaflight:style*/', () => textOf('.css').trim())
  .replace('<!--leaflight:panel-->', () => panel.trim())
  .replace('/*leaflight:script*/', () => textOf('.js').trim());
await mkdir(dirname(out), { recursive: true });
await writeFile(out, page);
