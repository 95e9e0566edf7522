"""Finds the tests that take a part of their cases, samples or time with every change, and all in the full run.

Such a test, or a function, constant or class that it uses, asks for the full run: in C++ by full_run(), in Python by
GRADUS_TEST_FULL.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]

# Statements at the top level begin in the first column and continue in indented lines, as clang-format writes them.
CPP_STATEMENT = re.compile(r"^[A-Za-z].*\n(?:(?:[ \t})/#].*)?\n)*", re.M)
CPP_TEST = re.compile(r"TEST(?:_[FP])?\((\w+),\s*(\w+)\)")
CPP_NAME = re.compile(
    r"INSTANTIATE_TEST_SUITE_P\(\w+,\s*(\w+)|(?:class|struct)\s+(\w+)|[^({=;]*?(\w+)\s*(?:[({=;]|\[)", re.S
)
CPP_INCLUDE = re.compile(r'^#include "([\w/]+)\.h"', re.M)


@dataclass(frozen=True)
class Statement:
    """A statement at the top level of a source. `words` are the names that it uses; tests have the name of theirs."""

    name: str
    words: frozenset[str]


def cpp_tests(path: Path) -> frozenset[str]:
    """Returns the tests of a C++ source that are shortened, as Suite.Name."""
    source = path.read_text()
    known = frozenset({"full_run"}).union(*map(cpp_helpers, CPP_INCLUDE.findall(source)))
    return frozenset(name for name in users(cpp_statements(source), known) if "." in name)


@cache
def cpp_helpers(name: str) -> frozenset[str]:
    """Returns what NAME.h and NAME.cpp of the tests define whose value or effect depends on the full run."""
    paths = [folder / f"{name}{ending}" for folder in (TESTS, TESTS / "native") for ending in (".h", ".cpp")]
    statements = [item for path in paths if path.is_file() for item in cpp_statements(path.read_text())]
    return users(statements, frozenset({"full_run"}))


def cpp_statements(source: str) -> list[Statement]:
    return [statement for match in CPP_STATEMENT.finditer(source) for statement in cpp_statement(match[0])]


def cpp_statement(text: str) -> Iterator[Statement]:
    code = re.sub(r"//.*", "", text)
    words = frozenset(re.findall(r"\w+", code))
    if test := CPP_TEST.match(code):
        yield Statement(f"{test[1]}.{test[2]}", words)
    elif found := CPP_NAME.match(code):
        yield Statement(found[1] or found[2] or found[3], words)


def python_tests(path: Path) -> frozenset[str]:
    """Returns the tests of a Python source that are shortened."""
    names = users(python_statements(path.read_text()), frozenset({"GRADUS_TEST_FULL"}))
    return frozenset(name for name in names if name.startswith("test_"))


def python_statements(source: str) -> list[Statement]:
    return [Statement(name, python_words(node)) for node in ast.parse(source).body for name in python_names(node)]


def python_names(node: ast.stmt) -> list[str]:
    if isinstance(node, ast.Assign):
        return [target.id for target in node.targets if isinstance(target, ast.Name)]
    return [node.name] if isinstance(node, (ast.FunctionDef, ast.ClassDef)) else []


def python_words(node: ast.stmt) -> frozenset[str]:
    """Returns names, parameters (which may be fixtures) and texts."""
    words = set()
    for item in ast.walk(node):
        if isinstance(item, ast.Name):
            words.add(item.id)
        elif isinstance(item, ast.arg):
            words.add(item.arg)
        elif isinstance(item, ast.Constant) and isinstance(item.value, str):
            words.add(item.value)
    return frozenset(words)


def users(statements: list[Statement], known: frozenset[str]) -> frozenset[str]:
    """Returns the names of the statements that use a name of `known`, or that use one of these statements."""
    found = known
    while True:
        more = found | {statement.name for statement in statements if statement.words & found}
        if more == found:
            return found - known
        found = more
