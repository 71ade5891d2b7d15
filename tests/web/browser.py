# SPDX-License-Identifier: GPL-3.0-or-later
"""Debian's Chromium, driven by puppeteer-core in a Node process (web/tests/session.mjs)."""

import base64
import io
import json
import os
import shutil
import subprocess
import threading
from pathlib import Path

import numpy as np
from PIL import Image
from waiting import HANG

ROOT = Path(__file__).resolve().parents[2]
SESSION = ROOT / "web" / "tests" / "session.mjs"
# Search path that ends with build/venv, where scripts/setup installs what the system lacks.
PATHS = f"{os.environ['PATH']}:{ROOT / 'build' / 'venv' / 'bin'}"

# Promise in JavaScript, which waits until the page has drawn its earlier changes.
FRAMES = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


class Browser:
    """A Chromium without a window; options: of its command line, by default software WebGL.

    Every call of the session is a method: browser.press(["End"], "#isovalue").
    """

    def __init__(self, *options):
        self._session = subprocess.Popen(
            [shutil.which("node", path=PATHS), SESSION],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.version = self.start(*options)

    def __getattr__(self, call):
        def ask(*given):
            print(json.dumps({"call": call, "with": given}), file=self._session.stdin, flush=True)
            watch = threading.Timer(HANG, self._session.terminate)
            watch.daemon = True
            watch.start()
            line = self._session.stdout.readline()
            watch.cancel()
            answer = json.loads(line or '{"error": "the session ended"}')
            assert "error" not in answer, f"{call}: {answer['error']}"
            return answer["result"]

        return ask

    def picture(self):
        """Returns the picture of the view in the whole window, uint8 [row, column, RGBA]."""
        self.hide_panel(True)
        self.atRest()
        url = self.evaluate(
            "leaflight.view.drawNow(1); leaflight.view.canvas.toDataURL('image/png')"
        )
        self.hide_panel(False)
        data = base64.b64decode(url.partition(",")[2])
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))

    def hide_panel(self, is_hidden):
        """Hides or shows the panel and waits until the view has its new size."""
        hidden = str(is_hidden).lower()
        self.evaluate(f"document.querySelector('#panel').hidden = {hidden}; {FRAMES}")

    def end(self):
        self.close()
        self._session.wait(HANG)
