"""Nodes of colours."""

from __future__ import annotations

from . import working_space
from .node import NodeView, translator
from .ops import Blend, ColorModel, Op
from .program import Value

_CLAMP_RESULT = 32


def mix_colors(view: NodeView, factor: Value, a: Value, b: Value, blend: str, clamp: bool) -> Value:
    return view.add(Op.MIX_COLOR, (factor, a, b), Blend[blend] | (_CLAMP_RESULT if clamp else 0))


@translator("ShaderNodeMixRGB")
def mix_rgb(view: NodeView) -> Value:
    factor, a, b = view.clamped(view.value("Fac")), view.value("Color1"), view.value("Color2")
    return mix_colors(view, factor, a, b, view.node.blend_type, view.node.use_clamp)


@translator("ShaderNodeHueSaturation")
def hue_saturation(view: NodeView) -> Value:
    names = ("Hue", "Saturation", "Value", "Fac", "Color")
    return view.add(Op.HUE_SATURATION, tuple(view.value(name) for name in names))


@translator("ShaderNodeGamma")
def gamma(view: NodeView) -> Value:
    return view.add(Op.GAMMA, (view.value("Color"), view.value("Gamma")))


@translator("ShaderNodeInvert")
def invert(view: NodeView) -> Value:
    return view.add(Op.INVERT, (view.value("Fac"), view.value("Color")))


@translator("ShaderNodeBrightContrast")
def bright_contrast(view: NodeView) -> Value:
    return view.add(Op.BRIGHT_CONTRAST, (view.value("Color"), view.value("Bright"), view.value("Contrast")))


@translator("ShaderNodeRGBToBW")
def rgb_to_bw(view: NodeView) -> Value:
    return working_space.luminance(view.program, view.value("Color"))


def _warn_of_gamut(view: NodeView) -> None:
    """Warns that colours outside of Rec. 709 are cut off, where Cycles can show them."""
    if working_space.current() is not None:
        view.warn_replaced("has only colours of Rec. 709, while the working space has more")


_REDDEST_OF_REC709 = 2000.0
"""Temperature in kelvin below which the colour of a black body lies outside of Rec. 709."""


@translator("ShaderNodeBlackbody")
def blackbody(view: NodeView) -> Value:
    temperature = view.value("Temperature")
    if not (temperature.is_constant and temperature.constant[0] >= _REDDEST_OF_REC709):
        _warn_of_gamut(view)
    return working_space.from_rec709(view.program, view.add(Op.BLACKBODY, (temperature,)))


@translator("ShaderNodeWavelength")
def wavelength(view: NodeView) -> Value:
    _warn_of_gamut(view)
    return working_space.from_rec709(view.program, view.add(Op.WAVELENGTH, (view.value("Wavelength"),)))


def _separate(view: NodeView, source: Value, mode: int, outputs: tuple[str, ...]) -> Value:
    return view.add_float(Op.SEPARATE, (source,), mode, output=outputs.index(view.output))


@translator("ShaderNodeSeparateColor")
def separate_color(view: NodeView) -> Value:
    return _separate(view, view.value("Color"), ColorModel[view.node.mode], ("Red", "Green", "Blue"))


@translator("ShaderNodeCombineColor")
def combine_color(view: NodeView) -> Value:
    inputs = (view.value("Red"), view.value("Green"), view.value("Blue"))
    return view.add(Op.COMBINE, inputs, ColorModel[view.node.mode])


@translator("ShaderNodeSeparateRGB")
def separate_rgb(view: NodeView) -> Value:
    return _separate(view, view.value("Image"), ColorModel.RGB, ("R", "G", "B"))


@translator("ShaderNodeCombineRGB")
def combine_rgb(view: NodeView) -> Value:
    return view.add(Op.COMBINE, (view.value("R"), view.value("G"), view.value("B")), ColorModel.RGB)


@translator("ShaderNodeSeparateHSV")
def separate_hsv(view: NodeView) -> Value:
    return _separate(view, view.value("Color"), ColorModel.HSV, ("H", "S", "V"))


@translator("ShaderNodeCombineHSV")
def combine_hsv(view: NodeView) -> Value:
    return view.add(Op.COMBINE, (view.value("H"), view.value("S"), view.value("V")), ColorModel.HSV)
