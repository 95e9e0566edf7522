// The picture of a film, by any reconstruction.
#pragma once

#include <memory>
#include <vector>

#include "output/developer.h"

namespace gradus::test {

// Returns Combined of a region, RGBA.
inline std::vector<float> reconstructed(std::shared_ptr<const film::Film> film, uint32_t reconstruction,
                                        const Region& region, float alpha = 0.0f) {
  output::DevelopedFilm developed{std::move(film), region, 2, {reconstruction, alpha}};
  output::Developer(2).reconstruct(&developed);
  return *developed.find(GRADUS_PASS_COMBINED);
}

}  // namespace gradus::test
