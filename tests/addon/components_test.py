"""Components: names without the library, descriptions by the library, the panel and Blender's sockets."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import pytest
from gradus import components, native, pass_table, passes, renderer
from gradus.failure import Failure
from gradus.options import PREFIX, OptionError, parse
from gradus.ui import decomposition_panels
from support import compositing

SETS = (
    "",
    "Caustics=ED.*(R|T)D?L",
    "A=EL;B=EDL",
    " Sky = EL ; Glass_2=ETTTTD.*L ;",
    "x=ER.*L;Y=ET.*L;z=ED.*L;w=EL",
)


@pytest.mark.parametrize("text", SETS)
def test_names_are_those_of_the_library(text: str) -> None:
    found = components.describe(native.load(), text.encode())
    assert components.names(text) == [component.name for component in found]
    assert found[-1].name == components.RESIDUAL


def test_a_set_that_is_refused_has_the_names_that_can_be_read() -> None:
    """The sockets of valid names stay while the user edits the set."""
    assert components.names("A=EDL;=ERL;2x=EL;a=ETL;residual=EL;B") == ["A", "B", "Residual"]
    assert components.names(";") == ["Residual"]


def test_the_default_set_written_out_is_the_default_set() -> None:
    library = native.load()
    found = components.describe(library, b"")
    again = components.describe(library, components.to_text(found).encode())
    assert again == found
    assert [component.expression for component in found] == ["EL", "ED.*L", "ER(D.*)?L", "ETT(D.*)?L", ""]


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("EL", "Emission"),
        ("EDL", "Diffuse"),
        ("EDTTL", "Diffuse"),
        ("ERDRL", "Reflection"),
        ("ETTL", "Transmission"),
        ("ETL", "Residual"),
    ],
)
def test_where_a_path_belongs(path: str, name: str) -> None:
    assert components.component_of(native.load(), b"", path).name == name


def test_examples_belong_to_their_component() -> None:
    library = native.load()
    for component in components.describe(library, b""):
        paths = component.examples.split(", ")
        assert paths[0]
        assert {components.component_of(library, b"", path).name for path in paths} == {component.name}


MALFORMED = ("A=ED(L", "A=EDL;B=ED.*L", "A=", "A=EXL", "A=DL", "A=EDL;a=ERL", "Residual=EL", ";", "7=EL")


@pytest.mark.parametrize("text", SETS)
def test_the_early_check_accepts_what_the_library_accepts(text: str) -> None:
    components.describe(native.load(), text.encode())
    assert components.syntax_error(text) == ""


MISSPELT = ("A=ED(L", "A=EDL)", "A=E(D|", "A=*EDL", "A=E(+D)L", "A=E|?L", "A=EXL", "A=", "A", ";", "7=EL", "A=EDL;B")


@pytest.mark.parametrize("text", MISSPELT)
def test_the_early_check_refuses_only_what_the_library_refuses(text: str) -> None:
    assert components.syntax_error(text)
    with pytest.raises(native.GradusError):
        components.describe(native.load(), text.encode())


@pytest.mark.parametrize("text", MALFORMED)
def test_a_malformed_set_is_refused_before_the_export(scene: bpy.types.Scene, text: str) -> None:
    scene.gradus.use_decomposition, scene.gradus.components = True, text
    with pytest.raises(native.GradusError, match=r"\w+ \w+"):
        renderer.native_settings(native.load(), scene, scene.view_layers[0], parse([]))
    scene.gradus.use_decomposition = False
    renderer.native_settings(native.load(), scene, scene.view_layers[0], parse([]))


def test_options_win_over_the_scene_s_set(scene: bpy.types.Scene) -> None:
    scene.gradus.components = "A=ED("
    filled = renderer.native_settings(
        native.load(),
        scene,
        scene.view_layers[0],
        parse(["--gradus-components", "B=EDL", "--gradus-use-decomposition", "1"]),
    )
    assert (filled.components, filled.use_decomposition) == (b"B=EDL", 1)


NEED_PARTS = ([f"{PREFIX}components", "A=ED("], [f"{PREFIX}components="], [f"{PREFIX}passes", "depth,component_normal"])


@pytest.mark.parametrize("arguments", NEED_PARTS, ids=lambda arguments: arguments[0])
def test_options_of_components_without_decomposition_are_refused(scene: bpy.types.Scene, arguments: list[str]) -> None:
    """Regression: a malformed set was not reported, and passes were missing without an error."""
    layer = scene.view_layers[0]
    off, on = ([f"{PREFIX}use-decomposition", value] for value in "01")
    for given in (arguments, arguments + off):
        with pytest.raises(OptionError, match=f"{PREFIX}(components|passes): .* add {PREFIX}use-decomposition 1"):
            renderer.native_settings(native.load(), scene, layer, parse(given))
    well = [text.replace("ED(", "EDL") for text in arguments]
    assert renderer.native_settings(native.load(), scene, layer, parse(well + on)).use_decomposition == 1
    scene.gradus.use_decomposition = True
    assert renderer.native_settings(native.load(), scene, layer, parse(well)).use_decomposition == 1


def test_a_set_that_is_too_long_is_refused_by_name(scene: bpy.types.Scene) -> None:
    scene.gradus.use_decomposition, scene.gradus.components = True, "A=" + "E" * 600
    with pytest.raises(Failure, match="Components .components. is longer than 511 bytes"):
        renderer.native_settings(native.load(), scene, scene.view_layers[0], parse([]))


# -------------------------------------------------------------------------------- passes


def registered(scene: bpy.types.Scene, arguments: tuple[str, ...] = ()) -> list[str]:
    return [
        info.name
        for info in renderer.active_passes(scene, scene.view_layers[0], parse(arguments))
        if info.name.startswith("Path")
    ]


def test_path_passes_exist_whenever_the_image_is_decomposed(scene: bpy.types.Scene) -> None:
    assert registered(scene) == []
    scene.gradus.use_decomposition = True
    default = ["Path Emission", "Path Diffuse", "Path Reflection", "Path Transmission", "Path Residual"]
    assert registered(scene) == default
    scene.gradus.components = "Sky=EL"
    assert registered(scene) == ["Path Sky", "Path Residual"]
    assert registered(scene, ("--gradus-components", "")) == default
    assert registered(scene, ("--gradus-use-decomposition", "off")) == []
    assert registered(scene, ("--gradus-passes", "component_normal")) == [
        "Path Sky", "Path Sky Normal", "Path Residual", "Path Residual Normal"
    ]  # fmt: skip


def sockets(scene: bpy.types.Scene) -> list[str]:
    node = next(node for node in compositing.tree_of(scene).nodes if node.bl_idname == "CompositorNodeRLayers")
    return [output.name for output in node.outputs if output.enabled]


def test_sockets_come_and_go_with_the_settings(scene: bpy.types.Scene) -> None:
    """Regression: in Blender 3.4 the compositor showed no sockets until another event updated the passes."""
    compositing.new_tree(scene)
    assert not any(name.startswith("Path") for name in sockets(scene))
    scene.gradus.use_decomposition = True
    scene.gradus.components = "Sky=EL;Far_away=ERR.*L"
    scene.view_layers[0].gradus.use_pass_component_motion = True
    expected = {
        f"Path {name}{suffix}" for name in ("Sky", "Far_away", "Residual") for suffix in ("", " Motion", " Tracked")
    }
    assert {name for name in sockets(scene) if name.startswith("Path")} == expected
    scene.view_layers[0].gradus.use_pass_components = False
    scene.gradus.components = "Sky=EL"
    assert {name for name in sockets(scene) if name.startswith("Path")} == {
        "Path Sky Motion", "Path Sky Tracked", "Path Residual Motion", "Path Residual Tracked"
    }  # fmt: skip


def test_sockets_of_the_longest_names_are_whole(scene: bpy.types.Scene) -> None:
    compositing.new_tree(scene)
    layer = scene.view_layers[0].gradus
    layer.use_pass_component_reflectance = layer.use_pass_component_irradiance = True
    name = "Twenty_four_letters_long"
    scene.gradus.use_decomposition, scene.gradus.components = True, f"{name}=EL"
    assert {f"Path {name}", f"Path {name} Reflectance", f"Path {name} Irradiance"} <= set(sockets(scene))


# -------------------------------------------------------------------------------- the panel


class Labels:
    """Records labels, icons and properties, and accepts all other calls."""

    def __init__(self) -> None:
        self.found: list[tuple[str, str]] = []
        self.properties: list[str] = []

    def label(self, text: str = "", icon: str = "NONE") -> None:
        self.found.append((text, icon))

    def prop(self, _owner: Any, name: str, **_: Any) -> None:
        self.properties.append(name)

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: self

    def texts(self) -> list[str]:
        return [text for text, _ in self.found]


def drawn(scene: bpy.types.Scene) -> Labels:
    labels = Labels()
    shown = SimpleNamespace(
        scene=scene, window_manager=bpy.context.window_manager, region=SimpleNamespace(width=300),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
    )  # fmt: skip
    decomposition_panels.GRADUS_RENDER_PT_decomposition.draw(SimpleNamespace(columns=lambda: labels), shown)
    return labels


def test_the_panel_has_a_row_for_each_component_with_paths(scene: bpy.types.Scene) -> None:
    bpy.context.window_manager.gradus.path = "ETTDL"
    labels = drawn(scene)
    row = labels.texts().index("Reflection")
    assert labels.texts()[row + 1] == "ER(D.*)?L"
    assert labels.texts()[row + 2].startswith("ERL, ERDL")
    assert labels.texts()[labels.texts().index("Residual") + 1] == "all other paths"
    assert labels.found[-1] == ("ETTDL belongs to Transmission", "CHECKMARK")


@pytest.mark.parametrize("text", ["A=EDL;B=ED.*L", "A=" + "E" * 600])
def test_the_panel_shows_why_a_set_is_refused(scene: bpy.types.Scene, text: str) -> None:
    scene.gradus.components = text
    labels = drawn(scene)
    assert labels.found[0][1] == "ERROR"
    message = " ".join(labels.texts())
    assert "overlap: both match EDL" in message or "longer than 511 bytes" in message


@pytest.mark.parametrize(("text", "shown"), [("", ["components", "path"]), ("A=ED(", ["components"])])
def test_an_invalid_set_hides_no_unrelated_switch(scene: bpy.types.Scene, text: str, shown: list[str]) -> None:
    scene.gradus.components = text
    assert drawn(scene).properties == [*shown, "component_replays"]


def test_the_panel_reports_an_invalid_path(scene: bpy.types.Scene) -> None:
    bpy.context.window_manager.gradus.path = "EXL"
    labels = drawn(scene)
    assert [text for text, icon in labels.found if icon == "ERROR"]
    bpy.context.window_manager.gradus.path = "EDL"


def test_the_automatic_set_can_be_written_out(scene: bpy.types.Scene) -> None:
    bpy.ops.gradus.write_out_components()
    settings = bpy.context.scene.gradus
    assert settings.components.startswith("Emission=EL;Diffuse=ED.*L;")
    assert not bpy.ops.gradus.write_out_components.poll()


def test_writing_out_without_a_library_is_an_error_message(
    scene: bpy.types.Scene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(native.ENVIRONMENT_VARIABLE, str(tmp_path / "libgradus.so"))
    with pytest.raises(RuntimeError, match="library not found") as refused:  # a report raises an exception in scripts
        bpy.ops.gradus.write_out_components()
    assert "Traceback" not in str(refused.value)
    assert bpy.context.scene.gradus.components == ""


def test_every_switch_of_a_pass_is_in_one_panel() -> None:
    assert all(name.startswith("use_pass_component") for name in passes.COMPONENT_SWITCHES)
    assert not set(passes.SAMPLING_SWITCHES) & set(passes.COMPONENT_SWITCHES)
    assert {*passes.SAMPLING_SWITCHES, *passes.COMPONENT_SWITCHES} == {row[0] for row in pass_table.SWITCHES}
