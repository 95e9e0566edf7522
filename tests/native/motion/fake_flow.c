/* A stand-in for libgradus_flow.so. The environment variable FAKE_FLOW selects how it misbehaves: fails, nan or far. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion/opencv/flow.h"

#ifndef FAKE_FLOW_INTERFACE
#define FAKE_FLOW_INTERFACE GRADUS_FLOW_INTERFACE
#endif

static int is(const char* name) {
  const char* const behaviour = getenv("FAKE_FLOW");
  return behaviour && strcmp(behaviour, name) == 0;
}

uint32_t gradus_flow_interface(void) { return FAKE_FLOW_INTERFACE; }
#ifndef FAKE_FLOW_INCOMPLETE
const char* gradus_flow_version(void) { return "fake"; }
#endif

int32_t gradus_flow_estimate(const GradusFlowImages* images, const GradusFlowEffort* effort, float* flow, char* error,
                             size_t error_size) {
  (void)effort;
  if (is("fails")) {
    snprintf(error, error_size, "the fake fails");
    return 1;
  }
  const float value = is("nan") ? NAN : is("far") ? 1e30f : 0.0f;
  for (int32_t i = 0; i < 2 * images->width * images->height; ++i) flow[i] = value;
  return 0;
}
