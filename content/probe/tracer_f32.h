// The shared tracer in float: what the device computes, on the host (trace, placement, tests).
#pragma once
#define PW_REAL float
#define PW_REAL_NAMESPACE f32
#include "content/probe/tracer_instance.h"
#undef PW_REAL
#undef PW_REAL_NAMESPACE
