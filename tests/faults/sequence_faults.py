"""Faults in animations: replays, links, differences over time, windows, stored frames, and what Blender gets of them."""

from __future__ import annotations

from fault import Fault, Test, native

SAMPLING = "native/src/animation/frame_sampling.cpp"
REPLAY_PLAN = "native/src/animation/replay_plan.cpp"
STORED_HALF = "native/src/animation/stored_samples.cpp"
RECORD = "native/src/animation/frame_record.cpp"
SEQUENCE = "native/src/animation/sequence.cpp"
FILE_WRITER = "native/src/film_io/file_writer.cpp"
PIXELS = "native/src/integrator/pixel_loop.cpp"
LINKS = "native/src/motion/pixel_matching.cpp"
REGRESS_CHANGE = "native/src/reconstruct/space_time/regress_change.cpp"
TEMPORAL_FRAME = "native/src/animation/temporal_frame.cpp"
REPEATED = "native/src/animation/temporal_frame.h"
MAKER = "native/src/animation/frame_developer.cpp"
FRAME_WINDOW = "native/src/animation/frame_window.cpp"
SPOOLED = "native/src/animation/spooled_frame.cpp"
MOTION = "native/src/motion/snapshot_motion.cpp"
GRID = "native/src/reconstruct/space_time/window_grid.cpp"
BLEND = "native/src/reconstruct/space_time/window_blend.cpp"
REGULARIZED = "native/src/reconstruct/space_time/regularized_windows.cpp"
TRACKS = "native/src/reconstruct/space_time/solve_tracks.cpp"
ANIMATION = "addon/gradus/animation.py"

OF_REPLAYS = (native("*Replays.OfAStillSceneHaveTheBitsOfTheFrameBefore*"),)
OF_SHARES = (native("FiveFrames.SharesAreThoseOfTheSamples"),)
OF_ROWS = (native("TwoFrames.RowsInTimeAreDifferencesAlongTheLinks"),)
OF_REGULARIZED = (native("C5_RegularizedWindow.ALampThatIsSwitchedShowsAtOnce"),)
OF_SETTINGS = (native("C7_Sequence.FramesOfOtherSettingsOrScenesAreRefusedByName"),)


def animation(choice: str) -> Test:
    return Test("tests/addon/temporal_animation_test.py", choice)


REPLAY = "wrong numbers replayed"
LINK = "wrong links"
CUT = "cut not found"
DIFFERENCE = "wrong difference over time"
HALVES = "halves of a frame mixed"
WINDOWS = "wrong windows"
STORE = "wrong stored frame"
CHANGE = "wrong change over time"
HOST = "wrong frame in the host"

SEQUENCES = (
    Fault(
        23,
        REPLAY,
        "those of the frame's own seed",
        PIXELS,
        "return numbers_of(context, unit, film.region.x0",
        "return numbers_of(context, WorkUnit{unit.tile}, film.region.x0",
        OF_REPLAYS,
    ),
    Fault(
        23,
        REPLAY,
        "cells have the jitter of the frame's own seed",
        PIXELS,
        "numbers_of(context, unit, block.x0, block.y0)",
        "numbers_of(context, WorkUnit{unit.tile}, block.x0, block.y0)",
        OF_REPLAYS,
    ),
    Fault(
        23,
        REPLAY,
        "those of the same pixel, whatever moves",
        PIXELS,
        "film.region.x0 + pixel % width, film.region.y0 + pixel / width)",
        "pixel < 0 ? width : x, y)",
        (native("Replay.MakesDifferencesOverTimeQuieter"),),
    ),
    Fault(
        23,
        REPLAY,
        "pixels of a border are counted from the film's corner",
        PIXELS,
        "film.region.x0 + pixel % width",
        "pixel % width",
        (native("Replay.OfABorderTakesTheNumbersOfItsOwnPixels"),),
    ),
    Fault(
        23,
        REPLAY,
        "a hole is not tagged: it has the frame's own numbers twice",
        PIXELS,
        "return {path::StreamKind::Disocclusion, x, y, context.settings.frame, context.settings.seed};",
        "return numbers_of(context, WorkUnit{unit.tile}, x, y);",
        (native("Replay.HolesHaveNumbersOfTheirOwn"),),
    ),
    Fault(
        23,
        REPLAY,
        "as many as the frame's mean, not as the frame before has taken",
        REPLAY_PLAN,
        "if (source != film::kNoCorrespondence) counts[i] = before->counts[size_t(source)];",
        "if (source < film::kNoCorrespondence) counts[i] = before->counts[size_t(source)];",
        (native("A8_Sequence.ReplaysTakeTheCountsOfWhatTheyReplay"),),
    ),
    Fault(
        24,
        LINK,
        "two pixels lead to one",
        LINKS,
        "    if (!nearest) correspondence[i] = film::kNoCorrespondence;\n",
        "",
        (native("CorrespondingFrames.ShrinkingIsOneToOne"),),
    ),
    Fault(
        24,
        LINK,
        "the farthest of two has the pixel",
        LINKS,
        "distances[i] < distances[size_t(other)]",
        "distances[i] > distances[size_t(other)]",
        (native("CorrespondingFrames.OfTwoThatMeetInAPixelTheNearestHasIt"),),
    ),
    Fault(
        24,
        LINK,
        "they need not lead back",
        LINKS,
        "if (next == film::kNoCorrespondence || !returns(back, from, i, next)) return;",
        "if (next == film::kNoCorrespondence || (i > correspondence.size() && !returns(back, from, i, next))) return;",
        (native("CorrespondingFrames.WhatAppearsHasNoPartner"),),
    ),
    Fault(
        24,
        LINK,
        "a mesh of other triangles is the same",
        MOTION,
        "if (from.instances[i].mesh->topology_hash !=",
        "if (false && from.instances[i].mesh->topology_hash !=",
        (native("CorrespondingFrames.WhatVanishesOrBecomesAnotherMeshHasNoPartner"),),
    ),
    Fault(
        24,
        LINK,
        "objects are counted, not known",
        MOTION,
        "matches.push_back(found != by_id.end() ? found->second : kNoInstance);",
        "matches.push_back(uint32_t(std::min(matches.size(), to.instances.size() - 1)));",
        (animation("c6_correspondences_remain"),),
    ),
    Fault(
        24,
        LINK,
        "from the next frame to this one",
        TEMPORAL_FRAME,
        "follows && !is_repeated(frame, next) ? motion::inverse_correspondence(replayed.correspondence)\n"
        "                                              : film::PixelCorrespondence{std::move(pixel)}",
        "follows && !is_repeated(frame, next) ? replayed.correspondence : film::PixelCorrespondence{std::move(pixel)}",
        (native("FiveFrames.LinksAreThoseThatTheNextFrameHasFollowed"),),
    ),
    Fault(
        24,
        LINK,
        "the other way round they end in the middle of pixels",
        LINKS,
        "    if (!correspondence.off_centre.empty()) inverse.off_centre[end] = correspondence.off_centre[i];\n",
        "",
        (native("CorrespondingFrames.KeepWhereTheirWaysEndInBothDirections"),),
    ),
    Fault(
        24,
        LINK,
        "what their rounding makes is forgotten",
        REGRESS_CHANGE,
        ") + rounding.row(y, c)[x];",
        ") + 0.0f * rounding.row(y, c)[x];",
        (native("B2_RoundedDisplacements.AreInTheRegressedChange"),),
    ),
    Fault(
        24,
        LINK,
        "pictures always go with them",
        REGRESS_CHANGE,
        "  keep_sampled_share(change.image.mean, rounding);\n",
        "",
        (native("B2_RoundedDisplacements.AreNotInAChangeThatWasNotSampled"),),
    ),
    Fault(
        25,
        CUT,
        "all frames are linked",
        REPLAY_PLAN,
        " && !motion::is_shot_change(before->snapshot->camera, now.camera)",
        "",
        (native("C8_Sequence.ACutSeparatesWhatLiesBeforeAndAfter"),),
    ),
    Fault(
        25,
        CUT,
        "a zoom is none",
        LINKS,
        "zoom < kShotChangeZoom && zoom > 1.0f / kShotChangeZoom",
        "zoom > 0.0f * kShotChangeZoom",
        (native("CorrespondingFrames.C8_ACutIsNoMotion"),),
    ),
    Fault(
        25,
        CUT,
        "frames with and without alpha share windows",
        RECORD,
        "return before.region == frame.region && before.channels == frame.channels",
        "return before.region == frame.region",
        (native("C8_Sequence.FramesWithAnotherNumberOfChannelsAreACut"),),
    ),
    Fault(
        25,
        CUT,
        "windows reach over a frame that is passed by",
        SEQUENCE,
        "passed_by_.insert(settings.frame);",
        "passed_by_.erase(settings.frame);",
        (native("C8_Sequence.WindowsEndBeforeAFrameThatIsPassedByAndBeginAnewAfterIt"),),
    ),
    Fault(
        26,
        DIFFERENCE,
        "with the wrong sign",
        FRAME_WINDOW,
        "next[size_t(link) * channels + c] - fresh[i * channels + c]",
        "fresh[i * channels + c] - next[size_t(link) * channels + c]",
        OF_ROWS,
    ),
    Fault(
        26,
        DIFFERENCE,
        "of the next frame's own samples, which are independent",
        FRAME_WINDOW,
        "plane_of(frames_[size_t(t) + 1]->replay.*part, kind)",
        "plane_of(frames_[size_t(t) + 1]->fresh.*part, kind)",
        OF_ROWS,
    ),
    Fault(
        26,
        DIFFERENCE,
        "of the pixel itself, not along its link",
        FRAME_WINDOW,
        "next[size_t(link) * channels + c]",
        "next[i * channels + c]",
        OF_ROWS,
    ),
    Fault(
        26,
        DIFFERENCE,
        "there is none between frames that are alike",
        REPEATED,
        "return next.stream == frame.stream && next.scene_key",
        "return next.stream == frame.stream + 1 && next.scene_key",
        (native("FiveFrames.LinksAreThoseThatTheNextFrameHasFollowed"),),
    ),
    Fault(
        27,
        HALVES,
        "differences over time are those of the next frame's own half",
        MAKER,
        "folder.load(next, FrameSamples::kReplayed, film_io::StoredContent::kSamples, is_cancelled_)",
        "folder.load(next, FrameSamples::kFresh, film_io::StoredContent::kSamples, is_cancelled_)",
        (native("Sequence.GradientTLeadsToTheNextFrame"),),
    ),
    Fault(
        27,
        HALVES,
        "the base alone, in windows",
        FRAME_WINDOW,
        "return fresh + share * (replay - fresh);",
        "return fresh + 0.0f * share * (replay - fresh);",
        (native("TwoFrames.RowsInSpaceAreMeansOverAllSamples"),),
    ),
    Fault(
        27,
        HALVES,
        "the base alone, in passes",
        SEQUENCE,
        "  render::add_sums(fresh, replayed);\n",
        "",
        (native("C3_Sequence.DeliversEveryFrameFromFirstToLast"),),
    ),
    Fault(
        27,
        HALVES,
        "a half each, whatever their samples",
        TEMPORAL_FRAME,
        "own + other > 0.0f ? other / (own + other) : 0.0f",
        "own + other > 0.0f ? 0.5f : 0.0f",
        OF_SHARES,
    ),
    Fault(
        28,
        WINDOWS,
        "their shares do not add up to 1",
        GRID,
        "begins ? s * s : 1.0f - s * s",
        "begins ? s * s : 1.0f - s",
        (native("B2_Windows.SharesOfAFrameAddUpToOne"),),
    ),
    Fault(
        28,
        WINDOWS,
        "the grid begins with the job",
        SEQUENCE,
        "return int(from_first / step + (first >= 0 ? first / step : -((step - 1 - first) / step)));",
        "return int(from_first / step + 0 * first);",
        (native("C7_Sequence.APartBesideStoredFramesHasThePicturesOfTheWhole"),),
    ),
    Fault(
        28,
        WINDOWS,
        "the last one has the frame",
        BLEND,
        "reconstruct::add(begun->second, &picture);",
        "reconstruct::add(picture, &begun->second);\n    scale(&picture, 1.0f / share);",
        (native("B2_Windows.OverlapsAreBlended"),),
    ),
    Fault(
        28,
        WINDOWS,
        "halves' differences are the values",
        SPOOLED,
        "rows.read_half_differences(kind, 0, y, row.data());",
        "rows.read_row(kind, 0, y, row.data());",
        (native("FiveFrames.SpooledRowsAreThoseOfTheFramesInMemory"),),
    ),
    Fault(
        29,
        STORE,
        "of other settings",
        STORED_HALF,
        "if (schema::sampling_key(other) != schema::sampling_key(settings))\n    return",
        "if (schema::sampling_key(other) == 0)\n    return",
        OF_SETTINGS,
    ),
    Fault(
        29,
        STORE,
        "of another scene",
        STORED_HALF,
        "if (stored.scene_key != scene_key)",
        "if (stored.scene_key != scene_key && scene_key == 0)",
        OF_SETTINGS,
    ),
    Fault(
        29,
        STORE,
        "of another job, beside this one's",
        SEQUENCE,
        "(one_job || are_equivalent(before.settings, here.settings))",
        "(one_job || are_equivalent(before.settings, before.settings))",
        (native("C7_Sequence.NeighboursOfAnotherJobAreLeftOut"),),
    ),
    Fault(
        29,
        STORE,
        "with too few samples",
        SAMPLING,
        "stored_fresh_ && !has_as_many(*stored_fresh_, FrameSamples::kFresh, input_.settings)",
        "stored_fresh_ && input_.settings.samples == 0",
        (native("C7_Sequence.MoreSamplesAreAddedToStoredFrames"),),
    ),
    Fault(
        29,
        STORE,
        "its part file stays",
        FILE_WRITER,
        "rename(temporary_.c_str(), path_.c_str()) != 0",
        "(unlink(path_.c_str()), link(temporary_.c_str(), path_.c_str())) != 0",
        (native("C7_Sequence.TwoJobsOnTheSameFramesMakeTheSameBits"),),
    ),
    Fault(
        29,
        STORE,
        "it has its name before it is whole",
        FILE_WRITER,
        "  temporary_ = part.name;\n",
        "  rename(part.name.c_str(), path.c_str());\n  temporary_ = path;\n",
        (native("F6_Store.KilledAtAnyMomentLeavesAWholeFileOrNone"),),
    ),
    Fault(
        30,
        CHANGE,
        "that of the frame before",
        REGULARIZED,
        "= differences_(frame, cancel);",
        "= differences_(frame > 0 ? frame - 1 : 0, cancel);",
        OF_REGULARIZED,
    ),
    Fault(
        30,
        CHANGE,
        "its links alone, and no change",
        TRACKS,
        "return channel < step.difference.channels() ? step.difference.row(y, channel) : zeros.data();",
        "return channel < 0 ? step.difference.row(y, channel) : zeros.data();",
        (native("B2_Tracks.EqualTheDenseSolution"), *OF_REGULARIZED),
    ),
    Fault(
        30,
        CHANGE,
        "what pictures say against it does not count",
        REGULARIZED,
        "return excess > 0.0f ?",
        "return excess < 0.0f ?",
        (native("C5_RegularizedWindow.AChangeThatNobodySampledLeavesNoGhost"),),
    ),
    Fault(
        31,
        HOST,
        "a fault ends the frames before it, too",
        ANIMATION,
        "if self._fault is not None and self._fault[0] <= frame:",
        "if self._fault is not None:",
        (animation("i2_a_fault_waits and raise_in_export"),),
    ),
    Fault(
        31,
        HOST,
        "the scene stays at the last frame that was sampled",
        ANIMATION,
        "    finally:\n        go_to(own)\n",
        "    finally:\n        pass\n",
        (animation("files_of_frames_are_saved"),),
    ),
    Fault(
        31,
        HOST,
        "parts of a job are not linked",
        ANIMATION,
        "                if self._has_folder and begins:\n",
        "                if self._has_folder and not begins:\n",
        (animation("c7_parts"),),
    ),
)
