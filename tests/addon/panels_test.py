"""All panels draw in all hosts, and all their properties exist."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import bpy
import pytest
from gradus import store, ui
from gradus.ui import presets, render_panels


class Layout:
    """Accepts all calls of a UILayout, and checks that properties and operators exist."""

    def prop(self, data: Any, name: str, **_: Any) -> None:
        assert name in data.bl_rna.properties, f"{type(data).__name__}.{name}"

    def operator(self, name: str, **_: Any) -> SimpleNamespace:
        module, function = name.split(".")
        getattr(getattr(bpy.ops, module), function).get_rna_type()
        return SimpleNamespace()

    def template_node_view(self, tree: Any, node: Any, socket: Any) -> None:
        assert socket.name in node.inputs

    def label(self, text: str = "", icon: str = "NONE") -> None:
        assert text
        assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: Layout()


PANELS = [kind for kind in ui.classes() if issubclass(kind, bpy.types.Panel) and kind is not presets.GRADUS_PT_presets]


def context(scene: bpy.types.Scene, light: str) -> SimpleNamespace:
    material, world = bpy.data.materials.new("M"), bpy.data.worlds.new("W")
    for block in (material, world):
        if block.node_tree is None:
            block.use_nodes = True
    data = bpy.data.lights.new("L", light)
    layer = scene.view_layers[0]
    obj = bpy.data.objects.new("O", bpy.data.meshes.new("O"))
    return SimpleNamespace(
        scene=scene, view_layer=layer, material=material, world=world, light=data, object=obj, engine="GRADUS",
        window_manager=bpy.context.window_manager, region=SimpleNamespace(width=200),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
    )  # fmt: skip


@pytest.mark.parametrize("light", ["POINT", "SUN", "SPOT", "AREA"])
@pytest.mark.parametrize("panel", PANELS, ids=lambda panel: panel.__name__)
def test_panel_draws(scene: bpy.types.Scene, panel: Any, light: str) -> None:
    instance = SimpleNamespace(layout=Layout())
    instance.columns = lambda: instance.layout
    for name, value in vars(panel).items():
        if name == "VALUES":
            setattr(instance, name, value)
    shown = context(scene, light)
    if light == "AREA":
        shown.light.shape = "RECTANGLE"
    panel.draw(instance, shown)


def test_panels_show_for_gradus_only(scene: bpy.types.Scene) -> None:
    shown = context(scene, "POINT")
    for panel in PANELS:
        assert panel.poll(shown)
        assert not panel.poll(SimpleNamespace(**{**vars(shown), "engine": "CYCLES"}))


class Names(Layout):
    """Records the properties that are drawn."""

    def __init__(self) -> None:
        self.drawn: set[str] = set()

    def prop(self, data: Any, name: str, **rest: Any) -> None:
        super().prop(data, name, **rest)
        self.drawn.add(name)

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: self


def test_properties_that_the_export_reads_have_panels(scene: bpy.types.Scene) -> None:
    """Blender leaves these properties to the panels of engines. Without a panel, only scripts could change them."""
    names = Names()
    for panel in PANELS:
        for light in ("POINT", "SPOT", "SUN", "AREA"):
            instance = SimpleNamespace(layout=names, columns=lambda: names, VALUES=getattr(panel, "VALUES", None))
            panel.draw(instance, context(scene, light))
    wanted = {
        "visible_camera",
        "visible_diffuse",
        "visible_glossy",
        "visible_transmission",
        "visible_shadow",
        "is_holdout",
    }
    wanted |= {"use_sky", "use_solid", "material_override", "samples", "pass_alpha_threshold", "film_transparent"}
    wanted |= {"pass_index", "distance", "use_nodes", "spot_size", "spread", "angle"}
    if bpy.app.version >= (4, 5, 0):
        wanted |= {"exposure", "normalize", "use_temperature", "use_soft_falloff", "use_shadow", "world_override"}
    assert wanted <= names.drawn


class Labels(Layout):
    """Records the labels."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def label(self, text: str = "", icon: str = "NONE") -> None:
        super().label(text, icon)
        self.texts.append(text)

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: self


def test_the_plan_is_shown_as_text(scene: bpy.types.Scene) -> None:
    summary = {
        "frame": 3,
        "samples": 16.0,
        "seconds": {"sample": 2.5, "total": 3.0, "store": 0.0},
        "plan": {
            "chosen": {"integrator gradient": "the default"},
            "skipped": {"lens samples": "the camera is a pinhole"},
        },
        "warnings": ["image missing"],
    }
    assert render_panels.plan_lines(summary) == [
        "Frame 3: 16 samples per pixel in 3.0 s",
        "Sample: 2.50 s",
        "Chosen: integrator gradient: the default",
        "Skipped: lens samples: the camera is a pinhole",
    ]
    store.summaries[(scene.name, scene.view_layers[0].name)] = summary
    labels = Labels()
    render_panels.GRADUS_RENDER_PT_plan.draw(SimpleNamespace(layout=labels), context(scene, "POINT"))
    store.summaries.clear()
    assert " ".join(text.strip() for text in labels.texts).endswith(
        "Skipped: lens samples: the camera is a pinhole image missing"
    )
    assert max(map(len, labels.texts)) < 32


def test_phases_of_the_last_render_come_in_their_order() -> None:
    """Regression: phases were listed alphabetically, with those of the add-on at the end."""
    seconds = {
        "denoise": 1.0,
        "correspondence": 8.0,
        "preview": 2.0,
        "reconstruct": 3.0,
        "sample": 4.0,
        "store": 9.0,
        "total": 40.0,
    }
    lines = render_panels.plan_lines({"frame": 1, "seconds": {**seconds, "export": 5.0, "build": 6.0, "upload": 7.0}})
    order = ["Export", "Build", "Correspondence", "Sample", "Preview", "Store", "Reconstruct", "Denoise", "Upload"]
    assert [line.split(":")[0] for line in lines[1:]] == order


def method(**values: Any) -> SimpleNamespace:
    defaults = {"integrator": "AUTO", "reconstruction": "AUTO", "denoiser": "NONE"}
    defaults |= {"noise_threshold": 0.0, "use_temporal": False}
    return SimpleNamespace(**{**defaults, **values})


@pytest.mark.parametrize(
    ("values", "samples", "text"),
    [
        ({"denoiser": "OIDN"}, 4, "Biased by the denoiser"),
        ({"denoiser": "AUTO"}, 8, "Biased if a denoiser is found"),
        ({"denoiser": "AUTO"}, 7, "Consistent"),
        ({"denoiser": "AUTO", "use_temporal": True}, 7, "Consistent; biased in animations if a denoiser is found"),
        ({"denoiser": "AUTO", "integrator": "PATH", "reconstruction": "NONE"}, 64, "Unbiased"),
        ({"denoiser": "AUTO", "reconstruction": "L2"}, 64, "Unbiased"),
        ({"reconstruction": "L2", "noise_threshold": 0.01}, 64, "Unbiased if the noise threshold is 0"),
        ({"reconstruction": "L2"}, 64, "Unbiased"),
        ({"reconstruction": "L2", "integrator": "PATH"}, 64, "Path tracing has no gradients for this reconstruction"),
    ],
)
def test_the_bias_of_settings(values: dict[str, Any], samples: int, text: str) -> None:
    """With AUTO, the panel must not claim that the image is denoised: there may be no denoiser or too few samples."""
    assert render_panels.bias(method(**values), samples, is_clamped=False)[0] == text


def test_the_bias_of_clamps(scene: bpy.types.Scene) -> None:
    """The clamps of Cycles count where they are followed."""
    settings = method(reconstruction="NONE")
    assert render_panels.bias(settings, 64, is_clamped=True)[0] == "Biased by clamping"
    if hasattr(scene, "cycles"):
        assert render_panels.has_clamps(scene)
        scene.cycles.sample_clamp_indirect = 0.0
    assert not render_panels.has_clamps(scene)
    scene.gradus.clamp_direct = 2.0
    assert render_panels.has_clamps(scene)


def test_presets_set_their_values_and_reset_others(scene: bpy.types.Scene) -> None:
    scene.gradus.samples, scene.gradus.min_samples = 7, 9
    bpy.ops.gradus.preset(preset="REFERENCE")
    settings = bpy.context.scene.gradus
    assert (settings.integrator, settings.reconstruction, settings.samples, settings.min_samples) == (
        "PATH",
        "NONE",
        4096,
        0,
    )
    bpy.ops.gradus.preset(preset="FINAL")
    assert (settings.integrator, settings.samples) == ("AUTO", 256)
    assert all(set(values) <= set(presets.SAVED) for _, values in presets.BUILT_IN.values())
