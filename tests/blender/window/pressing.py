# SPDX-License-Identifier: GPL-3.0-or-later
"""Presses one operator in one way (rows.py), and checks the conditions on the way and at the
end.
"""

import traceback

import bpy
import gate
import hand
import rows
import seen
import sidebar
from leaflight_addon.bake import live, stopped
from leaflight_addon.operators import jobs
from leaflight_addon.show import preview

# Texts of the window's status bar.
_status = []

# Name of the step that is undone.
_STEP = "Step"

# Numbers of steps in which Blender does its own work.
_FEW, _MANY = 4, 200

bpy.types.WorkSpace.status_text_set = lambda _workspace, text: _status.append(text)


class Failed(Exception):
    """A check that failed; its text is a sentence."""


class Pressing:
    def __init__(self, row, scenes, beat):
        self._row, self._scenes, self._beat = row, scenes, beat
        self.failures = []

    def run(self, way):
        """Opens the scene of the row and presses its operator; fills the list of failures."""
        ways = {
            rows.HAPPY: self._happy,
            rows.CANCELLED: self._cancelled,
            rows.DELETED: self._deleted,
            rows.NEW: self._new,
            rows.UNDONE: self._undone,
            rows.CLOSED: self._closed,
            rows.BESIDE: self._beside,
        }
        try:
            yield from self._prepare(way)
            yield from ways[way]()
            yield from self._is_free()
        except Failed as failed:
            self.failures.append(str(failed))
        except Exception:
            self.failures.append(traceback.format_exc())
        finally:
            gate.open_()
            hand.use_window(0)

    # ---- The ways ----

    def _happy(self):
        before = self._see()
        yield from self._press()
        yield from self._answer()
        if self._row.held == "modal":
            yield from self._drag()
            yield from hand.key("RET")
        yield from self._settle()
        after = self._see()
        _expect(after != before, f"{self._row.sees} is {before} as before")
        if self._row.undone and self._can_be_undone():
            for restored, shift in ((before, False), (after, True)):
                yield from hand.key("Z", ctrl=True, shift=shift)
                yield from self._settle()
                what = "redo" if shift else "undo"
                _expect(self._see() == restored, f"{what} leaves {self._see()} for {restored}")

    def _cancelled(self):
        """Cancels in the dialog or browser, and halfway through the work."""
        before = self._see()
        if self._row.asks:
            yield from self._press()
            yield from hand.key("ESC")
            yield from self._settle()
            _expect(self._see() == before, f"Esc in its {self._row.asks} leaves {self._see()}")
        if self._row.held != "dialog":
            yield from self._to_half_way()
            yield from hand.key("ESC")
            yield from self._settle()
            yield from self._decide()
            _expect(self._see() == before, f"Esc leaves {self._see()} for {before}")

    def _deleted(self):
        yield from self._to_half_way()
        if hand.areas("VIEW_3D"):
            yield from hand.key(hand.DELETE)
        else:
            # Remove the object as if in another window, because the browser covers this one.
            bpy.data.objects.remove(bpy.context.view_layer.objects.active)
            yield from hand.steps(_FEW)
        _expect(len(seen.volumes()) < 2, "the object is not deleted")
        gate.open_()
        if self._row.held == "dialog":
            yield from self._answer()
        yield from self._settle()

    def _new(self):
        yield from self._to_half_way()
        yield from hand.key(hand.NEW)
        self._beat.skip()
        yield from hand.steps(_FEW)
        _expect(not bpy.data.filepath, "no new file is open")
        yield from self._settle()
        _expect(not seen.volumes(), "the new file has a volume")

    def _undone(self):
        with hand.in_view():
            bpy.context.scene[_STEP] = True
            bpy.ops.ed.undo_push(message=_STEP)
        yield from self._to_half_way()
        for _ in range(2):
            # An operator that the file browser executes pushes a separate undo step.
            if _STEP in bpy.context.scene:
                yield from hand.key("Z", ctrl=True)
                yield from hand.steps(_FEW)
        _expect(_STEP not in bpy.context.scene, "the step before is not undone")
        gate.open_()
        yield from self._settle()

    def _closed(self):
        """Presses the operator in a second window, and closes that window during its work."""
        before = self._see()
        with hand.in_view():
            bpy.ops.wm.window_new()
        hand.use_window(1)
        yield from hand.steps(_FEW)
        yield from self._to_half_way()
        with bpy.context.temp_override(window=hand.window()):
            bpy.ops.wm.window_close()
        hand.use_window(0)
        self._beat.skip()
        yield from hand.steps(_FEW)
        gate.open_()
        yield from self._settle()
        _expect(self._see() != before, f"{self._row.sees} is {before} as before")

    def _beside(self):
        """Presses the operator while a bake is halfway, and lets the bake end."""
        yield from self._begin_bake()
        yield from self._press()
        gate.open_()
        yield from self._settle()

    # ---- Steps of them ----

    def _prepare(self, way):
        row = self._row
        gate.open_()
        _status.clear()
        hand.bind(hand.PRESS, f"leaflight.{row.operator}", row.options)
        hand.bind(hand.DELETE, "object.delete", {"confirm": False})
        hand.bind(hand.NEW, "wm.read_homefile", {})
        self._file = self._scenes.file(row.file) if row.file else None
        self._scenes.open(row.scene, f"{row.name} {way}".replace(" ", "_").replace(",", ""))
        yield from hand.steps(_FEW)
        yield from self._settle()
        if row.scene in _BEGIN:
            yield from _BEGIN[row.scene](self)
        yield from hand.steps(_FEW)
        self._beat.start()

    def _begin_bake(self):
        """Starts a bake and waits halfway, after its first pass."""
        hand.bind(hand.PRESS, "leaflight.bake", {})
        gate.close("pass")
        yield from hand.key(hand.PRESS)
        yield from self._until(lambda: gate.reached and preview.of(seen.volume()) is not None)
        hand.bind(hand.PRESS, f"leaflight.{self._row.operator}", self._row.options)

    def _begin_and_stop(self):
        yield from self._begin_bake()
        yield from hand.key("ESC")
        yield from self._settle()
        _expect(stopped.offered() is not None, "no stopped bake waits")

    def _move_lamp(self):
        """Moves a lamp, so that Live is at work."""
        gate.close("work")
        hand.lamp().location.x += 0.1
        yield from self._until(lambda: gate.reached and live.at_work() is not None)

    def _see(self):
        try:
            return seen.SEEN[self._row.sees]()
        except IndexError:
            # There is no volume.
            return None

    def _press(self):
        yield from hand.key(hand.PRESS)
        if self._row.asks == "browser":
            yield from self._until(hand.browser_is_open)

    def _answer(self):
        """Makes the choice of the row, or presses OK."""
        if self._row.asks == "browser":
            yield from hand.choose(self._file or seen.folder())
        elif self._row.asks:
            yield from hand.key("RET")

    def _drag(self):
        if self._row.clicks:
            across, height = hand.place_of(seen.volume())
            yield from hand.drag(across, across, height)
        else:
            yield from hand.drag(0.5, 0.6, 0.1)

    def _to_half_way(self):
        row = self._row
        if row.held in ("work", "pass"):
            gate.close(row.held)
        yield from self._press()
        if row.held in ("work", "pass"):
            yield from self._answer()
            yield from self._until(lambda: gate.reached and jobs.running() is not None)
            yield from hand.steps(_FEW)
        elif row.held == "modal" and not row.clicks:
            yield from self._drag()

    def _until(self, is_so):
        """Waits for a condition while work runs; raises Failed after many steps without work."""
        for _ in range(_MANY):
            if is_so():
                return
            yield from self._while_alive()
            yield from hand.steps(1)
        raise Failed("what was pressed did not begin")

    def _while_alive(self):
        """Waits until gate.py holds the work, or its thread has ended."""
        while (work := jobs.running()) is not None and work.is_alive() and not gate.reached:
            yield from hand.steps(1)

    def _settle(self):
        """Waits until all work has ended; raises Failed if its thread has ended but the work
        has not.
        """
        yield from hand.steps(_FEW)
        waited = 0
        while jobs.running() is not None or live.at_work() is not None:
            alive = any(w is not None and w.is_alive() for w in (jobs.running(), live.at_work()))
            waited = 0 if alive else waited + 1
            if waited > _MANY:
                raise Failed("the work has ended, and the add-on is not free")
            yield from hand.steps(1)
        yield from hand.steps(_FEW)

    def _can_be_undone(self):
        name = f"LEAFLIGHT_OT_{self._row.operator}"
        return "UNDO" in getattr(getattr(bpy.types, name), "bl_options", ())

    # ---- At the end ----

    def _is_free(self):
        """Checks that Blender is ready for the next work, after each way."""
        if hand.areas("FILE_BROWSER"):
            raise Failed("the file browser is still open")
        yield from self._decide()
        _expect((yield from sidebar.is_drawn()), "the panels are not drawn")
        _expect(not _status or _status[-1] is None, f'the status bar still says "{_status[-1:]}"')
        if seen.volumes():
            with hand.in_view():
                _expect(bpy.ops.leaflight.bake.poll(), "Bake is gray")

    def _decide(self):
        """Discards a stopped bake, which waits for that."""
        if stopped.offered() is not None:
            hand.bind(hand.PRESS, "leaflight.throw_bake_away", {})
            yield from hand.key(hand.PRESS)
            yield from self._settle()


def _expect(is_so, sentence):
    if not is_so:
        raise Failed(sentence)


_BEGIN = {
    "baking": Pressing._begin_bake,
    "stopped": Pressing._begin_and_stop,
    "living": Pressing._move_lamp,
}
