// SPDX-License-Identifier: GPL-3.0-or-later
// Errors as one sentence for the user of the page.

export class Failure extends Error {}

export function showFailure(error: unknown): void {
  const message = document.createElement('p');
  message.id = 'message';
  message.setAttribute('role', 'alert');
  message.textContent =
    error instanceof Failure
      ? error.message
      : `This page could not be shown (${String(error)}): open it in another browser.`;
  document.body.replaceChildren(message);
}
