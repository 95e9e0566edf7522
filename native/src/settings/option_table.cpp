#include "settings/options.h"

namespace gradus {
namespace {

constexpr double kMaxInt = 2147483647.0;
constexpr double kMaxFloat = 3.4e38;
constexpr bool kSampling = true;
constexpr bool kOther = false;

constexpr auto kInt = GRADUS_OPTION_INT;
constexpr auto kFloat = GRADUS_OPTION_FLOAT;
constexpr auto kBool = GRADUS_OPTION_BOOL;
constexpr auto kEnum = GRADUS_OPTION_ENUM;
constexpr auto kText = GRADUS_OPTION_TEXT;

#define OPTION(field, type, value, low, high, choices, sampling, doc) \
  Option { #field, type, offsetof(GradusSettings, field), value, low, high, choices, doc, sampling }

constexpr const char* kIntegrators = "auto path gradient bidirectional metropolis";
constexpr const char* kReconstructions = "auto none l2 weighted l1 regularized";
constexpr const char* kDenoisers = "none auto oidn";
constexpr const char* kFilters = "box gaussian blackman_harris";

// clang-format off
constexpr Option kOptions[] = {
    OPTION(width, kInt, 1920, 1, 65536, "", kSampling, "Width of the full frame in pixels"),
    OPTION(height, kInt, 1080, 1, 65536, "", kSampling, "Height of the full frame in pixels"),
    OPTION(samples, kInt, 64, 1, 16777216, "", kOther, "Samples per pixel, with a noise threshold their average; all offset paths of a base path belong to one sample"),
    OPTION(min_samples, kInt, 0, 0, 16777216, "", kOther, "Least samples per pixel before a tile may stop; 0 = automatic"),
    OPTION(noise_threshold, kFloat, 0.01, 0, kMaxFloat, "", kOther,
           "A tile stops where the estimated relative error of the result is below it, others share samples by their noise; 0 = off. The same number leaves less noise than in Cycles"),
    OPTION(time_limit, kFloat, 0, 0, kMaxFloat, "", kOther,
           "Seconds of sampling, 0 = no limit; the image so far is reconstructed and delivered"),
    OPTION(seed, kInt, 0, 0, kMaxInt, "", kSampling, "Seed of all random values"),
    OPTION(use_animated_seed, kBool, 1, 0, 1, "", kSampling, "Has no effect, kept for scripts: the frame is part of the key either way"),
    OPTION(frame, kInt, 0, -kMaxInt, kMaxInt, "", kSampling, "Number of the frame, part of the key of every random value"),
    OPTION(integrator, kEnum, GRADUS_INTEGRATOR_AUTO, 0, 4, kIntegrators, kSampling,
           "How light is sampled; auto: the planner decides. bidirectional and metropolis are refused until they work"),
    OPTION(reconstruction, kEnum, GRADUS_RECONSTRUCTION_AUTO, 0, 5, kReconstructions, kOther,
           "How the image is reconstructed from samples and gradients; l2 is unbiased; weighted goes by the "
           "measured noise and l1 is robust; regularized (auto) goes by features of the surfaces as well: all consistent"),
    OPTION(reconstruction_alpha, kFloat, 0.0, 0.0, 1e3, "", kOther, "Weight of the primal image against the gradients in l2 and l1, of its means in weighted; 0 = automatic: 0.4 for l2, 0.2 for the others"),
    OPTION(denoiser, kEnum, GRADUS_DENOISER_NONE, 0, 2, kDenoisers, kOther,
           "What takes the rest of the noise out of the result; oidn: the host's Open Image Denoise, an error where there is none; auto: "
           "that where it is there, from 8 samples on. Biased, for stills"),
    OPTION(max_bounces, kInt, 12, 0, 1024, "", kSampling, "Most bounces of a path"),
    OPTION(diffuse_bounces, kInt, 4, 0, 1024, "", kSampling, "Most diffuse bounces of a path"),
    OPTION(glossy_bounces, kInt, 4, 0, 1024, "", kSampling, "Most glossy bounces of a path"),
    OPTION(transmission_bounces, kInt, 12, 0, 1024, "", kSampling, "Most transmission bounces of a path"),
    OPTION(volume_bounces, kInt, 0, 0, 1024, "", kSampling, "Most volume scattering events of a path"),
    OPTION(transparent_max_bounces, kInt, 8, 0, 1024, "", kSampling, "Most transparent surfaces that a ray passes"),
    OPTION(clamp_direct, kFloat, 0, 0, kMaxFloat, "", kSampling, "Largest direct radiance of a sample, 0 = off: clamping is bias"),
    OPTION(clamp_indirect, kFloat, 0, 0, kMaxFloat, "", kSampling, "Largest indirect radiance of a sample, 0 = off: clamping is bias"),
    OPTION(pixel_filter, kEnum, GRADUS_FILTER_BLACKMAN_HARRIS, 0, 2, kFilters, kSampling, "Pixel filter, importance-sampled"),
    OPTION(filter_width, kFloat, 1.5, 0.01, 10, "", kSampling, "Width of the pixel filter in pixels, as in Cycles"),
    OPTION(film_exposure, kFloat, 1, 0, kMaxFloat, "", kOther, "Factor on all radiance that is delivered"),
    OPTION(film_transparent, kBool, 0, 0, 1, "", kSampling, "The world is transparent to the camera; alpha is reconstructed as a fourth channel"),
    OPTION(roughness_threshold, kFloat, 0.1, 0, 1, "", kSampling,
           "Lobes with alpha (roughness squared) below it count as specular reflection or transmission"),
    OPTION(strict, kBool, 0, 0, 1, "", kOther, "What would be left out or replaced with a warning ends the render with an error"),
    OPTION(threads, kInt, 0, 0, 1024, "", kOther, "Threads, 0 = those of the device; the result does not depend on it"),
    OPTION(alpha_threshold, kFloat, 0.5, 0, 1, "", kSampling, "Surfaces with less alpha are skipped by data passes"),
    OPTION(use_sky, kBool, 1, 0, 1, "", kSampling, "The world is seen by the camera"),
    OPTION(independent_sampler, kBool, 0, 0, 1, "", kSampling, "Independent random numbers in place of the Sobol net, for statistical tests"),
    OPTION(use_decomposition, kBool, 0, 0, 1, "", kSampling, "The picture is sampled and reconstructed by components, each with passes of its own"),
    OPTION(components, kText, 0, 0, sizeof(GradusSettings::components) - 1, "", kSampling,
           "Components by path expressions, Name=EXPR;Name=EXPR; empty: Emission, Diffuse, Reflection, Transmission and Residual"),
    OPTION(component_replays, kBool, 1, 0, 1, "", kSampling,
           "In animations, what mirrors and glass show is compared with where it was, not with where they were"),
    OPTION(first_sample, kInt, 0, 0, 16777216, "", kOther, "Number of the first sample, for frames that are merged later"),
};
// clang-format on

}  // namespace

std::span<const Option> options() { return kOptions; }

}  // namespace gradus
