/* Optical flow between two grey images: the C interface of libgradus_flow.so. Only that library contains OpenCV, and it
 * is loaded on first use.
 */
#ifndef GRADUS_FLOW_H
#define GRADUS_FLOW_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GRADUS_FLOW_API __attribute__((visibility("default")))
#define GRADUS_FLOW_INTERFACE 1u /* is incremented with every change to this file */

/* Effort of the search: OpenCV's presets of DIS. */
enum { GRADUS_FLOW_ULTRAFAST = 0, GRADUS_FLOW_FAST = 1, GRADUS_FLOW_MEDIUM = 2 };

typedef struct GradusFlowImages {
  int32_t width, height; /* at least 1 */
  const float* from;     /* row by row, finite grey levels, which are clamped to 0 … 255 */
  const float* to;
} GradusFlowImages;

typedef struct GradusFlowEffort {
  int32_t preset;
  int32_t refinements; /* number of variational refinements, at full resolution and on unrounded levels */
} GradusFlowEffort;

GRADUS_FLOW_API uint32_t gradus_flow_interface(void);
GRADUS_FLOW_API const char* gradus_flow_version(void); /* version of OpenCV */

/* Estimates for each pixel of `from` the displacement, in pixels along the row and from row to row, to where `to` shows
   the same. `flow` holds 2 floats per pixel and is also the start of the search: zero, or an estimate. The result does
   not depend on the number of threads. Returns 0, or another value after an error; then `error` holds its text,
   truncated to `error_size`, and `flow` is undefined.
 */
GRADUS_FLOW_API int32_t gradus_flow_estimate(const GradusFlowImages* images, const GradusFlowEffort* effort,
                                             float* flow, char* error, size_t error_size);

#ifdef __cplusplus
}
#endif

#endif
