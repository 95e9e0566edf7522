"""Determines which test files need Blender: those that import bpy, directly or through modules of this project."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SEARCHED = tuple(ROOT / folder for folder in ("tests", "addon", "tools/bench", "tests/faults", "tools"))
BLENDER_MODULES = {"bpy", "mathutils", "bmesh", "bl_math", "gpu", "freestyle", "idprop", "imbuf", "aud", "bpy_extras"}


@cache
def needs_blender(path: Path) -> bool:
    """Returns whether importing a file imports a module of Blender. Imports inside functions do not count."""
    return _needs(path, set())


def _needs(path: Path, seen: set[Path]) -> bool:
    if path in seen:
        return False
    seen.add(path)
    names = list(imported(path))
    if any(name.split(".")[0] in BLENDER_MODULES for name in names):
        return True
    return any(_needs(module, seen) for name in names for module in files_of(name))


def imported(path: Path) -> Iterator[str]:
    """Yields the dotted names that a file imports when it is imported: for `from a import b`, both a and a.b."""
    for node in import_time_statements(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            module = absolute(path, node)
            yield module
            yield from (f"{module}.{name.name}" for name in node.names)


def import_time_statements(node: ast.AST) -> Iterator[ast.stmt]:
    """Yields the statements that run when a module is imported."""
    for child in ast.iter_child_nodes(node):
        is_typing = isinstance(child, ast.If) and ast.unparse(child.test).endswith("TYPE_CHECKING")
        is_function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef)
        if isinstance(child, ast.stmt) and not is_function and not is_typing:
            yield child
            yield from import_time_statements(child)


def absolute(path: Path, node: ast.ImportFrom) -> str:
    if not node.level:
        return node.module or ""
    package = path.parents[node.level - 1]
    root = next(folder for folder in SEARCHED if package.is_relative_to(folder))
    return ".".join([*package.relative_to(root).parts, *([node.module] if node.module else [])])


def files_of(name: str) -> Iterator[Path]:
    """Yields the files of this project that an import runs: of the module and of the packages that contain it."""
    parts = name.split(".")
    for folder in SEARCHED:
        for length in range(1, len(parts) + 1):
            base = folder.joinpath(*parts[:length])
            for file in (base.with_suffix(".py"), base / "__init__.py"):
                if file.is_file():
                    yield file
