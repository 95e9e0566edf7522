"""Blender's panels that are shown for Gradus: the predicate, and the registration in the host."""

from __future__ import annotations

import bpy
from gradus.ui import stock


def test_predicate() -> None:
    assert stock.is_shown("RENDER_PT_output", {"BLENDER_RENDER", "CYCLES"})
    assert not stock.is_shown("RENDER_PT_output", {"CYCLES"})
    assert not stock.is_shown("DATA_PT_light", {"BLENDER_RENDER"})
    assert stock.is_shown("DATA_PT_camera_dof", {"BLENDER_EEVEE"})


def test_every_entry_has_a_reason() -> None:
    assert all(stock.EXCLUDED.values())
    assert all(stock.INCLUDED.values())
    assert not stock.EXCLUDED.keys() & stock.INCLUDED.keys()


def engines() -> dict[str, frozenset[str]]:
    return {name: frozenset(found) for name, found in stock.stock_panels()}


def test_joining_twice_and_leaving_restores_the_sets(addon: object) -> None:
    stock.leave_all()
    before = engines()
    stock.join_all()
    once = engines()
    stock.join_all()
    assert engines() == once
    joined = {name for name, found in once.items() if stock.ENGINE in found}
    assert {"RENDER_PT_stamp", "DATA_PT_lens", "RENDER_PT_format"} <= joined
    assert not joined & stock.EXCLUDED.keys()
    stock.leave_all()
    assert engines() == before
    stock.join_all()


def test_h7_register_and_unregister_50_times(addon: object) -> None:
    before = engines()
    for _ in range(50):
        addon.unregister()
        addon.unregister()
        assert not hasattr(bpy.types.Scene, "gradus")
        assert not any(stock.ENGINE in found for found in engines().values())
        addon.register()
        addon.register()
    assert engines() == before
    assert hasattr(bpy.context.scene, "gradus")
