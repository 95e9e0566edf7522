"""Faults in light passes beside a reconstructed picture: their sum, what it is spread by, and whose picture they are parts of."""

from __future__ import annotations

from fault import Fault, native

PARTITION = "native/src/reconstruct/picture_terms.cpp"
LIGHT_PASSES = "native/src/output/light_passes.cpp"
FRAME = "native/src/api/film.cpp"

APART = "light passes apart"

LIGHT = (
    Fault(
        32,
        APART,
        "what lacks of the picture is left out",
        PARTITION,
        "        distribute(whole.row(y, c)[x], shares);\n",
        "        if (x < 0) distribute(whole.row(y, c)[x], shares);\n",
        (native("Reconstructions/LightPassesBy.*"), native("Reconstructions/SequenceLightPasses.*"), native("Partition.AddsUp*")),
    ),
    Fault(
        32,
        APART,
        "it goes to all alike",
        PARTITION,
        "{ return share.weight; }",
        "{ return share.weight > 0.0 ? 1.0 : 0.0; }",
        (native("Partition.WhatLacksGoesToTheUncertainParts"),),
    ),
    Fault(
        32,
        APART,
        "parts go below 0",
        PARTITION,
        "std::max(wanted, share.minimum)",
        "wanted",
        (native("Partition.NoPartGoesBelowZeroWhileAnotherHasLight"),),
    ),
    Fault(
        32,
        APART,
        "light stays where there is no colour",
        PARTITION,
        "if (room == 0.0) {",
        "if (room < 0.0) {",
        (native("Partition.LightGoesWhereItCanBe"), native("Reconstructions/LightPassesBy.LightBesideBlackIsNotLost/*")),
    ),
    Fault(
        32,
        APART,
        "parts are wrong by more than their samples",
        PARTITION,
        "  limit_by_noise(sampled.half_difference, &term.error);\n",
        "  if (term.may_be_negative) limit_by_noise(sampled.half_difference, &term.error);\n",
        (native("Partition.NoPartIsWrongByMoreThanItsSamples"),),
    ),
    Fault(
        32,
        APART,
        "squares of strong light are infinite",
        PARTITION,
        "std::min(scale * (scale * value), kMaxFloat)",
        "scale * scale * value",
        (native("Partition.LightOfAnyStrengthStaysFinite"),),
    ),
    Fault(
        32,
        APART,
        "they are not exposed",
        LIGHT_PASSES,
        ", film.settings.film_exposure);",
        ");",
        (native("LightPasses.AreExposedAsThePictureIs"),),
    ),
    Fault(
        32,
        APART,
        "those of a stored frame are the first picture's",
        FRAME,
        "film->components.size() > 1))\n    object->developed = kept;",
        "film->components.size() > 1) && !object->developed)\n    object->developed = kept;",
        (native("FrameLightPasses.FollowTheLastReconstruction"),),
    ),
)
