// What locomotion shows over a picture: the way of a teleport with a marker at its end, and the comfort vignette. The
// constants of one frame, read by guides.vert and guides.frag.
#ifndef PROBEWALK_SHADERS_SHARED_GUIDES_H
#define PROBEWALK_SHADERS_SHARED_GUIDES_H

#include "dialect.h"

PW_SHARED_BEGIN

PW_CONSTANT int kGuidePoints = 33;  // of the way
// Quads, in the order in which they are drawn: the way's, the marker, the vignette's ring.
PW_CONSTANT int kGuideMarkerQuad = kGuidePoints - 1;
PW_CONSTANT int kGuideVignetteQuad = kGuideMarkerQuad + 1;
PW_CONSTANT int kGuideVignetteSides = 64;
PW_CONSTANT int kGuideQuads = kGuideVignetteQuad + kGuideVignetteSides;

struct GuideConstants {
  pw_vec3 origin_hi_m;  // what the points are relative to, in the world: rounded to float,
  float half_width_m;   // of the way
  pw_vec3 origin_lo_m;  // and what the rounding left
  float slack_m;        // what is no further than this behind what the trace met still shows
  pw_vec3 color;        // linear, 1 = display white
  pw_int points;        // of the way; 0 = none is drawn
  pw_vec3 marker_m;
  float marker_radius_m;  // 0 = none
  pw_int marker_lies;     // 1: a ring on the floor; 0: a cross that faces the eye
  float marker_slack_m;
  // Tangents of the angles from a view's axis up to which the picture is as it is, and from which it is black; 0 = no
  // vignette.
  float vignette_clear;
  float vignette_black;
  pw_vec3 point_m[kGuidePoints];
};

PW_SHARED_END

#ifdef __cplusplus
namespace probewalk {
static_assert(sizeof(GuideConstants) == 80 + kGuidePoints * 12);
}  // namespace probewalk
#endif

#endif
