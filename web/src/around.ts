// SPDX-License-Identifier: GPL-3.0-or-later
// Shares the isovalue with the document around an iframe, by messages { isovalue }.

import type { Panel } from './panel';
import type { View } from './view';

export function shareIsovalue(panel: Panel, view: View): void {
  if (parent === window) return;
  let shared = NaN; // no message has been sent
  addEventListener('message', ({ source, data }: MessageEvent<{ isovalue?: unknown } | null>) => {
    const isovalue = data?.isovalue;
    if (source !== parent || typeof isovalue !== 'number' || !Number.isFinite(isovalue)) return;
    panel.show(isovalue);
    shared = panel.isovalue;
  });
  view.onDrawn(() => {
    const { isovalue } = panel;
    if (isovalue === shared) return;
    parent.postMessage({ isovalue, isFirst: Number.isNaN(shared) }, '*');
    shared = isovalue;
  });
}
