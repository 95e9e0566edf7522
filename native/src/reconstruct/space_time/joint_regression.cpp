#include "reconstruct/space_time/joint_regression.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/fault.h"
#include "reconstruct/regularized.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {
void JointRegression::read(int number, const CancelCheck& cancel) {
  if (frames_.count(number) > 0) return;
  FrameStep step = open_step_(number, cancel);
  const auto before = frames_.find(number - 1);
  const bool repeats = before != frames_.end() && before->second.stream == step.stream;
  auto records = repeats ? before->second.records
                         : std::make_shared<const FrameRecords>(read_records(*open_film_(number, cancel)));
  // The correspondence of a frame that is repeated is not read.
  film::PixelCorrespondence to_previous = repeats ? film::PixelCorrespondence{} : std::move(step.to_previous);
  if (!to_previous.empty() && to_previous.pixel.size() != records->pixels.size())
    throw invalid_operation("the pixel correspondence of a frame has another size than its film");
  frames_.emplace(number, Frame{step.stream, std::move(to_previous), std::move(records)});
}

bool JointRegression::is_repeated(int number) const {
  const auto before = frames_.find(number - 1);
  return before != frames_.end() && before->second.stream == frames_.at(number).stream;
}

std::vector<JoinedFrame> JointRegression::move_frames(int number, const HalvedImage& image,
                                                      const std::vector<int>& numbers,
                                                      const CancelCheck& cancel) const {
  std::vector<JoinedFrame> moved;
  const FrameRecords& here = *frames_.at(number).records;
  const ComparedPicture picture =
      compared_picture(here, regress_coarsely({features_of(here), plane_of(here, kRecordWeight)}, image, cancel));
  const auto move = [&](int other, const PixelTrack& track) {
    if (!std::binary_search(numbers.begin(), numbers.end(), other) || cancel()) return;
    const FrameRecords& records = *frames_.at(GRADUS_FAULT(samples_of_another_frame) ? number : other).records;
    if (!is_comparable(records, here)) return;
    moved.push_back({other, &records, move_samples(records, track, picture)});
  };
  PixelTrack track = own_pixels(here.width, here.height);
  for (int other = number - 1; other >= numbers.front(); --other) {
    if (!is_repeated(other + 1)) track = extended(track, frames_.at(other + 1).to_previous, here);
    move(other, track);
  }
  // The sums are in one order, whichever of several repeated frames the picture is.
  std::reverse(moved.begin(), moved.end());
  track = own_pixels(here.width, here.height);
  // Inverse correspondences are computed for each picture. Holding them would take 12 bytes per pixel and frame.
  for (int other = number + 1; other <= numbers.back(); ++other) {
    if (!is_repeated(other)) track = extended(track, inverse(frames_.at(other).to_previous), here);
    move(other, track);
  }
  return moved;
}

Reconstructed JointRegression::reconstruct(int number, const FrameRange& around, const CancelCheck& cancel,
                                           SolveReport* report, const JoinedOutputs& wanted) {
  if (!memory_) memory_.emplace();
  frames_.erase(frames_.begin(), frames_.lower_bound(around.first));
  for (int other = around.first; other <= around.last && !cancel(); ++other) read(other, cancel);
  if (cancel()) return {};
  // Frames that are repeated have the same samples.
  std::set<int32_t> streams{frames_.at(number).stream};
  std::vector<int> numbers;
  for (int distance = 1; distance < around.count(); ++distance) {
    for (const int other : {number - distance, number + distance}) {
      if (around.contains(other) && streams.insert(frames_.at(other).stream).second) numbers.push_back(other);
    }
  }
  // Repeated frames sum the others in one order.
  std::sort(numbers.begin(), numbers.end());
  const FrameRecords& here = *frames_.at(number).records;
  if (numbers.empty()) {
    return regularize(*open_film_(number, cancel), wanted.components, cancel, report, ErrorUse::Delivered);
  }
  HalvedImage image = image_of(here);
  const JoinedSamples joined(here, move_frames(number, image, numbers, cancel));
  if (cancel()) return {};
  film::Features features;
  PictureSamples samples = joined.picture(image, &features);
  const std::shared_ptr<const film::Film> film = here.has_differences ? open_film_(number, cancel) : nullptr;
  Reconstructed result =
      regularize(film.get(),
                 {here.scale, std::move(image), std::move(samples),
                  [&](int component, int first, const Field& own) { return joined.join(component, first, own); },
                  components_of(here), wanted.components},
                 cancel, report);
  if (wanted.sampled) {
    const Field regressed = colors_of(result.image, here.width, here.height);
    result.sampled = std::make_shared<const SampledPicture>(joined.sampled(std::move(features), regressed));
  }
  if (wanted.terms) {
    const auto read_terms = [&](int other) { return wanted.terms(*open_film_(other, cancel)); };
    result.sampled_terms = std::make_shared<const SampledTerms>(joined.sampled(read_terms(number), read_terms));
  }
  return result;
}

}  // namespace gradus::reconstruct
