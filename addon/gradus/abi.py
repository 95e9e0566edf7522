"""The structs, enums and functions of gradus.h as ctypes declarations, in the header's order and under its names without prefix.

Only declarations: native.py loads the library and calls it. Tests H1 and H2 compare this file with the header and the library.
"""

from __future__ import annotations

import ctypes
from ctypes import POINTER, c_char, c_char_p, c_double, c_float, c_int, c_int32, c_size_t, c_uint32, c_uint64, c_void_p
from enum import IntEnum, IntFlag
from typing import Any

VERSION = (0, 1, 0)


class Error(IntEnum):
    OK = 0
    UNKNOWN = 1
    INVALID_ARGUMENT = 2
    INVALID_OPERATION = 3
    OUT_OF_MEMORY = 4
    UNSUPPORTED = 5
    CANCELLED = 6
    TIMEOUT = 7


class Domain(IntEnum):
    POINT = 0
    FACE = 1
    CORNER = 2


class Visibility(IntFlag):
    VISIBLE_CAMERA = 1
    VISIBLE_DIFFUSE = 2
    VISIBLE_GLOSSY = 4
    VISIBLE_TRANSMISSION = 8
    VISIBLE_VOLUME = 16
    VISIBLE_SHADOW = 32
    VISIBLE_ALL = 63
    HOLDOUT = 64
    SHADOW_CATCHER = 128
    MAY_MOVE = 256


class LightType(IntEnum):
    POINT = 0
    SPOT = 1
    SUN = 2
    RECTANGLE = 3
    ELLIPSE = 4


class LightFlags(IntFlag):
    NO_SHADOW = 1
    SPOT_COSINE = 2
    DISK_FACING = 4
    NO_MIS = 8


class CameraType(IntEnum):
    PERSPECTIVE = 0
    ORTHOGRAPHIC = 1
    PANORAMA = 2


class Panorama(IntEnum):
    EQUIRECTANGULAR = 0
    CUBE_FACE = 1
    MIRROR_BALL = 2
    FISHEYE_EQUIDISTANT = 3
    FISHEYE_EQUISOLID = 4
    FISHEYE_POLYNOMIAL = 5
    CYLINDER = 6


class MistFalloff(IntEnum):
    QUADRATIC = 0
    LINEAR = 1
    INVERSE_QUADRATIC = 2


class ImageSource(IntEnum):
    FILE = 0
    ENCODED = 1
    FLOAT = 2
    BYTE = 3


class AlphaMode(IntEnum):
    STRAIGHT = 0
    PREMULTIPLIED = 1
    CHANNEL_PACKED = 2
    NONE = 3


class ObjectKind(IntEnum):
    MESH = 0
    IMAGE = 1
    MATERIAL = 2


class Integrator(IntEnum):
    AUTO = 0
    PATH = 1
    GRADIENT = 2
    BIDIRECTIONAL = 3
    METROPOLIS = 4


class Reconstruction(IntEnum):
    AUTO = 0
    NONE = 1
    L2 = 2
    WEIGHTED = 3
    L1 = 4
    REGULARIZED = 5


class Denoiser(IntEnum):
    NONE = 0
    AUTO = 1
    OIDN = 2


class PixelFilter(IntEnum):
    BOX = 0
    GAUSSIAN = 1
    BLACKMAN_HARRIS = 2


class Pass(IntEnum):
    COMBINED = 0
    NOISY_IMAGE = 1
    DEPTH = 2
    MIST = 3
    NORMAL = 4
    POSITION = 5
    UV = 6
    VECTOR = 7
    OBJECT_INDEX = 8
    MATERIAL_INDEX = 9
    EMISSION = 10
    ENVIRONMENT = 11
    DIFFUSE_DIRECT = 12
    DIFFUSE_INDIRECT = 13
    DIFFUSE_COLOR = 14
    GLOSSY_DIRECT = 15
    GLOSSY_INDIRECT = 16
    GLOSSY_COLOR = 17
    TRANSMISSION_DIRECT = 18
    TRANSMISSION_INDIRECT = 19
    TRANSMISSION_COLOR = 20
    AMBIENT_OCCLUSION = 21
    DENOISING_NORMAL = 22
    DENOISING_ALBEDO = 23
    DENOISING_DEPTH = 24
    SAMPLE_COUNT = 25
    GRADIENT_X = 26
    GRADIENT_Y = 27
    VARIANCE = 28
    FALLBACK = 29
    ERROR = 30
    GRADIENT_T = 31
    GRADIENT_T_LINK = 32
    COUNT = 33


class ComponentPass(IntEnum):
    COLOR = 0
    REFLECTANCE = 1
    IRRADIANCE = 2
    NORMAL = 3
    MOTION = 4
    TRACKED = 5
    IRRADIANCE_MOTION = 6
    IRRADIANCE_TRACKED = 7
    DEPTH = 8
    UV = 9
    OBJECT_INDEX = 10
    FACE_INDEX = 11
    EMIT = 12
    PASS_COUNT = 13


class OptionType(IntEnum):
    INT = 0
    FLOAT = 1
    BOOL = 2
    ENUM = 3
    TEXT = 4


class Phase(IntEnum):
    WAITING = 0
    SAMPLING = 1
    RECONSTRUCTING = 2
    DONE = 3
    CANCELLED = 4
    FAILED = 5


class Struct(ctypes.Structure):
    """Base of all structs: fills struct_size, without which the library refuses the struct."""

    _fields_: list[tuple[str, Any]] = []

    def __init__(self, *args: Any, **fields: Any) -> None:
        super().__init__(*args, **fields)
        if not args and self._fields_ and self._fields_[0][0] == "struct_size":
            self.struct_size = ctypes.sizeof(self)


class DeviceSettings(Struct):
    _fields_ = [("struct_size", c_uint32), ("threads", c_uint32), ("color_config", c_char_p), ("denoiser_path", c_char_p)]


class ColorSpace(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("curve_count", c_uint32),
        ("name", c_char_p),
        ("curve", POINTER(c_float)),
        ("matrix", c_float * 9),
    ]


class Attribute(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("domain", c_uint32),
        ("channels", c_uint32),
        ("is_uv", c_uint32),
        ("name", c_char_p),
        ("data", POINTER(c_float)),
    ]


class Mesh(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("key_count", c_uint32),
        ("key_times", POINTER(c_float)),
        ("vertex_count", c_size_t),
        ("positions", POINTER(c_float)),
        ("corner_count", c_size_t),
        ("corner_vertices", POINTER(c_int32)),
        ("triangle_count", c_size_t),
        ("triangle_corners", POINTER(c_uint32)),
        ("triangle_faces", POINTER(c_int32)),
        ("face_count", c_size_t),
        ("face_materials", POINTER(c_int32)),
        ("normal_domain", c_uint32),
        ("attribute_count", c_uint32),
        ("normals", POINTER(c_float)),
        ("attributes", POINTER(Attribute)),
        ("default_uv", c_char_p),
        ("generated_location", c_float * 3),
        ("generated_size", c_float * 3),
        ("generated_points", POINTER(c_float)),
        ("name", c_char_p),
        ("shutter_positions", POINTER(c_float)),
        ("shutter_key_count", c_uint32),
        ("reserved", c_uint32),
    ]


class Instances(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("count", c_size_t),
        ("meshes", POINTER(c_uint64)),
        ("ids", POINTER(c_uint64)),
        ("matrices", POINTER(c_float)),
        ("matrices_previous", POINTER(c_float)),
        ("matrices_next", POINTER(c_float)),
        ("visibility", POINTER(c_uint32)),
        ("random_ids", POINTER(c_uint32)),
        ("pass_indices", POINTER(c_int32)),
        ("colors", POINTER(c_float)),
        ("generated", POINTER(c_float)),
        ("uvs", POINTER(c_float)),
        ("shadow_terminator_offsets", POINTER(c_float)),
        ("material_first", POINTER(c_uint32)),
        ("material_count", POINTER(c_uint32)),
        ("materials_size", c_size_t),
        ("materials", POINTER(c_uint64)),
        ("name_index", POINTER(c_uint32)),
        ("name_count", c_size_t),
        ("names", POINTER(c_char_p)),
        ("shutter_first", POINTER(c_uint32)),
        ("shutter_count", POINTER(c_uint32)),
        ("shutter_size", c_size_t),
        ("shutter_matrices", POINTER(c_float)),
    ]


class Light(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("type", c_uint32),
        ("flags", c_uint32),
        ("visibility", c_uint32),
        ("matrix", c_float * 16),
        ("strength", c_float * 3),
        ("radius", c_float),
        ("angle", c_float),
        ("size", c_float * 2),
        ("spread", c_float),
        ("cone", c_float),
        ("blend", c_float),
        ("sun_radiance_per_irradiance", c_float),
        ("material", c_uint64),
        ("max_bounces", c_uint32),
        ("pass_index", c_int32),
        ("name", c_char_p),
    ]


class Camera(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("type", c_uint32),
        ("matrix", c_float * 16),
        ("matrix_previous", c_float * 16),
        ("matrix_next", c_float * 16),
        ("window", c_float * 4),
        ("window_previous", c_float * 4),
        ("window_next", c_float * 4),
        ("clip_start", c_float),
        ("clip_end", c_float),
        ("aperture_radius", c_float),
        ("focus_distance", c_float),
        ("blades", c_uint32),
        ("blade_rotation", c_float),
        ("aperture_ratio", c_float),
        ("panorama", c_uint32),
        ("fisheye_fov", c_float),
        ("fisheye_polynomial", c_float * 5),
        ("eye_offset", c_float),
        ("convergence_distance", c_float),
        ("pole_merge_from", c_float),
        ("pole_merge_to", c_float),
        ("shutter_key_count", c_uint32),
        ("shutter_open", c_float),
        ("shutter_close", c_float),
        ("shutter_curve_count", c_uint32),
        ("reserved", c_uint32),
        ("shutter_curve", POINTER(c_float)),
        ("shutter_matrices", POINTER(c_float)),
        ("shutter_windows", POINTER(c_float)),
    ]


class World(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("visibility", c_uint32),
        ("material", c_uint64),
        ("importance", c_uint32),
        ("map_size", c_uint32),
        ("mist_start", c_float),
        ("mist_depth", c_float),
        ("mist_falloff", c_uint32),
        ("ao_distance", c_float),
    ]


class ImageTile(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("number", c_uint32),
        ("source", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("reserved", c_uint32),
        ("path", c_char_p),
        ("data", c_void_p),
        ("data_size", c_size_t),
    ]


class Image(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("alpha_mode", c_uint32),
        ("is_float", c_uint32),
        ("tile_count", c_uint32),
        ("tiles", POINTER(ImageTile)),
        ("color_space", c_char_p),
        ("name", c_char_p),
    ]


class Input(Struct):
    _fields_ = [("node", c_int32), ("output", c_uint32), ("value", c_float * 4)]


class Node(Struct):
    _fields_ = [
        ("op", c_uint32),
        ("mode", c_uint32),
        ("first_input", c_uint32),
        ("input_count", c_uint32),
        ("first_float", c_uint32),
        ("float_count", c_uint32),
        ("resource", c_uint64),
    ]


class Material(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("node_count", c_uint32),
        ("nodes", POINTER(Node)),
        ("inputs", POINTER(Input)),
        ("input_count", c_size_t),
        ("floats", POINTER(c_float)),
        ("float_count", c_size_t),
        ("names", POINTER(c_char_p)),
        ("name_count", c_uint32),
        ("surface", c_int32),
        ("pass_index", c_int32),
        ("sample_as_light", c_uint32),
        ("transparent_shadow", c_uint32),
        ("uses_fallback", c_uint32),
        ("name", c_char_p),
    ]


class Settings(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("region", c_uint32 * 4),
        ("samples", c_uint32),
        ("min_samples", c_uint32),
        ("noise_threshold", c_float),
        ("time_limit", c_float),
        ("seed", c_uint32),
        ("use_animated_seed", c_uint32),
        ("frame", c_int32),
        ("integrator", c_uint32),
        ("reconstruction", c_uint32),
        ("reconstruction_alpha", c_float),
        ("max_bounces", c_uint32),
        ("diffuse_bounces", c_uint32),
        ("glossy_bounces", c_uint32),
        ("transmission_bounces", c_uint32),
        ("volume_bounces", c_uint32),
        ("transparent_max_bounces", c_uint32),
        ("clamp_direct", c_float),
        ("clamp_indirect", c_float),
        ("pixel_filter", c_uint32),
        ("filter_width", c_float),
        ("film_exposure", c_float),
        ("film_transparent", c_uint32),
        ("roughness_threshold", c_float),
        ("strict", c_uint32),
        ("threads", c_uint32),
        ("alpha_threshold", c_float),
        ("use_sky", c_uint32),
        ("independent_sampler", c_uint32),
        ("passes", c_uint64),
        ("first_sample", c_uint32),
        ("denoiser", c_uint32),
        ("use_decomposition", c_uint32),
        ("component_passes", c_uint32),
        ("components", c_char * 512),
        ("component_replays", c_uint32),
    ]


class OptionInfo(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("type", c_uint32),
        ("name", c_char_p),
        ("doc", c_char_p),
        ("default_value", c_double),
        ("minimum", c_double),
        ("maximum", c_double),
        ("choices", c_char_p),
    ]


class Progress(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("phase", c_uint32),
        ("fraction", c_float),
        ("seconds", c_float),
        ("samples_done", c_uint32),
        ("version", c_uint32),
        ("memory_bytes", c_uint64),
        ("peak_memory_bytes", c_uint64),
    ]


class SequenceSettings(Struct):
    _fields_ = [
        ("struct_size", c_uint32),
        ("step", c_uint32),
        ("first", c_int32),
        ("last", c_int32),
        ("window_size", c_uint32),
        ("window_overlap", c_uint32),
        ("folder", c_char_p),
        ("with_flow", c_uint32),
        ("reserved", c_uint32),
    ]


STRUCTS: tuple[type[Struct], ...] = (
    DeviceSettings,
    ColorSpace,
    Attribute,
    Mesh,
    Instances,
    Light,
    Camera,
    World,
    ImageTile,
    Image,
    Input,
    Node,
    Material,
    Settings,
    OptionInfo,
    Progress,
    SequenceSettings,
)

ENUMS: tuple[type[IntEnum] | type[IntFlag], ...] = (
    Error,
    Domain,
    Visibility,
    LightType,
    LightFlags,
    CameraType,
    Panorama,
    MistFalloff,
    ImageSource,
    AlphaMode,
    ObjectKind,
    Integrator,
    Reconstruction,
    Denoiser,
    PixelFilter,
    Pass,
    ComponentPass,
    OptionType,
    Phase,
)

Device = Scene = Render = Sequence = Frame = c_uint64  # handles are values, never addresses

FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "gradus_version": (c_uint32, []),
    "gradus_version_text": (c_char_p, []),
    "gradus_abi_hash": (c_uint64, []),
    "gradus_error": (c_int, [POINTER(c_char_p)]),
    "gradus_struct_layout": (c_int, [c_char_p, POINTER(c_size_t), POINTER(c_size_t), c_size_t, POINTER(c_size_t)]),
    "gradus_device_create": (c_int, [POINTER(DeviceSettings), POINTER(Device)]),
    "gradus_device_release": (c_int, [Device]),
    "gradus_device_warning": (c_int, [Device, POINTER(c_char_p)]),
    "gradus_device_set_color_space": (c_int, [Device, POINTER(ColorSpace)]),
    "gradus_scene_create": (c_int, [Device, POINTER(Scene)]),
    "gradus_scene_release": (c_int, [Scene]),
    "gradus_scene_set_mesh": (c_int, [Scene, c_uint64, POINTER(Mesh)]),
    "gradus_scene_set_image": (c_int, [Scene, c_uint64, POINTER(Image)]),
    "gradus_scene_set_material": (c_int, [Scene, c_uint64, POINTER(Material)]),
    "gradus_scene_set_instances": (c_int, [Scene, POINTER(Instances)]),
    "gradus_scene_set_lights": (c_int, [Scene, POINTER(Light), c_size_t]),
    "gradus_scene_set_camera": (c_int, [Scene, POINTER(Camera)]),
    "gradus_scene_set_world": (c_int, [Scene, POINTER(World)]),
    "gradus_scene_remove": (c_int, [Scene, c_uint32, c_uint64]),
    "gradus_scene_commit": (c_int, [Scene, POINTER(c_int32), POINTER(c_float)]),
    "gradus_scene_warning": (c_int, [Scene, POINTER(c_char_p)]),
    "gradus_scene_record": (c_int, [Scene, c_uint32]),
    "gradus_option_count": (c_uint32, []),
    "gradus_option": (c_int, [c_uint32, POINTER(OptionInfo)]),
    "gradus_settings_default": (c_int, [POINTER(Settings)]),
    "gradus_settings_parse": (c_int, [POINTER(Settings), c_char_p, c_char_p]),
    "gradus_pass_info": (c_int, [c_uint32, POINTER(c_char_p), POINTER(c_uint32)]),
    "gradus_component_pass_info": (c_int, [c_uint32, POINTER(c_char_p), POINTER(c_uint32)]),
    "gradus_components_check": (c_int, [c_char_p, POINTER(c_uint32)]),
    "gradus_components_item": (c_int, [c_char_p, c_uint32, POINTER(c_char_p), POINTER(c_char_p), POINTER(c_char_p)]),
    "gradus_components_classify": (c_int, [c_char_p, c_char_p, POINTER(c_uint32)]),
    "gradus_scene_save": (c_int, [Scene, POINTER(Settings), c_char_p]),
    "gradus_scene_load": (c_int, [Device, c_char_p, POINTER(Scene), POINTER(Settings)]),
    "gradus_render_start": (c_int, [Scene, POINTER(Settings), POINTER(Render)]),
    "gradus_render_resume": (c_int, [Scene, POINTER(Settings), Frame, POINTER(Render)]),
    "gradus_render_poll": (c_int, [Render, POINTER(Progress)]),
    "gradus_render_cancel": (c_int, [Render]),
    "gradus_render_wait": (c_int, [Render, c_double]),
    "gradus_render_release": (c_int, [Render]),
    "gradus_render_read_pass": (c_int, [Render, c_uint32, POINTER(c_float), c_size_t]),
    "gradus_render_read_component": (c_int, [Render, c_char_p, c_uint32, POINTER(c_float), c_size_t]),
    "gradus_render_stats": (c_int, [Render, POINTER(c_char_p)]),
    "gradus_render_frame": (c_int, [Render, POINTER(Frame)]),
    "gradus_sequence_applies": (c_int, [POINTER(Settings), POINTER(c_uint32), POINTER(c_char_p)]),
    "gradus_sequence_create": (c_int, [Device, POINTER(SequenceSettings), POINTER(Sequence)]),
    "gradus_sequence_needs": (c_int, [Sequence, c_int32, POINTER(c_int32), POINTER(c_int32)]),
    "gradus_sequence_sample": (c_int, [Sequence, Scene, POINTER(Settings), POINTER(Render)]),
    "gradus_sequence_pass_by": (c_int, [Sequence, Scene, POINTER(Settings)]),
    "gradus_sequence_end_at": (c_int, [Sequence, c_int32]),
    "gradus_sequence_deliver": (c_int, [Sequence, c_int32, POINTER(Settings), POINTER(Render)]),
    "gradus_sequence_release": (c_int, [Sequence]),
    "gradus_frame_save": (c_int, [Frame, c_char_p]),
    "gradus_frame_load": (c_int, [Device, c_char_p, POINTER(Frame)]),
    "gradus_frame_merge": (c_int, [Frame, Frame]),
    "gradus_frame_size": (c_int, [Frame, POINTER(c_uint32), POINTER(c_uint32)]),
    "gradus_frame_reconstruct": (c_int, [Frame, c_uint32, c_float, c_uint32, POINTER(c_float), c_size_t, POINTER(c_float)]),
    "gradus_frame_read_pass": (c_int, [Frame, c_uint32, POINTER(c_float), c_size_t]),
    "gradus_frame_read_component": (c_int, [Frame, c_char_p, c_uint32, POINTER(c_float), c_size_t]),
    "gradus_frame_release": (c_int, [Frame]),
}
"""(restype, argtypes) of every function of the header."""

RETURNS_CODE = frozenset(name for name, (restype, _) in FUNCTIONS.items() if restype is c_int and name != "gradus_error")
"""Functions that return a GradusError; gradus_error itself is how its text is read."""


def layout_text() -> str:
    """The text that the ABI hash is formed of (see gradus_abi_hash in gradus.h)."""
    parts = []
    for struct in STRUCTS:
        offsets = ",".join(str(getattr(struct, field[0]).offset) for field in struct._fields_)
        parts.append(f"{struct.__name__}:{ctypes.sizeof(struct)}:{offsets};")
    for enum in ENUMS:
        parts.append(f"{enum.__name__}:{','.join(str(int(value)) for value in enum.__members__.values())};")
    return "".join(parts)


def layout_hash(text: str | None = None) -> int:
    """FNV-1a, 64 bit (Fowler, Noll, Vo), of `text` or of layout_text()."""
    value = 0xCBF29CE484222325
    for byte in (layout_text() if text is None else text).encode("ascii"):
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value
