# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests the interface of the page: first view, progress, link, controls."""

import base64
import http.server
import io
import re
import threading

import leaflight._core as _core
import numpy as np
import pytest
from browser import FRAMES
from leaflight.color_maps import MAPS
from leaflight.io.images import display_colors
from leaflight.looks import LOOKS
from leaflight.scene.color_bar import color_bar_of
from leaflight.stills.first_view import camera_around_bake
from PIL import Image
from waiting import HANG

SIZE = {"width": 800, "height": 300}
# The short suite has test_the_page().
pytestmark = pytest.mark.slow
LOOK, VIEWPOINT = "leaflight.view.look", "leaflight.view.orbit.viewpoint"
SHOWN = f"{LOOK}.isosurfaces"
ISOVALUE = f"{SHOWN}[0].isovalue"
MIDDLE = (
    "(r => [r.x + r.width / 2, r.y + r.height / 2])(leaflight.view.canvas.getBoundingClientRect())"
)


@pytest.fixture
def page(browser, pages):
    browser.open(pages("box").as_uri(), SIZE)
    return browser


@pytest.mark.parametrize("size", [SIZE, {"width": 390, "height": 844, "touch": True}])
def test_the_first_view_is_that_of_still(browser, bakes, pages, size):
    bake = bakes("box")
    browser.open(pages("box").as_uri(), size)
    canvas = browser.evaluate(
        "[leaflight.view.canvas.clientWidth, leaflight.view.canvas.clientHeight]"
    )
    expected = camera_around_bake(bake, size=canvas)
    seen = browser.evaluate(VIEWPOINT)
    np.testing.assert_allclose(seen["position"], expected.position, atol=1e-4)
    np.testing.assert_allclose(seen["target"], expected.target, atol=1e-4)
    colors = browser.picture()
    assert (colors[..., 3] == 255).mean() > 0.5
    assert (colors[..., :3].max(axis=-1) == 255).mean() < 0.01


def test_walls_leave_no_pinholes(browser, pages):
    browser.open(pages("box").as_uri(), {"width": 640, "height": 400})
    alpha = browser.picture()[..., 3]
    middle = alpha[150:250, 220:420]
    assert (middle == 255).all()


def test_progress_is_shown_and_damage_only_when_it_is_there(browser, pages):
    data = pages("box").read_bytes()
    half = data.index(b"leaflight-body") + (len(data) - data.index(b"leaflight-body")) // 2
    goes_on, ends = threading.Event(), {"at": len(data)}

    class Slow(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(data[:half])
            self.wfile.flush()
            goes_on.wait(HANG)
            self.wfile.write(data[half : ends["at"]])

        def log_message(self, *_):
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Slow) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        url = f"http://127.0.0.1:{server.server_address[1]}/"
        for end, words in ((len(data), None), (half + 1000, "not whole")):
            goes_on.clear()
            ends["at"] = end
            browser.open(url, {**SIZE, "waits": False})
            browser.awaits(
                "document.querySelector('#step')?.textContent === 'Reading the file'"
                " && document.querySelector('#poster')?.naturalWidth > 100"
            )
            assert browser.evaluate("document.querySelector('#title').textContent") == "bump_box"
            assert browser.evaluate("document.querySelector('#panel').inert")
            assert "whole" not in browser.evaluate("document.body.innerText")
            goes_on.set()
            browser.opened()
            shown = browser.evaluate("document.querySelector('[role=alert]')?.textContent ?? null")
            assert shown is None if words is None else words in shown
            if words is None:
                assert browser.evaluate("!document.querySelector('#poster, #opening')")
        server.shutdown()


def test_it_is_rolled_and_flipped_and_the_link_keeps_all(page, pages):
    first = page.evaluate(VIEWPOINT)
    ups = [first["up"]]
    for _ in range(4):
        page.click("#roll")
        ups.append(page.evaluate(VIEWPOINT)["up"])
    np.testing.assert_allclose(ups[1:], [[-1, 0, 0], [0, 0, -1], [1, 0, 0], [0, 0, 1]], atol=1e-6)
    np.testing.assert_allclose(page.evaluate(VIEWPOINT)["position"], first["position"], atol=1e-6)
    page.click("#flip")
    page.click("#local")
    page.click("#has-clip")
    page.press(["ArrowLeft"], "#view")
    page.atRest()
    page.evaluate(FRAMES)
    link, look = page.evaluate("location.hash"), page.evaluate(LOOK)
    seen, picture = page.evaluate(VIEWPOINT), page.picture()
    assert seen["up"] == [0, 0, -1] and look["isLocal"] and look["clip"]["from"] == 2
    page.open(pages("box").as_uri() + link, SIZE)
    assert page.evaluate(LOOK) == look
    for name, vector in page.evaluate(VIEWPOINT).items():
        np.testing.assert_allclose(vector, seen[name], atol=1e-4)
    off = abs(page.picture().astype(int) - picture).max(axis=-1)
    assert (off > 8).mean() < 0.01
    assert page.evaluate("document.querySelector('#has-clip').checked")


@pytest.mark.parametrize("bake, end", [("box", "2"), ("brain", "3")])
def test_clips_begin_at_the_front(browser, pages, bake, end):
    """Checks that clips start at the front: greatest y of a patient, least y of a room, its
    open side.
    """
    browser.open(pages(bake).as_uri(), SIZE)
    shown = browser.evaluate(
        "(e => [e.value, e.selectedOptions[0].text])(document.querySelector('#clip-from'))"
    )
    assert shown == [end, "front"]
    browser.click("#has-clip")
    assert browser.evaluate(f"{LOOK}.clip.from") == int(end)


def linear(picture):
    """Returns the linear values 0..1 of a picture below its highlights, [row, column, RGB]."""
    shown = picture[..., :3] / 255
    return np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)


def choose(page, control, value):
    page.evaluate(
        f"(e => {{ e.value = '{value}'; e.dispatchEvent(new Event('input')); }})"
        f"(document.querySelector('{control}'))"
    )


def test_slices_show_the_data_in_colors(page, bakes, pages):
    """Checks the data on a plane across y, seen along y. No isosurface hides it."""
    bake = bakes("box")
    low, high = np.asarray(bake.volume.field().bounds)
    place = 0.3
    page.evaluate(f"{ISOVALUE} = {bake.isovalues[1]}")
    page.evaluate(f"{LOOK}.showsWalls = false")
    page.click("#has-slice-1")
    choose(page, "#slice-1", place)
    assert page.evaluate(f"{LOOK}.slices") == [None, place, None]
    page.atRest()
    colors = page.picture()
    # Rays of some pixels, from the page's camera.
    points, pixels = [], ((400, 150), (370, 120), (440, 190), (420, 100), (380, 180))
    for x, y in pixels:
        at = page.evaluate(
            "((x, y) => { const c = leaflight.view.camera, v = c.position.clone()"
            f".set(2 * x / {SIZE['width']} - 1, 1 - 2 * y / {SIZE['height']}, 0.5).unproject(c);"
            f" return [c.position.toArray(), v.toArray()]; }})({x + 0.5}, {y + 0.5})"
        )
        eye, through = np.asarray(at)
        t = (low[1] + place * (high - low)[1] - eye[1]) / (through - eye)[1]
        points.append(eye + t * (through - eye))
    x, y = np.transpose(pixels)
    values = bake.volume.field().sample(np.asarray(points))
    shares = (values - bake.isovalues[0]) / (bake.isovalues[1] - bake.isovalues[0])
    shown = shares > 0.03
    assert shown.sum() >= 3
    gray = np.tile(0.15 + 0.7 * np.clip(shares, 0, 1)[:, None], 3)
    np.testing.assert_allclose(colors[y, x, :3][shown] / 255, gray[shown], atol=0.03)
    choose(page, "#slice-colors", "MAGMA")
    page.atRest()
    magma = np.array([list(bytes.fromhex(color)) for color in MAPS["MAGMA"][2]]) / 255
    expected = [np.interp(8 * shares, range(9), channel) for channel in magma.T]
    colors = page.picture()[y, x, :3] / 255
    np.testing.assert_allclose(colors[shown], np.transpose(expected)[shown], atol=0.03)
    link = page.evaluate("location.hash")
    page.open(pages("box").as_uri() + link, SIZE)
    assert page.evaluate(f"{LOOK}.slices") == [None, place, None]
    assert page.evaluate("document.querySelector('#slice-colors').value") == "MAGMA"


BAR = """(() => {
    const scale = document.querySelector(".color-bar > div"), box = scale.getBoundingClientRect();
    return {
        title: document.querySelector(".color-bar figcaption").textContent,
        background: getComputedStyle(scale).backgroundImage,
        ticks: [...scale.children].map((tick) => {
            const { top, bottom } = tick.getBoundingClientRect();
            return [tick.textContent, (box.bottom - (top + bottom) / 2) / box.height];
        }),
        about: document.querySelector("#about-list").textContent,
    };
})()"""


SAVED = """(async () => {
    const saved = new Promise((resolve) => {
        URL.createObjectURL = (blob) => { resolve(blob); return 'blob:'; };
    });
    document.querySelector('#save').click();
    const bytes = new Uint8Array(await (await saved).arrayBuffer());
    return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
})()"""


def saved_picture(browser):
    """Returns the picture that Save picture saves, uint8 [row, column, RGBA]."""
    browser.hide_panel(True)
    data = base64.b64decode(browser.evaluate(SAVED))
    browser.hide_panel(False)
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))


def test_a_color_bar_shows_the_values_of_the_colors(browser, bakes, pages):
    browser.open(pages("colored").as_uri(), SIZE)
    found, bar = browser.evaluate(BAR), color_bar_of(bakes("colored").scene.isosurfaces[0].texture)
    assert found["title"] == bar.title == "inner"
    assert [text for text, _ in found["ticks"]] == [text for _, text in bar.ticks]
    np.testing.assert_allclose([at for _, at in found["ticks"]], [0.0, 0.5, 1.0], atol=0.02)
    colors = re.findall(r"rgb\((\d+), (\d+), (\d+)\)", found["background"])
    expected = display_colors([color for _, color in bar.stops], 1.0)
    np.testing.assert_array_equal(np.array(colors, int), expected)
    assert bar.caption in found["about"]
    pixels, before = saved_picture(browser), browser.picture()
    np.testing.assert_array_equal(pixels.shape, before.shape)
    changed = np.abs(pixels.astype(int) - before).max(axis=-1) > 40
    assert changed[:, -before.shape[1] // 4 :].mean() > 0.02
    assert not changed[:, : before.shape[1] // 2].any()
    # Its first and last row are half a row from the ends of the colors.
    for color in (expected[0], expected[-1]):
        assert (np.abs(pixels[..., :3].astype(int) - color).max(axis=-1) < 12).any()
    browser.open(pages("labeled").as_uri(), SIZE)
    assert not browser.evaluate("document.querySelector('.color-bar')")


def test_a_color_map_changes_the_albedo_alone(page, bakes):
    """Checks that only the albedo changes: light is multiplied by the ratio of the colors."""
    page.evaluate(f"{LOOK}.showsWalls = false")
    page.atRest()
    before = page.picture()
    choose(page, "#isosurfaces .colors", "VIRIDIS")
    page.atRest()
    after = page.picture()
    # Exposure and display keep the order of colors, and black.
    lit = (before[..., 3] == 255) & (before[..., :3].min(axis=-1) > 40)
    assert lit.sum() > 1000
    ratio = after[lit][:, :3].astype(float) / before[lit][:, :3]
    spread = ratio.std(axis=0) / ratio.mean(axis=0)
    assert (spread < 0.25).all() and ratio.mean(axis=0).max() < 1.0
    choose(page, "#isosurfaces .colors", "")
    page.atRest()
    np.testing.assert_array_equal(page.picture(), before)


def test_isosurfaces_are_seen_through_each_other(page, bakes, pages):
    """Checks three isosurfaces, of which the outer two are translucent, against blended pictures of
    each.
    """
    low, high = bakes("box").isovalues
    isovalues, opacities = low + (high - low) * np.array([0.8, 0.5, 0.2]), (1.0, 0.4, 0.7)
    page.evaluate(f"{LOOK}.showsWalls = false")
    single = []
    for isovalue in isovalues:
        page.evaluate(f"leaflight.panel.setIsovalue({isovalue})")
        single.append(page.picture().astype(float))
    page.evaluate(f"leaflight.panel.setIsovalue({isovalues[0]})")
    for k in (1, 2):
        page.evaluate("document.querySelector('#add').click()")
        row = f"#isosurfaces > :nth-child({k + 1}) "
        choose(page, row + ".isovalue", isovalues[k])
        choose(page, row + ".opacity", opacities[k])
    shown = page.picture() / 255
    expected = np.zeros_like(shown[..., :3])
    for picture, opacity in zip(single, opacities):
        alpha = opacity * picture[..., 3:] / 255
        expected = alpha * picture[..., :3] / 255 + (1 - alpha) * expected
    off = abs(shown[..., :3] * shown[..., 3:] - expected).max(axis=-1)
    assert (off > 0.03).mean() < 0.01 and (shown[..., 3] > 0.5).mean() > 0.1
    # The link contains all of them. They can be removed up to the last, and there are at most
    # eight.
    seen = page.evaluate(SHOWN)
    page.atRest()
    page.evaluate(FRAMES)
    page.open(pages("box").as_uri() + page.evaluate("location.hash"), SIZE)
    assert page.evaluate(SHOWN) == seen and len(seen) == 3
    for _ in range(9):
        page.evaluate("document.querySelector('#add').click()")
    assert page.evaluate(f"{SHOWN}.length") == 8
    for _ in range(9):
        page.evaluate("document.querySelector('#isosurfaces .remove').click()")
    assert page.evaluate(f"{SHOWN}.length") == 1


def test_looks_have_a_color_a_coat_and_a_background(browser, bakes, pages):
    """Checks the coat of a ball against GGX in the light of its lamp. The lit side of a ball has no
    shadow.
    """
    page, look, stops = browser, LOOKS["SKIN"], -2
    (lamp,) = bakes("ball").scene.lights
    page.open(pages("ball").as_uri(), SIZE)
    stage = "getComputedStyle(document.querySelector('#stage')).backgroundImage"
    plain = page.evaluate(stage)
    choose(page, "#isosurfaces .colors", "SKIN")
    choose(page, "#exposure", stops)
    assert page.evaluate(stage) != plain
    glossy = linear(page.picture())
    page.evaluate("leaflight.view.header.looks.SKIN.gloss = 0; leaflight.panel.refresh()")
    seen = (glossy - linear(page.picture())) * 2.0**-stops
    eye = np.array(page.evaluate(VIEWPOINT)["position"])
    page.hide_panel(True)
    compared = 0
    for y in range(20, SIZE["height"], 8):
        for x in range(300, 500, 8):
            place = page.evaluate(
                f"leaflight.view.placeAt({x + 0.5}, {y + 0.5})?.toArray() ?? null"
            )
            if place is None:
                continue
            way = np.subtract(lamp.position, place)
            normal, to_light, to_eye = (v / np.linalg.norm(v) for v in (place, way, eye - place))
            if min(normal @ to_light, normal @ to_eye) < 0.2:
                continue
            half = (to_light + to_eye) / np.linalg.norm(to_light + to_eye)
            alpha, towards, back = look.roughness**2, normal @ to_light, normal @ to_eye
            lobe = alpha**2 / (np.pi * ((normal @ half) ** 2 * (alpha**2 - 1) + 1) ** 2)
            smith = 0.5 / ((1 - alpha) * 2 * towards * back + alpha * (towards + back))
            weight = look.gloss * (0.08 + 0.92 * (1 - back) ** 5)
            irradiance = np.array(lamp.intensity) / (way @ way) * towards
            expected = weight * lobe * smith * irradiance
            np.testing.assert_allclose(seen[y, x], expected, atol=0.02 + 0.05 * expected.max())
            compared += expected.max() > 0.05
    page.hide_panel(False)
    assert compared > 5


def test_numbers_are_those_that_are_shown(page, bakes):
    low, high = bakes("box").isovalues
    for typed, shown in (("99999", high), ("-5", low), ("80.123456", 80.1)):
        page.evaluate(
            "(i => { i.focus(); i.value = '%s'; i.dispatchEvent(new Event('change')); })"
            "(document.querySelector('#number'))" % typed
        )
        assert page.evaluate(ISOVALUE) == pytest.approx(shown)
        value = page.evaluate("document.querySelector('#number').value")
        assert float(value) == pytest.approx(shown, abs=0.051) and len(value) <= 6
    for key in ("ArrowRight", "PageDown"):
        page.press([key], "#isovalue")
        value = page.evaluate(ISOVALUE)
        assert value == pytest.approx(round(value, 1), abs=1e-9)


def test_controls_stay_in_place_and_look_like_what_they_are(page):
    places = (
        "[...document.querySelectorAll('#panel button, #panel input, #panel h1')]"
        ".map(e => { const r = e.getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; })"
    )
    before = page.evaluate(places)
    page.click("#play")
    page.evaluate(FRAMES)
    assert page.evaluate(places) == before
    page.click("#play")
    for is_on in (False, True):
        for slider in ("#clip-share", "#clip-from"):
            disabled = page.evaluate(f"document.querySelector('{slider}').matches(':disabled')")
            assert disabled != is_on
        page.click("#has-clip")


def test_the_camera_stops_before_the_isosurface(page, bakes):
    bake = bakes("box")

    def before_it():
        seen = page.evaluate(VIEWPOINT)
        way = np.subtract(seen["target"], seen["position"])
        way /= np.linalg.norm(way)
        isovalue = page.evaluate(ISOVALUE)
        hits = _core.isosurface_hits(bake.volume.field(), [seen["position"]], [way], isovalue)
        # From outside, a ray hits the front.
        assert hits[1][0] == 0
        return hits[0][0]

    start = before_it()
    at = page.evaluate(MIDDLE)
    for _ in range(30):
        page.wheel(at, -1000)
    by_wheel = before_it()
    page.press(["+"] * 40, "#view")
    assert 0.005 < before_it() <= by_wheel + 1e-6 < 0.5 * start


def test_lengths_are_those_of_the_world(page, bakes):
    bake = bakes("box")
    x, y = page.evaluate(MIDDLE)
    page.click("#ruler-open")
    left = page.evaluate("leaflight.view.canvas.getBoundingClientRect().x")
    places = []
    for dx in (-30, 30):
        page.drag([x + dx, y], [x + dx, y])
        place = page.evaluate(f"leaflight.view.placeAt({x + dx - left}, {y}).toArray()")
        seen = page.evaluate(VIEWPOINT)["position"]
        isovalue = page.evaluate(ISOVALUE)
        way = np.subtract(place, seen)
        distance = _core.isosurface_hits(bake.volume.field(), [seen], [way], isovalue)[0][0]
        assert distance == pytest.approx(1, abs=2e-3)
        places.append(place)
    page.atRest()
    distance = np.linalg.norm(np.subtract(*places))
    assert page.evaluate("leaflight.panel.ruler.distance") == pytest.approx(distance, rel=0.05)
    shown = page.evaluate("document.querySelector('#ruler-text').textContent")
    assert float(shown.split()[0]) == pytest.approx(distance, rel=0.05) and "units" in shown
    # Check the scale bar at the depth of the center.
    bar = page.evaluate("document.querySelector('#scale-bar').getBoundingClientRect().width")
    length = float(page.evaluate("document.querySelector('#scale-text').textContent").split()[0])
    camera = page.evaluate(VIEWPOINT)
    depth = np.linalg.norm(np.subtract(camera["position"], camera["target"]))
    pixel = 2 * np.tan(np.radians(13)) * depth / SIZE["height"]
    assert bar * pixel == pytest.approx(length, rel=0.06)


def test_a_cube_shows_the_axes_and_looks_along_them(page):
    face = "document.querySelector('#cube [aria-label=\"View from +X\"]')"
    assert page.evaluate(f"{face}.textContent") == "+X"
    page.evaluate(f"{face}.click()")
    page.atRest()
    seen = page.evaluate(VIEWPOINT)
    way = np.subtract(seen["position"], seen["target"])
    np.testing.assert_allclose(way / np.linalg.norm(way), [1, 0, 0], atol=1e-6)


def test_full_screen_and_large_pictures(page):
    page.click("#full")
    page.awaits("document.fullscreenElement !== null")
    page.evaluate("document.exitFullscreen()")
    width = page.evaluate(
        "leaflight.view.picture(1200).then(createImageBitmap).then(image => image.width)"
    )
    assert width == 1200
