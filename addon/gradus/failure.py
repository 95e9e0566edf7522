"""Failures that the user is told about, and how any exception is put into words."""

from __future__ import annotations


class Failure(Exception):
    """No right picture can be made; the text says why, and what to do where that is known."""


def is_expected(error: BaseException) -> bool:
    """Whether the text says all: a traceback would only bury it."""
    return isinstance(error, Failure) or type(error).__name__ in ("GradusError", "ExportError", "OptionError")


def user_text(error: BaseException) -> str:
    """One line for report(): never empty, since an empty report is shown as nothing."""
    if isinstance(error, MemoryError):
        return "out of memory"
    text = " ".join(str(error).split())
    if is_expected(error) and text:
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
