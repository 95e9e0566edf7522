"""What sessions share."""

from __future__ import annotations

from types import SimpleNamespace

from gradus import store


def session(library: SimpleNamespace, scene: int) -> store.Session:
    made = store.Session.__new__(store.Session)
    made.library, made.device, made.scene, made.reported = library, -1, scene, set()
    return made


def test_a_warning_is_told_by_the_session_that_it_is_about() -> None:
    """A warning of a viewport came up in the next final render, and one about colour in the first session alone."""
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
