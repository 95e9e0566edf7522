#include "path/random_walk.h"

#include <algorithm>
#include <cmath>

#include "base/trigonometry.h"
#include "bsdf/shading_frame.h"

namespace gradus::path {

namespace {

// Steps behind this one are isotropic.
constexpr uint32_t kLastAnisotropicStep = 9;
// A walk with a smaller weight ends.
constexpr float kSmallestWeight = 1e-6f;
// The first step finds opposite surfaces up to this number of mean free paths away.
constexpr float kSearchedPaths = 10.0f;

// Returns the direction at an angle of the given cosine around `axis`, turned by a fraction of a full turn.
Vec3 around(const Vec3& axis, float cosine, float turn) {
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  const SineCosine phi = sine_cosine(2.0f * kPi * turn);
  const Vec3 x = bsdf::perpendicular(axis);
  return (sine * phi.cosine) * x + (sine * phi.sine) * glm::cross(axis, x) + cosine * axis;
}

// Henyey and Greenstein's phase function, in solid angle.
float phase(float g, float cosine) {
  if (std::fabs(g) < 1e-3f) return 0.25f * kInvPi;
  const float d = std::max(1.0f + g * (g - 2.0f * cosine), 1e-10f);
  return 0.25f * kInvPi * (1.0f - g * g) / (d * std::sqrt(d));
}

// Samples the cosine of the angle to the last direction by Henyey and Greenstein's phase function.
float sample_phase(float g, float u) {
  if (std::fabs(g) < 1e-3f) return 1.0f - 2.0f * u;
  const float k = (1.0f - g * g) / (1.0f - g + 2.0f * g * u);
  return std::clamp((1.0f + g * g - k * k) / (2.0f * g), -1.0f, 1.0f);
}

Rgb exp_of(const Rgb& x) { return Rgb(std::exp(x.x), std::exp(x.y), std::exp(x.z)); }

// Returns, for each channel, the density of a step of length t, or the probability that it gets at least so far.
Rgb step_density(const Rgb& extinction, float t, bool leaves) {
  const Rgb transmittance = exp_of(extinction * -t);
  return leaves ? transmittance : extinction * transmittance;
}

// The zero-variance walk of a half-space whose surface has the normal n. Directions have the density
// 1 / (2π (v − μ) log((v + 1)/(v − 1))) with the cosine μ to n, and the extinction is scaled by 1 − μ/v.
class Guide {
 public:
  // `albedo` is that of single scattering. d'Eon and Křivánek 2020, eq. 67, give the diffusion length v.
  explicit Guide(float albedo) {
    length_ = 1.0f / std::sqrt(1.0f - std::pow(albedo, 2.44294f - 0.0215813f * albedo + 0.578637f / albedo));
    log_ = std::log((length_ + 1.0f) / (length_ - 1.0f));
  }
  bool exists() const { return length_ > 1.0f && is_finite(log_); }
  float length() const { return length_; }
  float sample(float u) const { return length_ - (length_ + 1.0f) * std::exp(-u * log_); }
  float density(float cosine) const { return 0.5f * kInvPi / ((length_ - cosine) * log_); }
  float stretch(float cosine) const { return 1.0f - cosine / length_; }

 private:
  float length_ = 0.0f, log_ = 0.0f;
};

// The medium of a step, and the share of guided directions.
struct StepMedium {
  Rgb extinction, scattering;
  float anisotropy = 0.0f;
  float guided = 0.0f;
};

StepMedium first_medium(const bsdf::Medium& m) {
  return {m.extinction, m.extinction * m.albedo, m.anisotropy,
          1.0f - std::max(0.5f, std::pow(std::fabs(m.anisotropy), 0.125f))};
}

// Returns the isotropic medium in which light spreads as far.
StepMedium similar_medium(const bsdf::Medium& m) {
  const Rgb scattering = m.extinction * m.albedo, reduced = scattering * (1.0f - m.anisotropy);
  return {m.extinction - scattering + reduced, reduced, 0.0f, 0.75f};
}

class Walk {
 public:
  Walk(const PathContext& context, const bsdf::Medium& medium, const WalkStart& start, const Guide& guide)
      : context_(context), medium_(medium), start_(start), guide_(guide) {}

  bool run(const Sampler& sampler, int depth, Rgb* weight, WalkEnd* end) {
    position_ = start_.position;
    direction_ = start_.direction;
    StepMedium medium = first_medium(medium_);
    for (uint32_t i = 0; i < dimension::kMaxSteps; ++i) {
      if (i == kLastAnisotropicStep + 1) medium = similar_medium(medium_);
      const StepSample u = sampler.walk_step(depth, i);
      const Rgb channels = channel_probabilities(*weight);
      const float extinction = medium.extinction[choose(channels, u.distance.x)];
      const bool leaves = i == 0 ? first_step(extinction, u, &end->hit) : step(medium, extinction, u, &end->hit);
      const float pdf =
          glm::dot(channels, i == 0 ? step_density(medium.extinction, length_, leaves) : density(medium, leaves));
      const Rgb transmittance = exp_of(medium.extinction * -length_);
      *weight *= (leaves ? transmittance : medium.scattering * transmittance) / pdf;
      if (leaves) {
        end->direction = direction_;
        return is_finite(*weight);
      }
      if (!(max_component(*weight) > kSmallestWeight)) return false;
      position_ += direction_ * length_;
    }
    return false;
  }

 private:
  // Returns the probabilities by which a channel is chosen.
  Rgb channel_probabilities(const Rgb& weight) const {
    const Rgb scattered = weight * medium_.albedo;
    const float sum = scattered.x + scattered.y + scattered.z;
    return sum > 0.0f ? scattered / sum : Rgb(1.0f / 3.0f);
  }
  static int choose(const Rgb& probabilities, float u) {
    if (u < probabilities.x) return 0;
    return u < probabilities.x + probabilities.y || probabilities.z <= 0.0f ? 1 : 2;
  }
  static float sample_length(float extinction, float u) { return -std::log(1.0f - u) / extinction; }

  // Takes the first step, whose direction is given, and looks for an opposite surface behind it. Returns whether the
  // step leaves the medium.
  bool first_step(float extinction, const StepSample& u, geometry::Hit* hit) {
    const float sampled = sample_length(extinction, u.distance.y);
    const float least = std::min(std::min(medium_.extinction.x, medium_.extinction.y), medium_.extinction.z);
    length_ = sampled;
    if (!meets(start_.nearest, std::max(sampled, kSearchedPaths / least), hit)) return false;
    has_opposite_ = true;
    opposite_ = std::max(0.0f, hit->t * -glm::dot(direction_, start_.normal));
    length_ = std::min(sampled, hit->t);
    return hit->t < sampled;
  }

  // Takes a step in a sampled direction. Returns whether it leaves the medium.
  bool step(const StepMedium& medium, float extinction, const StepSample& u, geometry::Hit* hit) {
    backward_ = has_opposite_ ? backward_share() : 0.0f;
    const bool guided = u.guide.x < medium.guided;
    const bool backward = guided && u.guide.y < backward_;
    const Vec3 last = direction_;
    if (guided) {
      const float cosine = guide_.sample(u.direction.x);
      direction_ = around(start_.normal, backward ? -cosine : cosine, u.direction.y);
    } else {
      direction_ = around(last, sample_phase(medium.anisotropy, u.direction.x), u.direction.y);
    }
    cosine_ = std::clamp(glm::dot(direction_, start_.normal), -1.0f, 1.0f);
    phase_ = phase(medium.anisotropy, glm::dot(last, direction_));
    if (guided) extinction *= guide_.stretch(backward ? -cosine_ : cosine_);
    length_ = sample_length(extinction, u.distance.y);
    if (!meets(0.0f, length_, hit)) return false;
    length_ = hit->t;
    return true;
  }

  bool meets(float nearest, float distance, geometry::Hit* hit) const {
    const Ray ray{position_, nearest, direction_, distance, start_.time};
    return context_.scene.intersect_instance(ray, start_.instance, hit);
  }

  // Returns the share of guided steps that aim at the opposite surface: more, the closer it is.
  float backward_share() const {
    const float depth = std::clamp(glm::dot(start_.position - position_, start_.normal), 0.0f, opposite_);
    return 1.0f / (1.0f + std::exp((opposite_ - 2.0f * depth) / guide_.length()));
  }

  // Returns the density of the last step in each channel over that of its phase function.
  Rgb density(const StepMedium& medium, bool leaves) const {
    const auto guided = [&](float cosine) {
      return step_density(medium.extinction * guide_.stretch(cosine), length_, leaves) *
             (guide_.density(cosine) / phase_);
    };
    Rgb sum = guided(cosine_) * (1.0f - backward_);
    if (backward_ > 0.0f) sum += guided(-cosine_) * backward_;
    return glm::mix(step_density(medium.extinction, length_, leaves), sum, medium.guided);
  }

  const PathContext& context_;
  const bsdf::Medium& medium_;
  const WalkStart& start_;
  const Guide& guide_;
  Vec3 position_ = Vec3(0.0f);
  Vec3 direction_ = Vec3(0.0f);
  // Properties of the latest step: its length, the cosine of its direction to the normal, the phase function, and the
  // share of guided steps that aim at the opposite surface.
  float length_ = 0.0f, cosine_ = 0.0f, phase_ = 0.0f, backward_ = 0.0f;
  bool has_opposite_ = false;
  float opposite_ = 0.0f;  // distance of the opposite surface along the normal
};

}  // namespace

bool walk(const PathContext& context, const Sampler& sampler, int depth, const bsdf::Medium& medium,
          const WalkStart& start, Rgb* weight, WalkEnd* end) {
  const Guide guide(max_component(medium.albedo));
  return guide.exists() && Walk(context, medium, start, guide).run(sampler, depth, weight, end);
}

}  // namespace gradus::path
