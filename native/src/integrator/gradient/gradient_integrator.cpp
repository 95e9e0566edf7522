#include "base/error.h"
#include "integrator/integrator.h"

namespace gradus {

std::unique_ptr<Integrator> make_gradient_integrator(const IntegratorContext&) {
  throw unsupported("gradient-domain path tracing is not there yet: use integrator PATH");
}

}  // namespace gradus
