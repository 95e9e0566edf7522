"""Loads libgradus.so: load() returns the one Library of the process, whose methods raise GradusError.

Every function of gradus.h is a method of Library under its name without the prefix `gradus_`. The structs and enums of
abi.py are re-exported, so that users of the C API import this module only: native.Mesh, native.Settings, native.Pass.
"""

from __future__ import annotations

import ctypes
import os
import struct
import threading
from array import array
from collections.abc import Callable, Iterable, Sequence
from ctypes import byref
from pathlib import Path
from typing import Any, TypeVar

from . import abi
from .abi import (  # noqa: F401
    VERSION,
    AlphaMode,
    Attribute,
    Camera,
    CameraType,
    Channel,
    ChannelKind,
    ConvertColors,
    Denoiser,
    DeviceSettings,
    Domain,
    Error,
    Image,
    ImageSource,
    ImageTile,
    Input,
    Instances,
    Integrator,
    Light,
    LightFlags,
    LightType,
    Material,
    Mesh,
    MistFalloff,
    Node,
    ObjectKind,
    OptionInfo,
    OptionType,
    Panorama,
    Pass,
    Phase,
    PixelFilter,
    Progress,
    Reconstruction,
    SequenceSettings,
    Settings,
    Struct,
    Visibility,
    World,
)
from .failure import Failure

LIBRARY_NAME = "libgradus.so"
ENVIRONMENT_VARIABLE = "GRADUS_LIBRARY"
CPU_INFO = Path("/proc/cpuinfo")
CPU_FLAGS = ("avx2", "fma")
"""Instruction sets that the library is compiled for; see CMakeLists.txt."""


class GradusError(Failure):
    """A call failed, or the library cannot be used. `code` is an abi.Error, `text` is the message for users."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code
        self.text = text


def is_truncated(path: Path) -> bool:
    """Returns whether an ELF file ends before its section headers, which are stored last.

    The loader would crash on such a file.
    """
    with path.open("rb") as file:
        header = file.read(64)
    if len(header) < 64 or header[:5] != b"\x7fELF\x02":
        return False  # not a 64-bit ELF file, which the loader reports
    offset, entry_size, count = struct.unpack_from("<Q10xHH", header, 40)
    return path.stat().st_size < offset + entry_size * count


def missing_cpu_flags(info: Path) -> list[str]:
    """Returns the CPU_FLAGS that the processor lacks, or [] where the system does not list them.

    Without this check, the first instruction of the library would end Blender.
    """
    try:
        lines = info.read_text(errors="replace").splitlines()
    except OSError:
        return []
    flags = next((set(line.split()) for line in lines if line.startswith("flags")), set(CPU_FLAGS))
    return [flag for flag in CPU_FLAGS if flag not in flags]


class Library:
    """A loaded and checked library. Thread-safe; ctypes releases the interpreter lock during calls."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise GradusError(Error.UNSUPPORTED, f"library not found: {self.path}")
        if is_truncated(self.path):
            raise GradusError(Error.UNSUPPORTED, f"library cannot be loaded: {self.path}: the file is truncated")
        missing = missing_cpu_flags(CPU_INFO)
        if missing:
            flags = " and ".join(missing)
            raise GradusError(Error.UNSUPPORTED, f"this processor lacks {flags}, which the library needs: {self.path}")
        try:
            # RTLD_LOCAL keeps the library's symbols out of Blender's global scope, where they could replace others of
            # the same name.
            self.cdll = ctypes.CDLL(str(self.path), mode=ctypes.RTLD_LOCAL)
        except OSError as error:
            raise GradusError(Error.UNSUPPORTED, f"library cannot be loaded: {self.path}: {error}") from error
        self._check()
        for name in abi.FUNCTIONS:
            setattr(self, name.removeprefix("gradus_"), self._bind(name))

    def _check(self) -> None:
        """Refuses a library of another version before any struct is passed to it.

        The two functions called here never change.
        """
        try:
            version, layout = self._bind("gradus_version")(), self._bind("gradus_abi_hash")()
        except AttributeError as error:
            raise GradusError(Error.UNSUPPORTED, f"not a Gradus library: {self.path}: {error}") from error
        if version != VERSION[0] * 10000 + VERSION[1] * 100 + VERSION[2]:
            found = f"{version // 10000}.{version // 100 % 100}.{version % 100}"
            needed = ".".join(map(str, VERSION))
            raise GradusError(Error.UNSUPPORTED, f"library {self.path} has version {found}, the add-on needs {needed}")
        if layout != abi.layout_hash():
            layouts = f"layout {layout:016x}, the add-on {abi.layout_hash():016x}"
            raise GradusError(Error.UNSUPPORTED, f"library {self.path} has {layouts}: install both from one release")
        missing = [name for name in abi.FUNCTIONS if not hasattr(self.cdll, name)]
        if missing:
            raise GradusError(Error.UNSUPPORTED, f"library {self.path} lacks {', '.join(missing)}")

    def _bind(self, name: str) -> Any:
        function = getattr(self.cdll, name)
        function.restype, function.argtypes = abi.FUNCTIONS[name]
        if name in abi.RETURNS_CODE:
            function.errcheck = self._raise_on_error
        return function

    def _raise_on_error(self, code: int, function: Any, _arguments: tuple[Any, ...]) -> int:
        if code not in (Error.OK, Error.TIMEOUT):  # who waits looks at the code
            raise GradusError(code, self.take_error() or f"{function.__name__} failed with code {code}")
        return code

    def take_error(self) -> str:
        """Returns the text of this thread's first error that has not been read yet, or ""."""
        message = ctypes.c_char_p()
        self.cdll.gradus_error(byref(message))
        return (message.value or b"").decode("utf-8", "replace")

    def take_device_warnings(self, device: int) -> list[str]:
        """Returns all warnings about the device that have not been taken yet, oldest first."""
        return self._take_warnings(self.device_warning, device)

    def take_scene_warnings(self, scene: int) -> list[str]:
        """Returns all warnings of a scene's commits that have not been taken yet, oldest first."""
        return self._take_warnings(self.scene_warning, scene)

    def take_sequence_warnings(self, sequence: int) -> list[str]:
        """Returns all warnings about stored frames of a sequence that have not been taken yet, oldest first."""
        return self._take_warnings(self.sequence_warning, sequence)

    def _take_warnings(self, function: Callable[..., int], handle: int) -> list[str]:
        warnings: list[str] = []
        message = ctypes.c_char_p()
        while True:
            function(handle, byref(message))
            if not message.value:
                return warnings
            warnings.append(message.value.decode("utf-8", "replace"))

    def options(self) -> list[OptionInfo]:
        """Returns the library's table of settings: name, type, default, range and description."""
        infos = []
        for index in range(self.option_count()):
            info = OptionInfo()
            self.option(index, byref(info))
            infos.append(info)
        return infos

    def call(self, name: str, *arguments: Any) -> int:
        """Calls gradus_<name>(*arguments), for callers that have the name in a variable."""
        return getattr(self, name)(*arguments)

    def __getattr__(self, name: str) -> Any:
        # Functions are instance attributes, which Python finds before it calls this method.
        if name in _DECLARED:
            return getattr(abi, name)
        raise AttributeError(f"gradus_{name} is not in gradus.h")


_DECLARED = frozenset(kind.__name__ for kind in (*abi.STRUCTS, *abi.ENUMS))


# ------------------------------------------------------------------------------------------------ the loaded library

_lock = threading.Lock()
_libraries: dict[str, Library] = {}
preferred_path: str = ""
"""The path set in the add-on's preferences; "" for the library beside the package."""


def library_path() -> Path:
    """Returns the path of the library.

    It is that of the environment variable, else of the preferences, else in the package's lib folder.
    """
    chosen = os.environ.get(ENVIRONMENT_VARIABLE) or preferred_path
    return Path(chosen) if chosen else Path(__file__).resolve().parent / "lib" / LIBRARY_NAME


def load(path: str | os.PathLike[str] | None = None) -> Library:
    """Returns the library at `path` (default: library_path()), loaded once.

    Raises GradusError with a message for users.
    """
    key = os.path.realpath(path if path is not None else library_path())
    with _lock:
        if key not in _libraries:
            _libraries[key] = Library(key)
        return _libraries[key]


# ------------------------------------------------------------------------------------------------ arguments

StructT = TypeVar("StructT", bound=Struct)

_CODES = {"f": ctypes.c_float, "i": ctypes.c_int32, "I": ctypes.c_uint32, "Q": ctypes.c_uint64, "B": ctypes.c_uint8}


def pointer(values: array | memoryview | None) -> Any:
    """Returns a typed pointer to an array('f'|'i'|'I'|'Q'|'B'), or NULL (None) for None or an empty array.

    The pointer keeps the array alive. A memoryview of such items may take its place. Raises TypeError for anything
    else, because a wrong item type would be read as garbage.
    """
    if values is None:
        return None
    code = values.format if isinstance(values, memoryview) else getattr(values, "typecode", "")
    if not isinstance(values, array | memoryview) or code not in _CODES:
        raise TypeError(f"expected array('f'|'i'|'I'|'Q'|'B'), got {type(values).__name__} {code}")
    if not values:
        return None
    kind = _CODES[code]
    return ctypes.pointer(kind.from_buffer(values))  # to the first value: a type for each length would stay in memory


def text(value: str | None) -> bytes | None:
    """Encodes a string for a const char* field. Surrogates of undecodable file names become their original bytes."""
    return None if value is None else value.encode("utf-8", "surrogateescape")


def name(value: str | None) -> bytes | None:
    """Encodes a name for a const char* field, which must be valid UTF-8. Surrogates of undecodable bytes become '?'."""
    return None if value is None else value.encode("utf-8", "replace")


def name_array(values: Sequence[str]) -> Any:
    """Returns a const char* const*, or NULL (None) if there are no values."""
    return (ctypes.c_char_p * len(values))(*(name(value) for value in values)) if values else None


def struct_array(kind: type[StructT], items: Iterable[StructT]) -> Any:
    """Returns a C array of structs, or NULL (None) if there are none. It keeps alive what the items point to."""
    listed = list(items)
    return (kind * len(listed))(*listed) if listed else None
