"""The files that tools/schema/generate.py writes from schema/ are up to date and not edited by hand."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PYTHON = "/usr/bin/python3"  # tomllib needs 3.11, which not every host has
GENERATED = (
    "native/include/gradus/gradus.h",
    "native/include/gradus/gradus_nodes.h",
    "native/src/schema/option_table.cpp",
    "native/src/shading/op_functions.h",
    "native/src/shading/op_table.cpp",
    "addon/gradus/abi.py",
    "addon/gradus/setting_table.py",
)


def generate(root: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [PYTHON, root / "tools/schema/generate.py", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """Returns a copy of the schema, its script and the user guide, with all generated files."""
    for folder in ("schema", "tools/schema"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "docs").mkdir()
    shutil.copy(ROOT / "docs" / "user-guide.md", tmp_path / "docs")
    assert generate(tmp_path).returncode == 0
    assert generate(tmp_path, "--check").returncode == 0
    return tmp_path


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_nothing_is_stale() -> None:
    result = generate(ROOT, "--check")
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("path", GENERATED)
def test_an_edited_file_is_named_and_written_anew(copy: Path, path: str) -> None:
    before = (copy / path).read_text(encoding="utf-8")
    assert before == (ROOT / path).read_text(encoding="utf-8")
    (copy / path).write_text(before + "\n", encoding="utf-8")
    result = generate(copy, "--check")
    assert (result.returncode, result.stderr.splitlines()) == (1, [f"{path} is stale: run tools/schema/generate.py"])
    assert generate(copy).returncode == 0
    assert (copy / path).read_text(encoding="utf-8") == before


def test_a_changed_option_reaches_library_and_add_on(copy: Path) -> None:
    change(copy / "schema" / "options.toml", "default = 64", "default = 65")
    stale = {line.partition(" ")[0] for line in generate(copy, "--check").stderr.splitlines()}
    assert {"native/src/schema/option_table.cpp", "addon/gradus/setting_table.py"} <= stale


def test_a_new_operation_is_declared_and_dispatched(copy: Path) -> None:
    row = '  ["MADE_UP", 127, "value, period -> value", "A test.", { last_mode = 1 }],\n'
    change(copy / "schema" / "nodes.toml", '  ["MIX", 99', row + '  ["MIX", 99')
    assert generate(copy).returncode == 0
    shading = copy / "native" / "src" / "shading"
    declaration = "void made_up_op(const OpArgs& args, Vec4* out);"
    assert declaration in (shading / "op_functions.h").read_text(encoding="utf-8")
    table = (shading / "op_table.cpp").read_text(encoding="utf-8")
    assert '{"MADE_UP", OpKind::Pure, 2, 1, 0, 1}' in table
    assert "case GRADUS_OP_MADE_UP:\n      made_up_op(args, out);" in table


def test_a_new_node_is_in_the_list_of_the_guide(copy: Path) -> None:
    change(copy / "schema" / "nodes.toml", '["Clamp", "Clamp"],', '["Clamp", "Clamp"], ["Made Up", "MadeUp"],')
    assert generate(copy).returncode == 0
    assert "Clamp, Made Up, Map Range" in (copy / "docs" / "user-guide.md").read_text(encoding="utf-8")


def test_the_number_of_samples_from_which_the_denoiser_runs_is_given_once(copy: Path) -> None:
    change(copy / "schema" / "options.toml", "minimum_samples = 8", "minimum_samples = 9")
    assert generate(copy).returncode == 0
    for path in ("docs/user-guide.md", "addon/gradus/setting_table.py", "native/include/gradus/gradus.h"):
        text = " ".join((copy / path).read_text(encoding="utf-8").replace("*", " ").split())
        assert "at least 9 samples" in text


def test_the_guide_s_tables_are_filled_between_their_markers(copy: Path) -> None:
    guide = copy / "docs" / "user-guide.md"
    guide.write_text("before\n\n<!-- generated: passes -->\nold\n<!-- end -->\n\nafter\n", encoding="utf-8")
    assert generate(copy, "--check").returncode == 1
    assert generate(copy).returncode == 0
    text = guide.read_text(encoding="utf-8")
    assert text.startswith("before\n\n<!-- generated: passes -->\n| pass |")
    assert text.endswith("|\n<!-- end -->\n\nafter\n")
    assert "| `Noisy Image` | `noisy_image` |" in text
    assert "old" not in text


@pytest.mark.parametrize(
    ("file", "old", "new", "complaint"),
    [
        ("structs.toml", '"float[16]"', '"floot[16]"', "field matrix has the unknown type floot"),
        ("options.toml", 'name = "seed"', 'name = "samples"', "samples is defined twice"),
        ("options.toml", 'label = "Seed"', 'lable = "Seed"', "seed: "),
        ("enums.toml", '["PATH", 1', '["AUTO", 1', "AUTO is defined twice"),
        ("passes.toml", "number = 32", "number = 34", "passes are not numbered from 0 on without gaps"),
        ("nodes.toml", '["MIX", 99', '["MIX", 98', "the number 98 of VECTOR_ROTATE is used twice"),
        ("nodes.toml", '["MIX", 99', '["MIX", 31', "operation MIX has a number outside 32…127"),
        ("nodes.toml", '"factor, a, b -> value"', '"factor, a, b"', "operation MIX: expected 'inputs -> outputs'"),
        ("nodes.toml", "{ floats = 4", "{ float = 4", "operation BRICK: "),
        ("nodes.toml", 'kind = "program"', 'kind = "point"', "operation BUMP has the unknown kind point"),
        ("nodes.toml", '"Components of a colour.",\n    {', '"Components of a colour.",\n    { reads_ray = true,',
         "operation SEPARATE is not of the kind that can read the ray"),
        ("gradus.h.in", "@struct Camera\n", "", "gradus.h.in does not declare each struct of the schema once"),
    ],
)
def test_a_mistake_is_named(copy: Path, file: str, old: str, new: str, complaint: str) -> None:
    change(copy / "schema" / file, old, new)
    result = generate(copy)
    assert result.returncode == 1
    assert complaint in result.stderr
    assert "Traceback" not in result.stderr
