"""The seeded faults (M4), and which tests must catch them: twelve kinds in the renderer, and those in the reconstruction.

A fault is an edit of the sources that compiles and looks harmless. Its old text must be there exactly once, or the tool stops: a fault that
no longer applies proves nothing.
"""

from __future__ import annotations

from fault import Fault, Test, native, statistics
from reconstruction import RECONSTRUCTION

LAMBERT = "native/src/bsdf/lobe.h"
PIXELS = "native/src/integrator/pixel_loop.cpp"
LOOP = "native/src/render/loop.cpp"

RENDERER = (
    Fault(
        1,
        "cosine dropped",
        "Lambert without the cosine of the light",
        LAMBERT,
        "BsdfEval{lobe.weight * pdf, pdf}",
        "BsdfEval{lobe.weight * kInvPi, pdf}",
        (native("A2_WhiteFurnace.Diffuse"), native("A4_Densities.*"), statistics("All/A1_Furnace*")),
    ),
    Fault(
        2,
        "pdf halved",
        "Lambert's density is a half of what is sampled",
        LAMBERT,
        "BsdfEval{lobe.weight * pdf, pdf}",
        "BsdfEval{lobe.weight * pdf, 0.5f * pdf}",
        (native("A3_ChiSquare.Diffuse"), native("A2_WhiteFurnace.Diffuse")),
    ),
    Fault(
        3,
        "1 % darker",
        "every sample loses a hundredth",
        PIXELS,
        "  Radiance value = result.radiance;\n",
        "  Radiance value = 0.99f * result.radiance;\n",
        (statistics("A6_Bias.*"), native("All/B8_Double.*")),
    ),
    Fault(
        4,
        "NaN sample",
        "one sample of 1,000 is no number",
        PIXELS,
        "  Radiance value = result.radiance;\n",
        "  Radiance value = result.radiance;\n  if ((sample.pixel * 31 + sample.number) % 1000 == 0) value.x = kInfinity - kInfinity;\n",
        (Test("stress", "Duplicates.*"),),
    ),
    Fault(
        4,
        "NaN sample",
        "the gate lets it through",
        "native/src/frame/gate.h",
        "inline bool fits(float v) { return std::fabs(v) <= kLargestSum; }",
        "inline bool fits(float v) { return !(std::fabs(v) > kInfinity); }",
        (native("B6_Gate.*"), Test("stress", "NonFinite.*")),
    ),
    Fault(
        5,
        "vector off by one frame",
        "motion is read one frame late",
        "addon/gradus/export/motion.py",
        "            step(offset)\n",
        "            step(offset + 1)\n",
        (Test("tests/addon/vector_render_test.py", "moving_object or camera_pan"),),
    ),
    Fault(
        6,
        "1 MB leak a frame",
        "in the library",
        LOOP,
        "  const GradusSettings& settings = input_.settings;\n",
        "  const GradusSettings& settings = input_.settings;\n  std::fill_n(new char[1 << 20], 1 << 20, char(1));\n",
        (Test("memory", "J1_Growth.*"),),
    ),
    Fault(
        6,
        "1 MB leak a frame",
        "in the add-on",
        "addon/gradus/renderer.py",
        "def render(engine: Any, depsgraph: Any) -> None:\n",
        'kept = []\n\n\ndef render(engine: Any, depsgraph: Any) -> None:\n    kept.append(b"1" * (1 << 20))\n',
        (Test("tests/robustness/memory_test.py", "j1"),),
    ),
    Fault(
        7,
        "swallowed exception",
        "on a thread of the render",
        LOOP,
        "    end(GRADUS_ERROR_UNKNOWN, e.what());\n",
        '    end(GRADUS_OK, "");\n',
        (native("Loop.FailuresOfTheIntegratorBecomeTheOutcome"),),
    ),
    Fault(
        7,
        "swallowed exception",
        "at the boundary of the C API",
        "native/src/api/guard.h",
        "    return record_current_exception();\n",
        "    record_current_exception();\n    return GRADUS_OK;\n",
        (native("G4_Exceptions.*"), native("G1_Handles.Wrong*")),
    ),
    Fault(
        7,
        "swallowed exception",
        "in the engine",
        "addon/gradus/engine.py",
        '            self.report({"ERROR"}, text)\n',
        '            self.report({"WARNING"}, text)\n',
        (Test("tests/robustness/failure_test.py", "injected_failures and sampling"),),
    ),
    Fault(
        8,
        "last row lost",
        "of each cell of pixels",
        "native/src/integrator/pixel_loop.h",
        "for (int32_t y = cell.y0; y < cell.y1; ++y)",
        "for (int32_t y = cell.y0; y < cell.y1 - 1; ++y)",
        (statistics("All/A1_Furnace*"),),
    ),
    Fault(
        8,
        "last row lost",
        "of the delivered picture",
        "native/src/render/pass_read.cpp",
        "  for (int32_t y = region.y0; y < region.y1; ++y) {\n",
        "  for (int32_t y = region.y0; y < region.y1 - 1; ++y) {\n",
        (Test("regression", "M1_Pictures.M2_LookAsStored"),),
    ),
    Fault(
        9,
        "sRGB twice",
        "of byte textures",
        "native/src/scene/image_lookup.cpp",
        "Vec4(table(stored.x), table(stored.y), table(stored.z), stored.w)",
        "Vec4(table(table(stored.x)), table(table(stored.y)), table(table(stored.z)), stored.w)",
        (native("ImageLookup.*"),),
    ),
    Fault(
        10,
        "flipped normal",
        "of meshes that lie in the top level",
        "native/src/scene/surface.cpp",
        "instance.mirrored ? -triangle.plane.normal : triangle.plane.normal",
        "instance.mirrored ? triangle.plane.normal : -triangle.plane.normal",
        (native("SurfacePoint.*:D8_*"),),
    ),
    Fault(
        11,
        "shared random stream",
        "all pixels take the same random numbers",
        PIXELS,
        "static_cast<uint32_t>(y) * context.settings.width + static_cast<uint32_t>(x);",
        "0u * static_cast<uint32_t>(x + y);",
        (statistics("A10_Seeds.*"),),
    ),
    Fault(
        12,
        "missed cancel",
        "between samples",
        "native/src/integrator/pixel_loop.h",
        "if (stop.load(std::memory_order_relaxed)) {",
        "if (stop.load(std::memory_order_relaxed) && number == UINT32_MAX) {",
        (native("K2_Cancel.IntegratorsStopBetweenSamples"),),
    ),
    Fault(
        12,
        "missed cancel",
        "of the whole render",
        "native/src/render/loop.h",
        "void cancel() { stop_.store(true, std::memory_order_relaxed); }",
        "void cancel() { stop_.store(false, std::memory_order_relaxed); }",
        (native("K2_Cancel.EndsWithinAQuarterSecondAndStaysReadable"),),
    ),
)

FAULTS = (*RENDERER, *RECONSTRUCTION)
