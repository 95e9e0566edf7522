// Directional albedos of single-scattering GGX interfaces, tabulated once per process: the moments on first use, glass by the indices
// that are asked for (10 ms each).
#pragma once

namespace gradus::bsdf {

// Integrals over the cosine-weighted reflection lobe with white masking-shadowing: of 1, of (1−c)^5 and of c(1−c)^6, c the cosine at
// the half-vector. Any Schlick or F82 lobe's albedo is linear in them.
struct GgxMoments {
  float one;
  float schlick;
  float f82;
};
// alpha in [0, 1], cosine of wo in [0, 1].
GgxMoments ggx_moments(float alpha, float cosine);
// Mean of `one` over the cosine hemisphere.
float ggx_mean_albedo(float alpha);

// Reflected and transmitted share of a rough dielectric interface. eta: IOR of the far side over the near one, any positive value.
struct GlassAlbedo {
  float reflected;
  float transmitted;
  float crossing;  // what would be transmitted if nothing but total reflection were reflected
};
GlassAlbedo glass_albedo(float alpha, float cosine, float eta);

}  // namespace gradus::bsdf
