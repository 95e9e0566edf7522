"""Faults in light passes that are made consistent with a reconstructed image."""

from __future__ import annotations

from fault import Fault, native

PARTITION = "native/src/reconstruct/picture_terms.cpp"
LIGHT_PASSES = "native/src/output/light_passes.cpp"
FRAME = "native/src/api/film.cpp"

APART = "light passes inconsistent with the image"

LIGHT = (
    Fault(
        32,
        APART,
        "the difference to the image is not distributed",
        PARTITION,
        "        distribute(whole.row(y, c)[x], shares);\n",
        "        if (x < 0) distribute(whole.row(y, c)[x], shares);\n",
        (
            native("Reconstructions/LightPassesBy.*"),
            native("Reconstructions/SequenceLightPasses.*"),
            native("Partition.AddsUp*"),
        ),
    ),
    Fault(
        32,
        APART,
        "the difference to the image is distributed equally",
        PARTITION,
        "{ return share.weight; }",
        "{ return share.weight > 0.0 ? 1.0 : 0.0; }",
        (native("Partition.WhatLacksGoesToTheUncertainParts"),),
    ),
    Fault(
        32,
        APART,
        "light passes fall below 0",
        PARTITION,
        "std::max(wanted, share.minimum)",
        "wanted",
        (native("Partition.NoPartGoesBelowZeroWhileAnotherHasLight"),),
    ),
    Fault(
        32,
        APART,
        "light remains where there is no colour",
        PARTITION,
        "if (room == 0.0) {",
        "if (room < 0.0) {",
        (
            native("Partition.LightGoesWhereItCanBe"),
            native("Reconstructions/LightPassesBy.LightBesideBlackIsNotLost/*"),
        ),
    ),
    Fault(
        32,
        APART,
        "light passes deviate by more than the noise of their samples",
        PARTITION,
        "  limit_by_noise(sampled.half_difference, &term.error);\n",
        "  if (term.may_be_negative) limit_by_noise(sampled.half_difference, &term.error);\n",
        (native("Partition.NoPartIsWrongByMoreThanItsSamples"),),
    ),
    Fault(
        32,
        APART,
        "squares of strong light overflow to infinity",
        PARTITION,
        "std::min(scale * (scale * value), kMaxFloat)",
        "scale * scale * value",
        (native("Partition.LightOfAnyStrengthStaysFinite"),),
    ),
    Fault(
        32,
        APART,
        "light passes lack the exposure",
        LIGHT_PASSES,
        ", film.settings.film_exposure);",
        ");",
        (native("LightPasses.AreExposedAsThePictureIs"),),
    ),
    Fault(
        32,
        APART,
        "light passes of a stored frame belong to its first reconstruction",
        FRAME,
        "film->components.size() > 1))\n    object->developed = kept;",
        "film->components.size() > 1) && !object->developed)\n    object->developed = kept;",
        (native("FrameLightPasses.FollowTheLastReconstruction"),),
    ),
)
