// What an animation is planned to take of disks, and of memory by its files. tests/memory/animation_test.cpp has its memory.
#include "render/sequence/sequence_needs.h"

#include <gtest/gtest.h>
#include <sys/vfs.h>

#include <filesystem>

#include "frame/pass_planes.h"
#include "render/sequence/sequence_fixture.h"

namespace gradus::test {
namespace {

constexpr uint64_t kTooMuch = uint64_t{1} << 60;

uint64_t room_of(const std::string& folder) { return fs::space(folder).available; }

// A job of nine hours ended at night, when the disk was full.
TEST(PlannedDisks, ThoseThatAreTooSmallAreNamed) {
  const std::string folder = fs::temp_directory_path();
  EXPECT_TRUE(lacking_room({{folder, 0}}).empty());
  EXPECT_TRUE(lacking_room({{folder + "/that/is/not/there", kTooMuch}}).empty()) << "nobody knows";
  const std::vector<std::string> lines = lacking_room({{folder, kTooMuch}});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find(folder), std::string::npos) << lines[0];
  EXPECT_NE(lines[0].find("GiB"), std::string::npos) << lines[0];
}

// Each had room by itself: frames and rows were compared with the same free space, one by one.
TEST(PlannedDisks, WhatLiesOnOneDiskIsAddedUp) {
  const Folder a, b;
  const uint64_t most = room_of(a.path()) / 10 * 6;
  EXPECT_TRUE(lacking_room({{a.path(), most}}).empty());
  EXPECT_TRUE(lacking_room({{b.path(), most}}).empty());
  const std::vector<std::string> lines = lacking_room({{a.path(), most}, {b.path(), most}});
  ASSERT_EQ(lines.size(), 1u);
  for (const Folder* folder : {&a, &b}) EXPECT_NE(lines[0].find(folder->path()), std::string::npos) << lines[0];
}

TEST(PlannedDisks, FramesWithoutAStoreAndRowsAreWhereTemporaryFilesAre) {
  const std::string temporary = fs::temp_directory_path();
  PlannedBytes bytes;
  bytes.frames = 5;
  bytes.temporary = 7;
  EXPECT_EQ(claim_of(bytes, "/store").files, (FolderBytes{{"/store", 5}, {temporary, 7}}));
  EXPECT_EQ(claim_of(bytes, temporary).files, (FolderBytes{{temporary, 12}}));
}

// Where /tmp is memory, frames of an animation filled it, and nothing had counted them.
TEST(PlannedMemory, FilesInMemoryTakeIt) {
  constexpr long kTmpfs = 0x01021994;
  struct statfs status {};
  const std::string memory = "/dev/shm", other = GRADUS_SOURCE_DIR;
  if (statfs(memory.c_str(), &status) != 0 || status.f_type != kTmpfs) GTEST_SKIP() << "no folder here is memory";
  if (statfs(other.c_str(), &status) != 0 || status.f_type == kTmpfs) GTEST_SKIP() << "all folders here are memory";
  EXPECT_EQ(bytes_in_memory({{memory, 5}, {other, 7}}), 5u);
}

// A part of three frames had ten in its windows, with those beside it in the store, and planned for three.
TEST(PlannedMemory, APartOfAStoreHasWholeWindows) {
  Plan plan;
  plan.sampled = {0, 0, 100, 100};
  plan.gradients = true;
  const WindowShape windows;
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    const SequenceMethod method{reconstruction, 0.0f, false};
    const PlannedBytes alone = planned_bytes(plan, method, windows, 3, false), part = planned_bytes(plan, method, windows, 3, true),
                       whole = planned_bytes(plan, method, windows, windows.frames, true);
    EXPECT_GT(part.memory, alone.memory);
    EXPECT_EQ(part.memory, whole.memory);
    EXPECT_EQ(part.temporary, whole.temporary);
    EXPECT_LT(part.frames, whole.frames) << "it writes its own";
  }
}

// Each component has windows of its own, whose pictures wait for their frames, and was planned as if it waited in none.
TEST(PlannedMemory, ComponentsWaitInWindowsOfTheirOwn) {
  Plan plan;
  plan.sampled = {0, 0, 100, 100};
  plan.gradients = true;
  const auto kept = [&](bool with_error) { return planned_bytes(plan, {GRADUS_RECONSTRUCTION_L2, 0.0f, with_error}, {}, 20, false).kept; };
  const uint64_t one = kept(false), one_with_error = kept(true);
  plan.components = ComponentSet::parse("");
  const auto components = uint64_t(plan.components.count()),
             pictures = uint64_t(WindowShape{}.frames) * plan.sampled.area() * 3 * sizeof(float);
  ASSERT_GT(components, 3u);
  EXPECT_EQ(one_with_error, one + pictures);
  EXPECT_EQ(kept(false), one + (components - 1) * pictures);
  EXPECT_EQ(kept(true), one + (2 * components - 1) * pictures);
}

TEST(PlannedMemory, FlowHoldsTheFrameThatIsMadeAhead) {
  Plan plan;
  plan.sampled = {0, 0, 100, 100};
  plan.gradients = true;
  const SequenceMethod method{GRADUS_RECONSTRUCTION_L2, 0.0f, false};
  const auto planned = [&](bool with_flow) { return planned_bytes(plan, method, {}, 20, false, with_flow); };
  EXPECT_EQ(planned(true).memory, planned(false).memory) << "nobody asks for motion";
  plan.component_motion = true;
  const uint64_t frame = frame_bytes_per_pixel(plan.components.count(), true, plan.passes, {.motion = true, .shown = true}) * 10000;
  EXPECT_GT(planned(true).memory, planned(false).memory + frame);
  EXPECT_GE(planned(true).kept, planned(false).kept + frame);
}

// Layers and views of an animation go on side by side, and each was planned as if alone.
TEST(PlannedMemory, SequencesOfOneHostAreAddedUp) {
  Pan pan(1.0f);
  const auto device = two_threads();
  const auto begin = [&](const std::string& folder) {
    const auto sequence = std::make_shared<Sequence>(device, SequenceSettings{1, 5, 1, {}, folder});
    sample(sequence.get(), pan.at(1), settings_of(1));
    return sequence;
  };
  const Folder a, b;
  auto layer = begin(a.path());
  const Claim one = device->claims().sum();
  const auto other = begin(b.path());
  const Claim both = device->claims().sum();
  EXPECT_GT(one.kept, 0u);
  EXPECT_EQ(both.memory, one.memory + one.kept) << "one is at work at a time";
  EXPECT_EQ(both.files.at(a.path()), one.files.at(a.path()));
  EXPECT_EQ(both.files.at(b.path()), one.files.at(a.path()));
  layer.reset();
  EXPECT_EQ(device->claims().sum().memory, one.memory);
}

}  // namespace
}  // namespace gradus::test
