"""Failures that are reported to the user, and the text that is reported for any exception."""

from __future__ import annotations


class Failure(Exception):
    """No correct picture can be made. The text says why and, where it is known, what to do."""


def is_expected(error: BaseException) -> bool:
    """Returns whether the text of an exception suffices, so that no traceback is printed."""
    return isinstance(error, Failure)


def user_text(error: BaseException) -> str:
    """Returns one line for report(). It is never empty, because Blender does not show an empty report."""
    if isinstance(error, MemoryError):
        return "out of memory"
    text = " ".join(str(error).split())
    if is_expected(error) and text:
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
