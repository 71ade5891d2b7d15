# SPDX-License-Identifier: GPL-3.0-or-later
"""The web page as a widget of a notebook, which shares its isovalue with Python."""

from typing import Any

import anywidget
import traitlets

from ..bake.baked import Bake
from ..volume.setting_error import check_is_baked

# Messages of the page: web/src/around.ts.
_SCRIPT = """
function render({ model, el }) {
  const frame = document.createElement('iframe');
  frame.srcdoc = model.get('_page');
  frame.height = model.get('_height');
  frame.allowFullscreen = true;
  frame.style.cssText = 'width: 100%; border: none';
  let shown = null; // isovalue of the page; null: the page is not open
  const send = () => {
    const isovalue = model.get('isovalue');
    if (shown === null || shown === isovalue) return;
    shown = isovalue;
    frame.contentWindow?.postMessage({ isovalue }, '*');
  };
  const receive = ({ source, data }) => {
    if (source !== frame.contentWindow || typeof data?.isovalue !== 'number') return;
    shown = data.isovalue;
    if (data.isFirst) return send();
    model.set('isovalue', shown);
    model.save_changes();
  };
  window.addEventListener('message', receive);
  model.on('change:isovalue', send);
  el.append(frame);
  return () => {
    window.removeEventListener('message', receive);
    model.off('change:isovalue', send);
  };
}
export default { render };
"""


class PageWidget(anywidget.AnyWidget):  # type: ignore[misc]
    """The web page of a bake, and its isovalue as a trait.

    isovalue: Isovalue of the page. Python and the page both change it. A value outside the baked
        range raises LeaflightError.
    """

    _esm = _SCRIPT
    _page = traitlets.Unicode().tag(sync=True)
    _height = traitlets.Int().tag(sync=True)
    isovalue = traitlets.Float().tag(sync=True)

    def __init__(self, bake: Bake, page: str, isovalue: float, height: int) -> None:
        self._isovalues = bake.isovalues
        super().__init__(_page=page, _height=height, isovalue=isovalue)

    @traitlets.validate("isovalue")  # type: ignore[untyped-decorator]
    def _is_baked(self, proposal: Any) -> float:
        isovalue = float(proposal["value"])
        check_is_baked(isovalue, self._isovalues)
        return isovalue
