"""Warnings that sessions share."""

from __future__ import annotations

from types import SimpleNamespace

from gradus import store


def session(library: SimpleNamespace, scene: int) -> store.Session:
    made = store.Session.__new__(store.Session)
    made.library, made.device, made.scene, made.reported = library, -1, scene, set()
    return made


def test_warnings_belong_to_their_session() -> None:
    """Each session reports its own warnings and those of the device.

    Regression: a final render reported warnings of a viewport, and only the first session those about colour.
    """
    about_device, about_scene = [["colour"], []], {1: [["a missing image"], []], 2: [[], []]}
    library = SimpleNamespace(
        take_device_warnings=lambda _device: about_device.pop(0) if about_device else [],
        take_scene_warnings=lambda scene: about_scene[scene].pop(0) if about_scene[scene] else [],
    )
    viewport, final = session(library, 1), session(library, 2)
    try:
        assert viewport.take_new_warnings([]) == ["a missing image", "colour"]
        assert final.take_new_warnings(["no camera"]) == ["no camera", "colour"]
        assert viewport.take_new_warnings([]) == [] == final.take_new_warnings(["no camera"])
    finally:
        store._device_warnings.pop(-1)
