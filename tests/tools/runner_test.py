"""The test runner (tools/runner): a crash or a hang fails one file, and changes of the process are undone."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools"))
from runner import hosts, imports, plan, programs  # noqa: E402
from runner.hosts import HostProcess, TestFile  # noqa: E402
from runner.results import Result  # noqa: E402


@pytest.fixture
def host(monkeypatch: pytest.MonkeyPatch) -> Iterator[HostProcess]:
    """Runs plain Python with the interpreter of this process."""
    monkeypatch.setitem(hosts.HOSTS, "plain", [sys.executable, *hosts.HOSTS["plain"][1:]])
    process = HostProcess("plain", dict(os.environ))
    yield process
    process.close()


def write(folder: Path, name: str, text: str, limit: float = 60, marks: str = "") -> TestFile:
    path = folder / name
    path.write_text(text)
    return TestFile(path, limit, marks)


def outcome(result: Result) -> tuple[int, int, int]:
    return result.passed, result.failed, result.skipped


GOOD = "def test_good(): pass\n"
MIXED = GOOD + "import pytest\ndef test_bad(): assert 1 == 2\ndef test_skipped(): pytest.skip('why')\n"


def test_outcomes_are_counted(host: HostProcess, tmp_path: Path) -> None:
    result = host.run(write(tmp_path, "mixed_test.py", MIXED))
    assert outcome(result) == (1, 1, 1)
    assert "assert 1 == 2" in "".join(result.notes)


@pytest.mark.parametrize(
    ("text", "limit", "reason"),
    [
        ("import os\ndef test_crash(): os.abort()\n", 60, "crash, code -6"),
        ("import time\ndef test_hang(): time.sleep(100)\n", 3, "time limit of 3 s"),
        ("import os\ndef test_end():\n    print('last words')\n    os._exit(0)\n", 60, "crash, code 0"),
        ("this is no Python\n", 60, "SyntaxError"),
        ("import bpy\ndef test_of_blender(): pass\n", 60, "import of bpy halted"),
    ],
    ids=["crash", "hang", "exit", "syntax", "bpy"],
)
def test_a_broken_file_is_one_failure_and_the_next_one_runs(
    host: HostProcess, tmp_path: Path, text: str, limit: float, reason: str
) -> None:
    broken = host.run(write(tmp_path, "broken_test.py", text, limit))
    assert outcome(broken) == (0, 1, 0)
    assert reason in "".join(broken.notes)
    assert outcome(host.run(write(tmp_path, "good_test.py", GOOD))) == (1, 0, 0)


def test_changes_of_the_process_are_undone(host: HostProcess, tmp_path: Path) -> None:
    changes = """
import os, sys
def test_change(tmp_path):
    os.environ["LEFT_BEHIND"] = "1"
    os.chdir(tmp_path)
    sys.path.append("/left/behind")
"""
    check = f"""
import os, sys
def test_unchanged():
    assert "LEFT_BEHIND" not in os.environ
    assert os.getcwd() == {str(ROOT)!r}
    assert "/left/behind" not in sys.path
"""
    assert outcome(host.run(write(tmp_path, "change_test.py", changes))) == (1, 0, 0)
    assert outcome(host.run(write(tmp_path, "check_test.py", check))) == (1, 0, 0)


def test_marks_limit_a_file(host: HostProcess, tmp_path: Path) -> None:
    text = "import pytest\n@pytest.mark.alone\ndef test_alone(): pass\ndef test_other(): assert False\n"
    assert outcome(host.run(write(tmp_path, "marked_test.py", text, marks="alone"))) == (1, 0, 0)
    assert outcome(host.run(write(tmp_path, "good_test.py", GOOD, marks="alone"))) == (0, 0, 0)


def test_files_that_import_bpy_are_known(tmp_path: Path) -> None:
    def needs(text: str) -> bool:
        path = tmp_path / f"{abs(hash(text))}_test.py"
        path.write_text(text)
        return imports.needs_blender(path)

    assert needs("import bpy")
    assert needs("try:\n    from mathutils import Vector\nexcept ImportError:\n    pass")
    assert needs("from support import images")  # which imports bpy itself
    assert needs("import support.images")
    assert not needs("from support import application")
    assert not needs("from gradus import abi")
    assert not needs("def later():\n    import bpy")
    assert not needs("SCRIPT = 'import bpy'")


def test_every_file_runs_completely_in_one_host() -> None:
    files = plan.test_files("")
    lanes = plan.hosts_plan(None, files, full=False)
    complete = [file.path for host in ("plain", "bpy45") for file in lanes[host] if not file.marks and not file.tests]
    assert sorted(complete) == files
    everything = plan.hosts_plan(None, files, full=True)
    for host in ("3.4", "bpy45", "bpy50", "bpy52"):
        assert [file.path for file in everything[host]] == files
        assert lanes[host]


@pytest.mark.parametrize(
    ("log", "code", "expected"),
    [
        ("[ RUN      ] A.One\n[       OK ] A.One (0 ms)\n[==========] 1 test ran.\n", 0, (1, 0, 0)),
        ("[ RUN      ] A.One\nwrong\n[  FAILED  ] A.One (0 ms)\n[==========] 1 test ran.\n", 1, (0, 1, 0)),
        ("[ RUN      ] A.One\n[       OK ] A.One (0 ms)\n[ RUN      ] A.Two\n", -11, (1, 1, 0)),
        ("[ RUN      ] A.One\n[       OK ] A.One (0 ms)\n[==========] 1 test ran.\nleak\n", 9, (1, 1, 0)),
        ("[==========] 0 tests from 0 test suites ran.\n", 0, (0, 0, 0)),
        ("", 127, (0, 1, 0)),
    ],
    ids=["passed", "failed", "crash", "error at exit", "empty", "no start"],
)
def test_logs_of_native_programs(log: str, code: int, expected: tuple[int, int, int]) -> None:
    assert outcome(programs.read_log(Result("native"), code, log)) == expected
