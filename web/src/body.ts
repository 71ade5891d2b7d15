// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the data of the page while the browser is still loading it.

import { Failure } from './failure';

export const DAMAGED = 'The data in this page are damaged or not whole: fetch or export it again.';

const BODY = 'leaflight-body';

// Lets the browser load and draw.
export function pause(): Promise<void> {
  return new Promise((done) => setTimeout(done, 0));
}

function isOpened(): boolean {
  return document.readyState !== 'loading';
}

// Returns an element once it is loaded completely, or null if the page ends before.
export async function arrived(id: string): Promise<HTMLElement | null> {
  for (;;) {
    const all = isOpened();
    const element = document.getElementById(id);
    if (all || element?.nextSibling) return element;
    await pause();
  }
}

// Reads bytes from the elements of the page, or from bake.bin beside it.
export async function readBody(bytes: number, report: (share: number) => void): Promise<Uint8Array> {
  const body = new Uint8Array(bytes);
  let at = 0;
  const add = (part: Uint8Array) => {
    if (at + part.length > bytes) throw new Failure(DAMAGED);
    body.set(part, at);
    at += part.length;
    report(at / bytes);
  };
  await start();
  if (document.getElementById(BODY)) await readElements(add);
  else await fetchParts('bake.bin', add);
  if (at !== bytes) throw new Failure(DAMAGED);
  return body;
}

// Wait until the source of the data is known.
async function start(): Promise<void> {
  while (!isOpened() && !document.getElementById(BODY)) await pause();
}

async function readElements(add: (part: Uint8Array) => void): Promise<void> {
  for (;;) {
    const all = isOpened();
    const part = document.getElementById(BODY)?.firstElementChild;
    if (!part && all) return;
    if (part && (all || part.nextElementSibling)) {
      add(decoded(part.textContent));
      part.remove(); // frees its memory
    }
    await pause();
  }
}

// Not all browsers have scheduler.yield().
interface FromBase64 {
  fromBase64?: (text: string) => Uint8Array;
}

function decoded(text: string): Uint8Array {
  try {
    const native = (Uint8Array as FromBase64).fromBase64?.(text);
    if (native) return native;
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
    return bytes;
  } catch {
    throw new Failure(DAMAGED);
  }
}

async function fetchParts(name: string, add: (part: Uint8Array) => void): Promise<void> {
  let stream: ReadableStreamDefaultReader<Uint8Array> | undefined;
  try {
    const answer = await fetch(name);
    stream = answer.ok ? answer.body?.getReader() : undefined;
  } catch {
    stream = undefined;
  }
  if (!stream) {
    throw new Failure(
      `The file ${name} beside this page cannot be read: put both on a web server, ` +
        'or export one file.',
    );
  }
  for (;;) {
    const { done, value } = await stream.read().catch(() => {
      throw new Failure(DAMAGED);
    });
    if (done) return;
    add(value);
  }
}
