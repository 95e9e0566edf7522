/* Optical flow between two grey images: the C interface of libgradus_flow.so, which alone holds OpenCV. It is loaded
 * when it is asked for.
 */
#ifndef GRADUS_FLOW_H
#define GRADUS_FLOW_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GRADUS_FLOW_API __attribute__((visibility("default")))
#define GRADUS_FLOW_INTERFACE 1u /* goes up with every change below */

/* How much work the search does: OpenCV's presets of DIS. */
enum { GRADUS_FLOW_ULTRAFAST = 0, GRADUS_FLOW_FAST = 1, GRADUS_FLOW_MEDIUM = 2 };

typedef struct GradusFlowImages {
  int32_t width, height; /* at least 1 */
  const float* from;     /* row by row, finite, grey levels 0 to 255: others count as the nearest of them */
  const float* to;
} GradusFlowImages;

typedef struct GradusFlowEffort {
  int32_t preset;
  int32_t refinements; /* variational, each about the flow before it, at full resolution and on unrounded levels */
} GradusFlowEffort;

GRADUS_FLOW_API uint32_t gradus_flow_interface(void);
GRADUS_FLOW_API const char* gradus_flow_version(void); /* of OpenCV */

/* For each pixel of `from` how far it is, in pixels along the row and from row to row, to where `to` shows the same.
   `flow`, 2 floats per pixel, is also where the search starts: zero, or a guess. The result does not depend on the
   machine's threads. 0, or else something went wrong and `error` says what, cut to its size; `flow` is undefined then.
 */
GRADUS_FLOW_API int32_t gradus_flow_estimate(const GradusFlowImages* images, const GradusFlowEffort* effort,
                                             float* flow, char* error, size_t error_size);

#ifdef __cplusplus
}
#endif

#endif
