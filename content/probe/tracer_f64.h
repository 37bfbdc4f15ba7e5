// The shared tracer in double: the reference for its numerical stability.
#pragma once
#define PW_REAL double
#define PW_REAL_NAMESPACE f64
#include "content/probe/tracer_instance.h"
#undef PW_REAL
#undef PW_REAL_NAMESPACE
