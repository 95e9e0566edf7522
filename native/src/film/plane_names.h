// The names of a film's own planes in stored films (film/planes.cpp), with those of their parts and fields: names that
// channels cannot have (film/channel.cpp).
#pragma once

#include <string_view>

namespace gradus::film::plane_names {

inline constexpr const char* kHalfNames[] = {"A", "B"};
inline constexpr const char* kOffsetNames[] = {"right", "up", "left", "down"};
inline constexpr const char* kCount = "count";
inline constexpr const char* kCorrespondence = "correspondence";

inline constexpr const char* kComponentPrefix = "component";  // a number follows
inline constexpr const char* kWeightSuffix = ".weight";       // follows the name of a channel

// Parts.
inline constexpr const char* kSamples = "samples";
inline constexpr const char* kCounts = "counts";
inline constexpr const char* kPairs = "pairs";
inline constexpr const char* kGradients = "gradients";
inline constexpr const char* kNonSpecular = "non_specular";
inline constexpr const char* kDetails = "details";
inline constexpr const char* kMotion = "motion";
inline constexpr const char* kPasses = "passes";

// Fields of the first non-specular vertices. Together with kSamples they stand in half-buffers, as channels do.
inline constexpr const char* kReflectance = "reflectance";
inline constexpr const char* kNormal = "normal";
inline constexpr const char* kInverseDepth = "inverse_depth";

// Names in stored films of the formats up to 11 (PlaneNames::kOlder).
inline constexpr const char* kOldCorrespondence = "source";
inline constexpr const char* kOldNonSpecular = "rough";

// Names that a channel would share with a plane or a part, before the first dot.
inline constexpr std::string_view kReserved[] = {
    kHalfNames[0], kHalfNames[1],      kOffsetNames[0], kOffsetNames[1], kOffsetNames[2], kOffsetNames[3],
    kCount,        kCorrespondence,    kSamples,        kCounts,         kPairs,          kGradients,
    kNonSpecular,  kDetails,           kMotion,         kPasses,         kReflectance,    kNormal,
    kInverseDepth, kOldCorrespondence, kOldNonSpecular};

}  // namespace gradus::film::plane_names
