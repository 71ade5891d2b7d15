# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes docs/images/web_page*.webp, the page of Colin27 with a cut in Debian's Chromium, on a
desktop and a phone. Prints the seconds of a table of docs/validation.md, by software WebGL.
"""

import os
import tempfile
from pathlib import Path

import leaflight
from browser import Browser
from PIL import Image
from volume_recipes import COLIN27

from .sheets import save_webp

ROOT = Path(__file__).resolve().parents[2]

PICTURES = ROOT / "docs" / "images"
DESK = {"width": 1280, "height": 720}
PHONE = {"width": 390, "height": 844, "touch": True}
# Link with an isovalue, and a cut from the front; its depth is a share.
LOOK = "#isovalue=45.5&clip=3,0.45"
# Link with the skull in translucent skin.
LOOKS = "#isovalue=110,30&opacity=1,0.25&colors=IVORY,SKIN&walls=0"
ISOVALUES = 8

# Script that returns the time of the picture shown while the page loads.
FIRST = """new Promise((done) => {
  new PerformanceObserver((list) => done(list.getEntries().pop().startTime))
    .observe({ type: 'largest-contentful-paint', buffered: true });
})"""
# Script that returns milliseconds from an isovalue to its first and its complete picture.
MOVES = f"""(async () => {{
  const {{ view, panel }} = leaflight, drawn = [], whole = [];
  const input = document.getElementById('isovalue');
  const [least, most] = [Number(input.min), Number(input.max)];
  for (let k = 0; k < {ISOVALUES}; ++k) {{
    const start = performance.now();
    const next = (state) => new Promise((done) => {{
      let isDone = false;
      view.onDrawn((atRest) => {{ if (!isDone && atRest === state) {{ isDone = true; done(); }} }});
    }});
    const pictures = [next(false), next(true)];
    panel.setIsovalue(least + ((k + 1) / ({ISOVALUES} + 2)) * (most - least));
    await pictures[0];
    drawn.push(performance.now() - start);
    await pictures[1];
    whole.push(performance.now() - start);
  }}
  const middle = (times) => times.sort((a, b) => a - b)[times.length >> 1];
  return [middle(drawn), middle(whole)];
}})()"""


def main():
    bake = leaflight.bake(leaflight.read_volume(COLIN27), walls=True)
    with tempfile.TemporaryDirectory(prefix="leaflight-") as folder:
        page = Path(folder) / "colin27.html"
        bake.export_page(page)
        print(f"file {page.stat().st_size / 1e6:.0f} MB, load {os.getloadavg()[0]:.0f}")
        browser = Browser()
        for name, size in (("web_page", DESK), ("web_page_phone", PHONE)):
            browser.open(page.as_uri() + LOOK, size)
            seconds = [browser.evaluate(FIRST), browser.evaluate("performance.now()")]
            seconds += browser.evaluate(MOVES)
            words = ("first picture", "whole picture", "isovalue, first", "isovalue, whole")
            print(
                name, *(f"{word} {ms / 1000:.2f} s" for word, ms in zip(words, seconds)), sep=", "
            )
            browser.open(page.as_uri() + LOOK, size)
            save(browser, name, folder)
        # Show all controls, on a phone.
        browser.evaluate(
            "document.querySelectorAll('details').forEach(e => (e.open = true));"
            "document.querySelector('#more').scrollIntoView()"
        )
        save(browser, "web_page_phone_more", folder)
        browser.open(page.as_uri() + LOOKS, DESK)
        save(browser, "web_page_looks", folder)
        browser.end()


def save(browser, name, folder):
    browser.atRest()
    path = os.path.join(folder, "picture.png")
    browser.screenshot(path)
    save_webp(Image.open(path), PICTURES / f"{name}.webp")
    print(f"docs/images/{name}.webp")
