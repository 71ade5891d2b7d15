// SPDX-License-Identifier: GPL-3.0-or-later
// Loads a compiled module of the page without a browser: load('pace').
import { build } from 'esbuild';

export async function load(name) {
  const built = await build({
    entryPoints: [new URL(`../src/${name}.ts`, import.meta.url).pathname],
    bundle: true,
    write: false,
    format: 'esm',
  });
  return import(`data:text/javascript,${encodeURIComponent(built.outputFiles[0].text)}`);
}
