# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the web page in a browser: its pictures against the core's, its interface, its messages."""

import functools
import http.server
import threading

import leaflight
import numpy as np
import pytest
from browser import FRAMES, Browser
from leaflight.scene.lights import strengths_of
from leaflight.stills.camera import ANGLE, Camera
from leaflight.stills.photograph import tone_mapped

SIZE = {"width": 320, "height": 200}
ISOVALUE = "leaflight.view.look.isosurfaces[0].isovalue"
# Keys pressed on the slider before pictures are compared: to the end, back by tenths and by steps.
KEYS = (["Home", "PageUp", "PageUp", "PageUp"], ["PageUp", "ArrowRight"], ["PageUp", "ArrowLeft"])


def linear(colors):
    """Returns the linear values of uint8 sRGB colors."""
    encoded = colors / 255.0
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def difference_percent(picture, still, exposure):
    """Returns, in percent, the RMS of colors 0..1 as in compare() over pixels that both fill, and
    the share that only one fills.
    """
    filled, expected = picture[..., 3] == 255, still[..., 3] == 1
    both = filled & expected
    assert both.sum() > 2000
    off = linear(picture[both][:, :3]) - tone_mapped(still[both][:, :3] * exposure)
    return 100 * np.sqrt((off**2).mean()), 100 * (filled != expected).mean()


def camera_of(browser):
    """Returns the Camera of the page."""
    seen = browser.evaluate("leaflight.view.orbit.viewpoint")
    position, target, up = (tuple(seen[name]) for name in ("position", "target", "up"))
    return Camera(position, target, up, ANGLE)


def exposure_of(browser, bake):
    return bake.scene.exposure * 2.0 ** browser.evaluate("leaflight.view.look.stops")


def check_like_still(browser, bake, **options):
    isovalue, picture = browser.evaluate(ISOVALUE), browser.picture()
    size, camera = picture.shape[1::-1], camera_of(browser)
    still = leaflight.still(bake, isovalue, camera, size, samples=1, **options)
    off, alone = difference_percent(picture, still, exposure_of(browser, bake))
    assert off <= 1.0 and alone <= 0.1, f"isovalue {isovalue}: {off:.3f} %, alone {alone:.3f} %"


@pytest.mark.parametrize("side", ["front", "back"])
def test_shadows_have_the_edges_of_the_core(browser, bakes, pages, side):
    bake = bakes("shadows")
    browser.open(pages("shadows").as_uri(), SIZE)
    if side == "back":
        browser.evaluate("leaflight.view.orbit.turn(-60, -60, 1.2)")
    camera = camera_of(browser)
    for isovalue in (-10, 10, 30):
        browser.evaluate(f"{ISOVALUE} = {isovalue}; leaflight.view.changed()")
        picture = browser.picture()
        still = leaflight.still(bake, isovalue, camera, picture.shape[1::-1], samples=1)
        both = (picture[..., 3] == 255) & (still[..., 3] == 1)
        expected = tone_mapped(still[both][:, :3] * exposure_of(browser, bake))
        off = abs(linear(picture[both][:, :3]) - expected).max(axis=1)
        # With the light of texels alone, 1 to 2 % of the pixels are wrong, at edges of shadows.
        mean, wrong = 100 * off.mean() / expected.max(), 100 * (off > 0.05).mean()
        assert mean <= 0.25 and wrong <= 0.15, f"{isovalue}: mean {mean:.2f} %, {wrong:.2f} % wrong"


# Strengths and sRGB colors of lamps; None: color of the bake. The sun does not change.
LAMPS = {1: (0.5, None), 2: (2.0, "#20ff40"), 3: (0.0, None)}


def with_lamps(bake, chosen):
    """Returns the bake with these lamps, by their numbers, as the page shows it."""
    factors = {}
    for number, (strength, color) in chosen.items():
        light = bake.scene.lights[number]
        baked = np.array(strengths_of(light))
        as_baked = color is None
        hue = baked / baked.max() if as_baked else linear(np.array([*bytes.fromhex(color[1:])]))
        factors[light.name] = tuple(strength * hue * baked.max() / baked)
    return bake.relit(factors)


def choose_lamps(browser, chosen):
    """Sets the lamps by the controls."""
    change = (
        "(e => (e.value = '{}', e.dispatchEvent(new Event('input'))))"
        "(document.getElementById('{}'))"
    )
    for number, (strength, color) in chosen.items():
        browser.evaluate(change.format(strength, f"strength-{number}"))
        if color is not None:
            browser.evaluate(change.format(color, f"lamp-color-{number}"))
    browser.atRest()


def test_lamps_change_as_in_relit(browser, bakes, pages):
    """Checks isosurfaces, their backs, walls and local shading. The link must keep the
    strengths.
    """
    bake, url = bakes("shadows"), pages("shadows").as_uri()
    browser.open(url, SIZE)
    choose_lamps(browser, LAMPS)
    relit = with_lamps(bake, LAMPS)
    check_like_still(browser, relit)
    with pytest.raises(AssertionError):
        check_like_still(browser, bake)
    link = browser.evaluate("location.hash")
    browser.evaluate("leaflight.view.orbit.turn(-60, -60, 1.2)")
    check_like_still(browser, relit)
    browser.click("#local")
    check_like_still(browser, relit, local=True)
    browser.open(url + link, SIZE)
    check_like_still(browser, relit)
    # The page of a relit bake starts with its strengths.
    path = pages("shadows").with_name("relit.html")
    relit.export_page(path)
    browser.open(path.as_uri(), SIZE)
    check_like_still(browser, relit)
    choose_lamps(browser, {0: (3.0, None)})
    check_like_still(browser, with_lamps(relit, {0: (3.0, None)}))


@pytest.mark.parametrize("name", ["colored", "labeled"])
def test_another_volume_colors_isosurfaces_as_in_the_core(browser, bakes, pages, name):
    bake = bakes(name)
    browser.open(pages(name).as_uri(), SIZE)
    check_like_still(browser, bake)
    browser.evaluate("leaflight.view.orbit.turn(-60, -60, 1.2)")
    check_like_still(browser, bake)
    browser.click("#local")
    check_like_still(browser, bake, local=True)
    browser.open(pages(name).as_uri() + browser.evaluate("location.hash"), SIZE)
    check_like_still(browser, bake, local=True)


def is_local(url):
    return url.startswith(("data:", "blob:"))


def test_cuts_are_flat_as_in_the_core(browser, bakes, pages):
    """Checks the middle of a face, where the values have dents and the plane has none."""
    bake, face = bakes("halved"), np.s_[126:156, 112:224]
    browser.open(pages("halved").as_uri(), SIZE)
    browser.press(KEYS[0], "#isovalue")
    picture, camera = browser.picture(), camera_of(browser)
    still = leaflight.still(
        bake, browser.evaluate(ISOVALUE), camera, picture.shape[1::-1], samples=1
    )
    off, _ = difference_percent(picture[face], still[face], exposure_of(browser, bake))
    assert off <= 0.5


@pytest.mark.slow
@pytest.mark.parametrize("name", ["box", "brain", "oblong", "two", "noisy"])
def test_pictures_are_those_of_the_core(browser, bakes, pages, name):
    bake, url = bakes(name), pages(name).as_uri()
    browser.open(url, SIZE)
    seen = set()
    for keys in KEYS:
        browser.press(keys, "#isovalue")
        seen.add(browser.evaluate(ISOVALUE))
        check_like_still(browser, bake)
    assert len(seen) == 3
    browser.click("#local")
    check_like_still(browser, bake, local=True)
    # The page must send no request and report no error.
    assert [request for request in browser.requests() if not is_local(request)] == [url]


@pytest.mark.slow
@pytest.mark.parametrize("isovalue", [70.5, 80.5])
def test_shadows_of_thin_shells_are_those_of_the_core(browser, bakes, pages, isovalue):
    """Checks a thin shell, where the visibility codes of all light points are close to that of the
    isosurface.
    """
    browser.open(pages("brain").as_uri(), {"width": 640, "height": 400})
    browser.evaluate(f"{ISOVALUE} = {isovalue}; leaflight.view.changed()")
    check_like_still(browser, bakes("brain"))


@pytest.mark.slow
def test_a_pixel_costs_few_fetches(browser, pages):
    browser.open(pages("brain").as_uri(), {"width": 320, "height": 180})
    for keys in KEYS:
        browser.press(keys, "#isovalue")
        browser.hide_panel(True)
        browser.atRest()
        counted = browser.evaluate("leaflight.view.countFetches()")
        browser.hide_panel(False)
        assert 5 < counted["ofPicture"] <= 150 and counted["ofBox"] >= counted["ofPicture"]


def test_the_page(browser, bakes, pages):
    """Checks that it shows the light of the bake, and that its controls work."""
    browser.open(pages("box").as_uri(), {"width": 800, "height": 300})
    check_like_still(browser, bakes("box"))
    lo, hi = bakes("box").isovalues
    position = "leaflight.view.camera.position.toArray()"

    def changed(act, what=position):
        before = browser.evaluate(what)
        act()
        browser.atRest()
        return browser.evaluate(what) != before

    def middle(selector):
        return browser.evaluate(
            f"(r => [r.x + r.width / 2, r.y + r.height / 2])"
            f"(document.querySelector('{selector}').getBoundingClientRect())"
        )

    # Slider, histogram and number must show one isovalue.
    x, y = middle("#histogram")
    browser.drag([x - 20, y], [x, y])
    assert abs(browser.evaluate(ISOVALUE) - (lo + hi) / 2) < 0.01 * (hi - lo)
    slider = browser.evaluate("document.querySelector('#isovalue').valueAsNumber")
    assert slider == pytest.approx(browser.evaluate(ISOVALUE))
    browser.evaluate(
        "document.querySelector('#number').value = '80';"
        "document.querySelector('#number').dispatchEvent(new Event('change'))"
    )
    assert browser.evaluate(ISOVALUE) == 80
    # Rotate the view by mouse and keys, and restore it.
    assert changed(lambda: browser.drag([600, 150], [660, 180]))
    assert changed(lambda: browser.press(["ArrowLeft", "+"], "#view"))
    assert changed(lambda: browser.press(["r"]))
    # Another isosurface, the walls, the clip and the exposure change the picture.
    for selector in ("#add", "#walls", "#has-clip"):
        before = browser.picture()
        browser.click(selector)
        off = (browser.picture() != before).any(axis=-1).mean()
        assert off > 0.02, selector
    # The cut shows values as gray.
    colors = browser.picture()
    gray = (colors[..., 3] == 255) & (np.ptp(colors[..., :3].astype(int), axis=-1) <= 1)
    assert gray.mean() > 0.002
    # Play the isovalue and stop it.
    start = browser.evaluate(ISOVALUE)
    browser.press([" "], "#view")
    browser.evaluate(
        f"new Promise(done => {{ const look = () => {ISOVALUE} === {start}"
        " ? requestAnimationFrame(look) : done(); look(); })"
    )
    browser.press([" "])
    browser.atRest()
    stopped = browser.evaluate(ISOVALUE)
    browser.evaluate(FRAMES)
    assert stopped != start and browser.evaluate(ISOVALUE) == stopped
    # It must adapt to the size of its window.
    browser.resize(200, 300)
    assert browser.picture().shape == (300, 200, 4)


@pytest.mark.slow
def test_a_screen_reader_finds_the_controls(browser, pages):
    browser.open(pages("box").as_uri(), {**SIZE, "scheme": "light"})

    def nodes(tree):
        yield tree
        for child in tree.get("children", []):
            yield from nodes(child)

    found = {(node["role"], node.get("name", "")): node for node in nodes(browser.tree())}
    slider = found["slider", "Isovalue"]
    assert slider["valuetext"].startswith("75.7")
    for name in ("Play", "Local shading", "About"):
        assert ("button", name) in found
    assert any(role in ("image", "img") and "isovalue 75.7" in name for role, name in found)
    assert (
        browser.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(236, 234, 230)"
    )


@pytest.mark.slow
def test_a_phone_turns_it_by_touch(browser, bakes, pages):
    browser.open(pages("oblong").as_uri(), {"width": 360, "height": 640, "touch": True})
    before = browser.evaluate("leaflight.view.camera.position.toArray()")
    browser.touchDrag([180, 150], [240, 190])
    browser.atRest()
    assert browser.evaluate("leaflight.view.camera.position.toArray()") != before
    # The panel must fit the screen, and the canvas must fill it.
    panel = "document.querySelector('#panel').getBoundingClientRect()"
    assert browser.evaluate(f"{panel}.right") <= 360 and browser.evaluate(f"{panel}.top") > 200
    x, y, width = browser.evaluate(
        "(r => [r.x, r.y + r.height / 2, r.width])"
        "(document.querySelector('#histogram').getBoundingClientRect())"
    )
    browser.touchDrag([x + 40, y], [x + 0.25 * width, y])
    lo, hi = bakes("oblong").isovalues
    assert browser.evaluate(ISOVALUE) == pytest.approx(lo + 0.25 * (hi - lo), abs=0.01 * (hi - lo))


@pytest.mark.slow
def test_damaged_files_show_a_sentence(browser, pages, tmp_path):
    text = pages("oblong").read_text()
    body = text.index('id="leaflight-body"')
    header = text.index('id="leaflight-header"')
    damaged = tmp_path / "damaged.html"
    for broken in (
        text[: body + (len(text) - body) // 2],
        text[: body + 5000] + "AAAAAAAA" + text[body + 5008 :],
        text[: body + 5000] + "????????" + text[body + 5008 :],
        text[: header + 200],
        text[:header],
    ):
        damaged.write_text(broken)
        browser.open(damaged.as_uri(), SIZE)
        said = browser.evaluate("document.querySelector('[role=alert]').textContent")
        assert "damaged or not whole" in said


@pytest.mark.slow
def test_a_volume_that_no_card_takes_shows_a_sentence(browser, pages, tmp_path):
    text = pages("oblong").read_text()
    large = tmp_path / "large.html"
    large.write_text(text.replace('"dims": [26,', '"dims": [90000,'))
    browser.open(large.as_uri(), SIZE)
    said = browser.evaluate("document.querySelector('[role=alert]').textContent")
    assert "90000 points along one axis" in said and "export it coarser" in said


@pytest.mark.slow
def test_a_folder_on_a_server(browser, bakes, tmp_path):
    path = leaflight.export_page(bakes("oblong"), tmp_path / "oblong.html", embed=True)
    assert path == tmp_path / "oblong" / "index.html"
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=tmp_path)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        url = f"http://127.0.0.1:{server.server_address[1]}/oblong/"
        browser.open(url, SIZE)
        check_like_still(browser, bakes("oblong"))
        asked = [request for request in browser.requests() if not is_local(request)]
        assert asked == [url, f"{url}bake.bin"]
        (tmp_path / "oblong" / "bake.bin").unlink()
        browser.open(url, SIZE)
        said = browser.evaluate("document.querySelector('[role=alert]').textContent")
        assert "bake.bin beside this page cannot be read" in said
        server.shutdown()


@pytest.mark.slow
def test_a_browser_without_webgl_shows_a_sentence(pages):
    browser = Browser("--disable-3d-apis")
    try:
        browser.open(pages("oblong").as_uri(), SIZE)
        said = browser.evaluate("document.querySelector('[role=alert]').textContent")
        assert "needs WebGL 2" in said
    finally:
        browser.end()
