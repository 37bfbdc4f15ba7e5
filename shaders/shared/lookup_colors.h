// Look-ups as colours, for pictures of where the tracer works hard and the scale beside them: from black (none) by blue,
// green, yellow and red to white (kMostLookups and more). Linear, 1 = display white.
#ifndef PROBEWALK_SHADERS_SHARED_LOOKUP_COLORS_H
#define PROBEWALK_SHADERS_SHARED_LOOKUP_COLORS_H

#include "dialect.h"

PW_SHARED_BEGIN

PW_CONSTANT float kMostLookups = 64.0f;

PW_FUNCTION pw_vec3 lookup_color(float lookups) {
  const int last = 5;
  pw_vec3 stops[6];
  stops[0] = pw_vec3(0.0f, 0.0f, 0.0f);
  stops[1] = pw_vec3(0.01f, 0.05f, 0.35f);
  stops[2] = pw_vec3(0.02f, 0.40f, 0.30f);
  stops[3] = pw_vec3(0.75f, 0.65f, 0.05f);
  stops[4] = pw_vec3(0.80f, 0.08f, 0.03f);
  stops[5] = pw_vec3(1.0f, 1.0f, 1.0f);
  float at = (lookups < kMostLookups ? lookups : kMostLookups) / kMostLookups * float(last);
  int stop = int(at) < last - 1 ? int(at) : last - 1;
  float share = at - float(stop);
  return stops[stop] * (1.0f - share) + stops[stop + 1] * share;
}

PW_SHARED_END

#endif
