#include "motion/opencv/flow.h"

#include <cstdio>
#include <exception>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace {

// Minimum width and height in pixels: DIS needs images that are at least as large as its patches at its coarsest scale.
constexpr int kSmallestSide = 32;

int silent(int /*status*/, const char* /*function*/, const char* /*text*/, const char* /*file*/, int /*line*/,
           void* /*user*/) {
  return 0;
}

// Configures OpenCV once; no other code uses this copy of it. OpenCV must not print, and must use one thread, because
// the result of DIS depends on their number.
void set_up() {
  static const bool done = [] {
    cv::redirectError(&silent);
    cv::setNumThreads(1);
    return true;
  }();
  static_cast<void>(done);
}

// Extends an image to the minimum size by repeating its border.
cv::Mat padded(const cv::Mat& image) {
  const int right = std::max(kSmallestSide - image.cols, 0), bottom = std::max(kSmallestSide - image.rows, 0);
  cv::Mat result;
  cv::copyMakeBorder(image, result, 0, bottom, 0, right, cv::BORDER_REPLICATE);
  return result;
}

cv::Mat grey(const float* levels, const GradusFlowImages& images) {
  const cv::Mat given(images.height, images.width, CV_32F, const_cast<float*>(levels));
  cv::Mat result = padded(given);
  cv::min(cv::max(result, 0.0f), 255.0f, result);
  return result;
}

cv::Mat rounded(const cv::Mat& levels) {
  cv::Mat result;
  levels.convertTo(result, CV_8U);
  return result;
}

void estimate(const GradusFlowImages& images, const GradusFlowEffort& effort, float* flow) {
  const cv::Mat from = grey(images.from, images), to = grey(images.to, images);
  cv::Mat given(images.height, images.width, CV_32FC2, flow), found = padded(given);
  cv::DISOpticalFlow::create(effort.preset)->calc(rounded(from), rounded(to), found);
  const auto refinement = cv::VariationalRefinement::create();
  for (int i = 0; i < effort.refinements; ++i) refinement->calc(from, to, found);
  found(cv::Rect(0, 0, images.width, images.height)).copyTo(given);
}

}  // namespace

// OpenCV's archives refer to solvers of linear systems and to OpenGL, which optical flow never calls. The linker
// resolves these symbols to this function.
extern "C" void gradus_flow_left_out() {
  throw cv::Exception(cv::Error::StsNotImplemented, "left out of libgradus_flow", "", "", 0);
}

uint32_t gradus_flow_interface() { return GRADUS_FLOW_INTERFACE; }

const char* gradus_flow_version() { return CV_VERSION; }

int32_t gradus_flow_estimate(const GradusFlowImages* images, const GradusFlowEffort* effort, float* flow, char* error,
                             size_t error_size) {
  try {
    set_up();
    estimate(*images, *effort, flow);
    return 0;
  } catch (const cv::Exception& e) {
    std::snprintf(error, error_size, "%s", e.err.c_str());
  } catch (const std::exception& e) {
    std::snprintf(error, error_size, "%s", e.what());
  } catch (...) {
    std::snprintf(error, error_size, "unknown error");
  }
  return 1;
}
