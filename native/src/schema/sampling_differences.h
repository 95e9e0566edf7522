// In what stored samples differ from those that are wanted.
#pragma once

#include <string>

#include "gradus/gradus.h"

namespace gradus::schema {

// "max_bounces is 12, not 4": in which options of the sampling key stored settings differ from those that are wanted;
// "" where they do not.
std::string sampling_differences(const GradusSettings& stored, const GradusSettings& wanted);

}  // namespace gradus::schema
