// SPDX-License-Identifier: GPL-3.0-or-later
// The progress bar over the first picture while the page loads.

function element(id: string): HTMLElement | null {
  return document.getElementById(id);
}

export function tellOpening(share: number, step: string): void {
  const bar = element('progress') as HTMLProgressElement | null;
  const text = element('step');
  if (bar) bar.value = share;
  if (text && text.textContent !== step) text.textContent = step;
}

export function endOpening(): void {
  element('opening')?.remove();
  element('poster')?.remove();
  element('panel')?.removeAttribute('inert');
}
