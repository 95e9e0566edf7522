#pragma once

#include <memory>

#include "integrator/integrator.h"

namespace gradus::gradient {

// Returns a new integrator for gradient-domain path tracing (Kettunen et al. 2015; Manzi 2016, section 5.4).
std::unique_ptr<integrator::Integrator> make_gradient_integrator(const integrator::IntegratorContext& context);

}  // namespace gradus::gradient
