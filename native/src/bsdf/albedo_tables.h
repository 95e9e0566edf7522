// Directional albedos of single-scattering GGX interfaces. The tables are computed once for each process at their first
// use; the glass tables are computed one IOR at a time, in 10 ms each.
#pragma once

namespace gradus::bsdf {

// Integrals of 1, (1−c)^5 and c(1−c)^6 over the cosine-weighted reflection lobe without Fresnel term, where c is the
// cosine at the half-vector. The albedo of a Schlick or F82 lobe is linear in them.
struct GgxMoments {
  float one;
  float schlick;
  float f82;
};
// Returns the moments for `alpha` in [0, 1] and the cosine of wo in [0, 1].
GgxMoments ggx_moments(float alpha, float cosine);
// Returns the mean of GgxMoments::one over the cosine-weighted hemisphere.
float ggx_mean_albedo(float alpha);

// Albedos of a rough dielectric interface.
struct GlassAlbedo {
  float reflected;
  float transmitted;
  float crossing;  // transmitted share if the Fresnel term were 0 except under total reflection
};
// Returns the albedos for `alpha` and the cosine of wo in [0, 1]. `eta` is the positive IOR of the far side divided by
// that of the near side.
GlassAlbedo glass_albedo(float alpha, float cosine, float eta);
// Returns the mean of GlassAlbedo::reflected + transmitted over the cosine-weighted hemisphere.
float glass_mean_albedo(float alpha, float eta);

}  // namespace gradus::bsdf
