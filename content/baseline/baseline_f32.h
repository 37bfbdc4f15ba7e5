// The shared tracer in float with the baselines' walks in place of its own: what trace_rays_baseline.comp computes, on the
// host. trace_ray and its radiance take a BaselineContext more than f32's (content/baseline/host_tracer.h fills it).
#pragma once
#define PW_REAL float
#define PW_REAL_NAMESPACE baseline_f32
#define PW_BASELINES
#include "content/probe/tracer_instance.h"
#undef PW_BASELINES
#undef PW_REAL
#undef PW_REAL_NAMESPACE
