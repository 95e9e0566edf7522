// Finds where the next frame shows what components show through smooth surfaces, and the resulting correspondence of
// pixels.
#pragma once

#include <vector>

#include "film/replay_map.h"
#include "motion/specular_motion.h"

namespace gradus::motion {

// Returns the motion of the components whose bits are set in `wanted`, in order, one value for each pixel of `from`.
// Tracking is NoPath where a component is seen directly or not at all. After cancelling, pixels are NotConverged.
std::vector<ChainMotion> track_components(const CentreView& from, const ChainTracer& to,
                                          const lpe::ComponentSet& components, uint32_t wanted,
                                          const CancelCheck& is_cancelled);
// Returns the motion of what each pixel of `from` mainly shows, as far as the probabilities of scattering classes tell:
// it is seen through mirrors and clear glass (kMaxNonSpecular), by the stronger of reflection and transmission, and
// found in one step in time. Tracking is NoPath elsewhere.
ChainMotion track_dominant(const CentreView& from, const ChainTracer& to, const CancelCheck& is_cancelled);
// Whether the component is seen through smooth surfaces in some pixel.
bool is_seen_through_smooth(const ChainMotion& motion);

// Returns for each pixel the pixel of the next frame in which the component shows the same. It follows specular motion
// where there is a tracked chain of smooth surfaces, and surface motion elsewhere. surface: match_pixels() of the two
// frames over `region`. motion: result of track_components() for the component. The correspondence is one-to-one: a
// pixel to which several chains lead goes to the chain that arrives nearest to its centre, and chains take precedence
// over surfaces.
film::PixelCorrespondence match_component(const film::PixelCorrespondence& surface, const Region& region,
                                          const ChainMotion& motion);
// Gives chains the tracking Occluded that arrive in a pixel which shows other light: its centre does not show the first
// of their smooth surfaces, or that ends there and did not in the pixel from which the chain comes. Such chains are
// those of a mirror that turns, at its edges.
void lose_strayed_chains(const CentreView& from, const CentreView& to, ChainMotion* motion);
// Returns the correspondence of all light of a pixel. motion: result of track_dominant(). Pixels whose chain is tracked
// or occluded never follow the surface, which leads to other light: where several chains lead to one pixel, that would
// be in single columns.
film::PixelCorrespondence match_dominant(film::PixelCorrespondence surface, const Region& region,
                                         const ChainMotion& motion);

}  // namespace gradus::motion
