"""Images: files, packed data, generated pixels, tiles and sequences, colour space and alpha, and missing files."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest
from gradus.export import image as images
from support import recording

FILE, ENCODED, FLOAT, BYTE = range(4)


def _save(path: Path, kind: str = "PNG", color: tuple[float, float, float] = (1, 0, 0)) -> Path:
    block = bpy.data.images.new(path.stem, 4, 2, float_buffer=kind == "OPEN_EXR")
    block.pixels.foreach_set([*color, 1.0] * 8)
    block.file_format = kind
    block.filepath_raw = str(path)
    block.save()
    bpy.data.images.remove(block)
    return path


def _state(block: bpy.types.Image, user: object = None, frame: int = 1) -> images.ImageState:
    return images.image_state(block, images.number_of_frame(block, user, frame), bpy.path.abspath)


def test_blender_does_not_load_what_the_library_reads(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: the question for the file's format made Blender decode every image as well, with its memory."""
    block = bpy.data.images.load(str(_save(tmp_path / "picture.png")))
    _state(block)
    assert images.warning(block, None, bpy.path.abspath) == ""
    assert not block.has_data


@pytest.mark.parametrize(
    "kind, suffix, is_float",
    [("PNG", "png", False), ("JPEG", "jpg", False), ("TIFF", "tif", False), ("OPEN_EXR", "exr", True)],
)
def test_files_go_as_paths(scene: bpy.types.Scene, tmp_path: Path, kind: str, suffix: str, is_float: bool) -> None:
    path = _save(tmp_path / f"picture.{suffix}", kind)
    block = bpy.data.images.load(str(path))
    state = _state(block)
    (tile,) = state.tiles
    assert (tile.source, tile.path, tile.data) == (FILE, str(path), None)
    assert state.is_float == is_float
    assert state.color_space == block.colorspace_settings.name


def test_packed_files_go_as_bytes(scene: bpy.types.Scene, tmp_path: Path) -> None:
    path = _save(tmp_path / "picture.png")
    block = bpy.data.images.load(str(path))
    block.pack()
    path.unlink()
    (tile,) = _state(block).tiles
    assert tile.source == ENCODED and bytes(tile.data[:4]) == b"\x89PNG"


def test_generated_and_painted_images_go_as_pixels(scene: bpy.types.Scene, tmp_path: Path) -> None:
    generated = bpy.data.images.new("Generated", 4, 2)
    generated.pixels.foreach_set([0.5, 0.25, 1.0, 1.0] * 8)
    state = _state(generated)
    (tile,) = state.tiles
    assert (tile.source, tile.width, tile.height) == (BYTE, 4, 2)
    assert tuple(tile.data[:4]) == (128, 64, 255, 255)
    assert state.color_space == "sRGB" and not state.is_float
    painted = bpy.data.images.load(str(_save(tmp_path / "picture.png")))
    painted.pixels[0] = 0.0
    assert _state(painted).tiles[0].source == BYTE


def test_float_pixels_are_linear_already(scene: bpy.types.Scene) -> None:
    block = bpy.data.images.new("Generated", 4, 2, float_buffer=True)
    block.pixels.foreach_set([4.0, 0.25, 1.0, 1.0] * 8)
    state = _state(block)
    assert state.is_float and state.color_space == "" and state.tiles[0].data[0] == 4.0


@pytest.mark.parametrize(
    "make",
    [
        lambda path: None,
        lambda path: path.write_bytes(b""),
        lambda path: path.mkdir(),
        lambda path: path.write_text("no image"),
    ],
)
def test_f1_unreadable_images_keep_their_path(scene: bpy.types.Scene, tmp_path: Path, make: object) -> None:
    """The library warns with this path."""
    path = tmp_path / "broken.png"
    make(path)
    block = bpy.data.images.new("Broken", 1, 1)
    block.source = "FILE"
    block.filepath = str(path)
    (tile,) = _state(block).tiles
    assert (tile.source, tile.path) == (FILE, str(path))


def test_tiles(scene: bpy.types.Scene, tmp_path: Path) -> None:
    for number in (1001, 1002, 1011):
        _save(tmp_path / f"tile.{number}.png")
    block = bpy.data.images.load(str(tmp_path / "tile.1001.png"))
    block.source = "TILED"
    block.filepath = str(tmp_path / "tile.<UDIM>.png")
    block.tiles.new(1002)
    block.tiles.new(1011)
    state = _state(block)
    found = {tile.number: Path(tile.path).name for tile in state.tiles}
    assert found == {number: f"tile.{number}.png" for number in (1001, 1002, 1011)}


def test_packed_tiles_are_identified_by_their_number(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: tiles were identified by the first packed file whose name contains their number."""
    files = {
        1001: _save(tmp_path / "v1002_1001.png", color=(1, 0, 0)),
        1002: _save(tmp_path / "v1002_1002.png", color=(0, 1, 0)),
    }
    block = bpy.data.images.load(str(files[1001]))
    block.source = "TILED"
    block.filepath = str(tmp_path / "v1002_<UDIM>.png")
    block.tiles.new(1002)
    block.pack()
    found = {tile.number: bytes(tile.data) for tile in _state(block).tiles}
    assert found == {number: path.read_bytes() for number, path in files.items()}


def test_tile_names() -> None:
    assert images.tile_path("a.<UDIM>.png", 1012) == "a.1012.png"
    assert images.tile_path("a.<UVTILE>.png", 1012) == "a.u2_v2.png"


@pytest.mark.parametrize(
    "frame, cyclic, expected",
    [(1, False, 1), (5, False, 5), (12, False, 10), (0, False, 0), (12, True, 2), (10, True, 10), (-3, True, 7)],
)
def test_sequence_frames(frame: int, cyclic: bool, expected: int) -> None:
    user = SimpleNamespace(frame_duration=10, frame_start=1, frame_offset=0, use_cyclic=cyclic)
    assert images.user_frame(user, frame) == expected
    user.frame_offset = 100
    assert images.user_frame(user, frame) == expected + 100


def test_sequence_paths() -> None:
    assert images.sequence_path("/a1/name_0007.exr", 12) == "/a1/name_0012.exr"
    assert images.sequence_path("/a1/name_7.exr", 12) == "/a1/name_12.exr"
    assert images.sequence_path("/a1/name.exr", 12) == "/a1/name.exr"


def test_sequence_of_the_frame(scene: bpy.types.Scene, tmp_path: Path) -> None:
    for number in (1, 2, 3):
        _save(tmp_path / f"s_{number:03d}.png")
    block = bpy.data.images.load(str(tmp_path / "s_001.png"))
    block.source = "SEQUENCE"
    user = SimpleNamespace(frame_duration=3, frame_start=1, frame_offset=0, use_cyclic=False)
    assert Path(_state(block, user, 2).tiles[0].path).name == "s_002.png"


_COLORS = {1: (1.0, 0.0, 0.0), 2: (0.0, 1.0, 0.0), 3: (0.0, 0.0, 1.0)}
_USER = SimpleNamespace(frame_duration=3, frame_start=1, frame_offset=0, use_cyclic=False)


def _color(state: images.ImageState, number: int = 0) -> tuple[float, ...]:
    """Returns the first pixel of a tile that Blender decoded."""
    (tile,) = (tile for tile in state.tiles if tile.number == number)
    assert tile.source == BYTE
    return tuple(value / 255.0 for value in tile.data[:3])


@pytest.mark.parametrize("kind, suffix", [("TARGA", "tga"), ("BMP", "bmp"), ("WEBP", "webp")])
def test_sequences_in_formats_that_only_blender_reads(
    scene: bpy.types.Scene, tmp_path: Path, kind: str, suffix: str
) -> None:
    """Regression: all frames were magenta, because Image.pixels has one frame only."""
    for number, color in _COLORS.items():
        _save(tmp_path / f"s_{number}.{suffix}", kind, color)
    block = bpy.data.images.load(str(tmp_path / f"s_1.{suffix}"))
    block.source = "SEQUENCE"
    for frame in (2, 1, 3):
        assert _color(_state(block, _USER, frame)) == pytest.approx(_COLORS[frame], abs=0.02)


def _movie(scene: bpy.types.Scene, folder: Path) -> str:
    """Renders a movie whose three frames have the colours of _COLORS. Returns its path."""
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    nodes = scene.world.node_tree.nodes
    background = next(node for node in nodes if node.bl_idname == "ShaderNodeBackground")
    recording.add_camera()
    for frame, color in _COLORS.items():
        background.inputs["Color"].default_value = (*color, 1.0)
        background.inputs["Color"].keyframe_insert("default_value", frame=frame)
    scene.view_settings.view_transform = "Standard"
    scene.frame_start, scene.frame_end = 1, 3
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "CYCLES", 64, 48
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "VIDEO"
    settings.file_format = "AVI_JPEG" if bpy.app.version < (4, 0, 0) else "FFMPEG"
    scene.render.filepath = str(folder / "movie_")
    bpy.ops.render.render(animation=True)
    return str(next(folder.glob("movie_*")))


def test_movies_play(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: a movie showed its first frame in all frames."""
    block = bpy.data.images.load(_movie(scene, tmp_path))
    assert block.source == "MOVIE"
    for frame in (2, 1, 3):
        assert _color(_state(block, _USER, frame)) == pytest.approx(_COLORS[frame], abs=0.1)
    signatures = {images.signature(block, number, bpy.path.abspath) for number in (1, 2, 3)}
    assert len(signatures) == 3 and None not in signatures


@pytest.mark.parametrize("is_packed", [False, True])
def test_tiles_in_formats_that_only_blender_reads(scene: bpy.types.Scene, tmp_path: Path, is_packed: bool) -> None:
    """Regression: tiles other than the first one were magenta."""
    numbers = {1001: 1, 1002: 2, 1011: 3}
    for number, color in numbers.items():
        _save(tmp_path / f"t.{number}.tga", "TARGA", _COLORS[color])
    block = bpy.data.images.load(str(tmp_path / "t.1001.tga"))
    block.source = "TILED"
    block.filepath = str(tmp_path / "t.<UDIM>.tga")
    block.tiles.new(1002)
    block.tiles.new(1011)
    if is_packed:
        block.pack()
        for path in tmp_path.iterdir():
            path.unlink()
    before = len(bpy.data.images)
    state = _state(block)
    for number, color in numbers.items():
        assert _color(state, number) == pytest.approx(_COLORS[color], abs=0.02)
    assert len(bpy.data.images) == before


def test_tiled_image_that_was_never_saved(scene: bpy.types.Scene) -> None:
    block = bpy.data.images.new("Unsaved", 4, 4, tiled=True)
    block.pixels.foreach_set([0.0, 1.0, 0.0, 1.0] * 16)
    number = 0 if bpy.app.version < (4, 4, 0) else 1001  # before, Cycles repeats a single tile
    assert _color(_state(block), number) == pytest.approx((0.0, 1.0, 0.0), abs=0.02)


_MODE_DECIDES = bpy.app.version >= (5, 2, 0)


@pytest.mark.parametrize(
    "mode, of_colors, of_data",
    [
        ("STRAIGHT", 4 if _MODE_DECIDES else 0, 2),
        ("PREMUL", 1 if _MODE_DECIDES else 0, 2),
        ("CHANNEL_PACKED", 2, 2),
        ("NONE", 3, 3),
    ],
)
def test_alpha_and_data(scene: bpy.types.Scene, tmp_path: Path, mode: str, of_colors: int, of_data: int) -> None:
    """Regression: data were multiplied by alpha, which Cycles never does."""
    block = bpy.data.images.load(str(_save(tmp_path / "picture.png")))
    block.alpha_mode = mode
    assert _state(block).alpha_mode == of_colors
    block.colorspace_settings.name = "Non-Color"
    state = _state(block)
    assert state.alpha_mode == of_data and state.color_space == ""


def test_changed_file_is_another_content(scene: bpy.types.Scene, tmp_path: Path) -> None:
    path = _save(tmp_path / "picture.png")
    block = bpy.data.images.load(str(path))

    def identities() -> tuple:
        return images.content(_state(block)), images.signature(block, None, bpy.path.abspath)

    before = identities()
    assert identities() == before
    path.write_bytes(path.read_bytes() + b"\0")
    assert all(now != then for now, then in zip(identities(), before, strict=True))
    block.pack()
    packed = identities()
    block.colorspace_settings.name = "Non-Color"
    assert all(now != then for now, then in zip(identities(), packed, strict=True))
    block.pixels[0] = 0.5
    assert images.signature(block, None, bpy.path.abspath) is None, (
        "only the pixels of a painted image identify its content"
    )
