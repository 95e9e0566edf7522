"""Faults in animations: replays, correspondence, differences over time, windows, stored frames and the add-on."""

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


REPLAY = "wrong random numbers replayed"
LINK = "wrong pixel correspondence"
CUT = "shot change not found"
DIFFERENCE = "wrong difference over time"
HALVES = "fresh and replayed samples mixed"
WINDOWS = "wrong temporal windows"
STORE = "wrong stored frame"
CHANGE = "wrong change over time"
HOST = "wrong frame in Blender"

SEQUENCES = (
    Fault(
        23,
        REPLAY,
        "a replay takes the numbers of the frame's own seed",
        PIXELS,
        "return stream_of_pixel(context, unit, film.region.x0",
        "return stream_of_pixel(context, WorkUnit{unit.tile}, film.region.x0",
        OF_REPLAYS,
    ),
    Fault(
        23,
        REPLAY,
        "pixel blocks take the jitter of the frame's own seed",
        PIXELS,
        "stream_of_pixel(context, unit, block.x0, block.y0)",
        "stream_of_pixel(context, WorkUnit{unit.tile}, block.x0, block.y0)",
        OF_REPLAYS,
    ),
    Fault(
        23,
        REPLAY,
        "a replay takes the numbers of the same pixel, even where the scene moves",
        PIXELS,
        "film.region.x0 + pixel % width, film.region.y0 + pixel / width)",
        "pixel < 0 ? width : x, y)",
        (native("Replay.MakesDifferencesOverTimeQuieter"),),
    ),
    Fault(
        23,
        REPLAY,
        "pixels of a border are counted from the corner of the film",
        PIXELS,
        "film.region.x0 + pixel % width",
        "pixel % width",
        (native("Replay.OfABorderTakesTheNumbersOfItsOwnPixels"),),
    ),
    Fault(
        23,
        REPLAY,
        "a disocclusion takes the frame's own numbers a second time",
        PIXELS,
        "return {path::StreamKind::Disocclusion, x, y, context.settings.frame, context.settings.seed};",
        "return stream_of_pixel(context, WorkUnit{unit.tile}, x, y);",
        (native("Replay.HolesHaveNumbersOfTheirOwn"),),
    ),
    Fault(
        23,
        REPLAY,
        "a replay takes the mean sample count in place of that of the replayed pixel",
        REPLAY_PLAN,
        "if (source != film::kNoCorrespondence) counts[i] = before->counts[size_t(source)];",
        "if (source < film::kNoCorrespondence) counts[i] = before->counts[size_t(source)];",
        (native("A8_Sequence.ReplaysTakeTheCountsOfWhatTheyReplay"),),
    ),
    Fault(
        24,
        LINK,
        "two pixels correspond to one",
        LINKS,
        "    if (!nearest) correspondence[i] = film::kNoCorrespondence;\n",
        "",
        (native("CorrespondingFrames.ShrinkingIsOneToOne"),),
    ),
    Fault(
        24,
        LINK,
        "of two pixels that meet in one, the farther is kept",
        LINKS,
        "distances[i] < distances[size_t(other)]",
        "distances[i] > distances[size_t(other)]",
        (native("CorrespondingFrames.OfTwoThatMeetInAPixelTheNearestHasIt"),),
    ),
    Fault(
        24,
        LINK,
        "correspondence need not lead back to the pixel",
        LINKS,
        "if (next == film::kNoCorrespondence || !returns(back, from, i, next)) return;",
        "if (next == film::kNoCorrespondence || (i > correspondence.size() && !returns(back, from, i, next))) return;",
        (native("CorrespondingFrames.WhatAppearsHasNoPartner"),),
    ),
    Fault(
        24,
        LINK,
        "a mesh with other triangles is taken for the same mesh",
        MOTION,
        "if (from.instances[i].mesh->topology_hash !=",
        "if (false && from.instances[i].mesh->topology_hash !=",
        (native("CorrespondingFrames.WhatVanishesOrBecomesAnotherMeshHasNoPartner"),),
    ),
    Fault(
        24,
        LINK,
        "objects are matched by index, not by identity",
        MOTION,
        "matches.push_back(found != by_id.end() ? found->second : kNoInstance);",
        "matches.push_back(uint32_t(std::min(matches.size(), to.instances.size() - 1)));",
        (animation("c6_correspondences_remain"),),
    ),
    Fault(
        24,
        LINK,
        "the correspondence is that of the next frame to this one",
        TEMPORAL_FRAME,
        "follows && !is_repeated(frame, next) ? motion::inverse_correspondence(replayed.correspondence)\n"
        "                                              : film::PixelCorrespondence{std::move(pixel)}",
        "follows && !is_repeated(frame, next) ? replayed.correspondence : film::PixelCorrespondence{std::move(pixel)}",
        (native("FiveFrames.LinksAreThoseThatTheNextFrameHasFollowed"),),
    ),
    Fault(
        24,
        LINK,
        "inverse correspondence ends in the centres of pixels",
        LINKS,
        "    if (!correspondence.off_centre.empty()) inverse.off_centre[end] = correspondence.off_centre[i];\n",
        "",
        (native("CorrespondingFrames.KeepWhereTheirWaysEndInBothDirections"),),
    ),
    Fault(
        24,
        LINK,
        "the effect of rounded displacements is left out of the regressed change",
        REGRESS_CHANGE,
        ") + rounding.row(y, c)[x];",
        ") + 0.0f * rounding.row(y, c)[x];",
        (native("B2_RoundedDisplacements.AreInTheRegressedChange"),),
    ),
    Fault(
        24,
        LINK,
        "the effect of rounded displacements is included where no change was sampled",
        REGRESS_CHANGE,
        "  keep_sampled_share(change.image.mean, rounding);\n",
        "",
        (native("B2_RoundedDisplacements.AreNotInAChangeThatWasNotSampled"),),
    ),
    Fault(
        25,
        CUT,
        "a shot change is not detected between frames",
        REPLAY_PLAN,
        " && !motion::is_shot_change(before->snapshot->camera, now.camera)",
        "",
        (native("C8_Sequence.ACutSeparatesWhatLiesBeforeAndAfter"),),
    ),
    Fault(
        25,
        CUT,
        "a zoom is not a shot change",
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
        "windows extend over a skipped frame",
        SEQUENCE,
        "passed_by_.insert(settings.frame);",
        "passed_by_.erase(settings.frame);",
        (native("C8_Sequence.WindowsEndBeforeAFrameThatIsPassedByAndBeginAnewAfterIt"),),
    ),
    Fault(
        26,
        DIFFERENCE,
        "the difference has the wrong sign",
        FRAME_WINDOW,
        "next[size_t(link) * channels + c] - fresh[i * channels + c]",
        "fresh[i * channels + c] - next[size_t(link) * channels + c]",
        OF_ROWS,
    ),
    Fault(
        26,
        DIFFERENCE,
        "the difference takes the next frame's fresh samples, which are independent",
        FRAME_WINDOW,
        "plane_of(frames_[size_t(t) + 1]->replay.*part, kind)",
        "plane_of(frames_[size_t(t) + 1]->fresh.*part, kind)",
        OF_ROWS,
    ),
    Fault(
        26,
        DIFFERENCE,
        "the difference is that of the pixel itself, not of the corresponding pixel",
        FRAME_WINDOW,
        "next[size_t(link) * channels + c]",
        "next[i * channels + c]",
        OF_ROWS,
    ),
    Fault(
        26,
        DIFFERENCE,
        "an unchanged frame is not recognised as a repetition",
        REPEATED,
        "return next.stream == frame.stream && next.scene_key",
        "return next.stream == frame.stream + 1 && next.scene_key",
        (native("FiveFrames.LinksAreThoseThatTheNextFrameHasFollowed"),),
    ),
    Fault(
        27,
        HALVES,
        "differences over time take the fresh samples of the next frame",
        MAKER,
        "folder.load(next, FrameSamples::kReplayed, film_io::StoredContent::kSamples, is_cancelled_)",
        "folder.load(next, FrameSamples::kFresh, film_io::StoredContent::kSamples, is_cancelled_)",
        (native("Sequence.GradientTLeadsToTheNextFrame"),),
    ),
    Fault(
        27,
        HALVES,
        "windows read the fresh samples alone",
        FRAME_WINDOW,
        "return fresh + share * (replay - fresh);",
        "return fresh + 0.0f * share * (replay - fresh);",
        (native("TwoFrames.RowsInSpaceAreMeansOverAllSamples"),),
    ),
    Fault(
        27,
        HALVES,
        "passes read the fresh samples alone",
        SEQUENCE,
        "  render::add_sums(fresh, replayed);\n",
        "",
        (native("C3_Sequence.DeliversEveryFrameFromFirstToLast"),),
    ),
    Fault(
        27,
        HALVES,
        "fresh and replayed samples have equal shares, whatever their counts",
        TEMPORAL_FRAME,
        "own + other > 0.0f ? other / (own + other) : 0.0f",
        "own + other > 0.0f ? 0.5f : 0.0f",
        OF_SHARES,
    ),
    Fault(
        28,
        WINDOWS,
        "the shares of windows in a frame do not sum to 1",
        GRID,
        "begins ? s * s : 1.0f - s * s",
        "begins ? s * s : 1.0f - s",
        (native("B2_Windows.SharesOfAFrameAddUpToOne"),),
    ),
    Fault(
        28,
        WINDOWS,
        "the grid of windows begins at the first frame of the job",
        SEQUENCE,
        "return int(from_first / step + (first >= 0 ? first / step : -((step - 1 - first) / step)));",
        "return int(from_first / step + 0 * first);",
        (native("C7_Sequence.APartBesideStoredFramesHasThePicturesOfTheWhole"),),
    ),
    Fault(
        28,
        WINDOWS,
        "the last window replaces the others in a frame",
        BLEND,
        "reconstruct::add(begun->second, &picture);",
        "reconstruct::add(picture, &begun->second);\n    scale(&picture, 1.0f / share);",
        (native("B2_Windows.OverlapsAreBlended"),),
    ),
    Fault(
        28,
        WINDOWS,
        "half-buffer differences are read as values",
        SPOOLED,
        "rows.read_half_differences(kind, 0, y, row.data());",
        "rows.read_row(kind, 0, y, row.data());",
        (native("FiveFrames.SpooledRowsAreThoseOfTheFramesInMemory"),),
    ),
    Fault(
        29,
        STORE,
        "a stored frame of other settings is accepted",
        STORED_HALF,
        "if (schema::sampling_key(other) != schema::sampling_key(settings))\n    return",
        "if (schema::sampling_key(other) == 0)\n    return",
        OF_SETTINGS,
    ),
    Fault(
        29,
        STORE,
        "a stored frame of another scene is accepted",
        STORED_HALF,
        "if (stored.scene_key != scene_key)",
        "if (stored.scene_key != scene_key && scene_key == 0)",
        OF_SETTINGS,
    ),
    Fault(
        29,
        STORE,
        "a stored neighbour of another job is accepted",
        SEQUENCE,
        "(one_job || are_equivalent(before.settings, here.settings))",
        "(one_job || are_equivalent(before.settings, before.settings))",
        (native("C7_Sequence.NeighboursOfAnotherJobAreLeftOut"),),
    ),
    Fault(
        29,
        STORE,
        "a stored frame with too few samples is accepted",
        SAMPLING,
        "stored_fresh_ && !has_as_many(*stored_fresh_, FrameSamples::kFresh, input_.settings)",
        "stored_fresh_ && input_.settings.samples == 0",
        (native("C7_Sequence.MoreSamplesAreAddedToStoredFrames"),),
    ),
    Fault(
        29,
        STORE,
        "the temporary file of a stored frame remains",
        FILE_WRITER,
        "rename(temporary_.c_str(), path_.c_str()) != 0",
        "(unlink(path_.c_str()), link(temporary_.c_str(), path_.c_str())) != 0",
        (native("C7_Sequence.TwoJobsOnTheSameFramesMakeTheSameBits"),),
    ),
    Fault(
        29,
        STORE,
        "a stored frame gets its name before it is complete",
        FILE_WRITER,
        "  temporary_ = part.name;\n",
        "  rename(part.name.c_str(), path.c_str());\n  temporary_ = path;\n",
        (native("F6_Store.KilledAtAnyMomentLeavesAWholeFileOrNone"),),
    ),
    Fault(
        30,
        CHANGE,
        "the change is that of the frame before",
        REGULARIZED,
        "= differences_(frame, cancel);",
        "= differences_(frame > 0 ? frame - 1 : 0, cancel);",
        OF_REGULARIZED,
    ),
    Fault(
        30,
        CHANGE,
        "the change is 0 and only the correspondence is used",
        TRACKS,
        "return channel < step.difference.channels() ? step.difference.row(y, channel) : zeros.data();",
        "return channel < 0 ? step.difference.row(y, channel) : zeros.data();",
        (native("B2_Tracks.EqualTheDenseSolution"), *OF_REGULARIZED),
    ),
    Fault(
        30,
        CHANGE,
        "a change that contradicts the images keeps its full weight",
        REGULARIZED,
        "return excess > 0.0f ?",
        "return excess < 0.0f ?",
        (native("C5_RegularizedWindow.AChangeThatNobodySampledLeavesNoGhost"),),
    ),
    Fault(
        31,
        HOST,
        "a failure also ends the frames before it",
        ANIMATION,
        "if self._fault is not None and self._fault[0] <= frame:",
        "if self._fault is not None:",
        (animation("i2_a_fault_waits and raise_in_export"),),
    ),
    Fault(
        31,
        HOST,
        "the scene stays at the last sampled frame",
        ANIMATION,
        "    finally:\n        go_to(own)\n",
        "    finally:\n        pass\n",
        (animation("files_of_frames_are_saved"),),
    ),
    Fault(
        31,
        HOST,
        "stored frames of neighbouring jobs are not linked",
        ANIMATION,
        "                if self._has_folder and begins:\n",
        "                if self._has_folder and not begins:\n",
        (animation("c7_parts"),),
    ),
)
