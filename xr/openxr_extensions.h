// What we ask of an OpenXR runtime beyond the core, and what is lost without it: the one table. Knows no OpenXR header,
// so that --help can print it.
#pragma once

#include <span>

namespace probewalk {

struct OpenXrExtension {
  const char* name;
  bool required;
  const char* without_it;  // what is lost
};
std::span<const OpenXrExtension> wanted_openxr_extensions();

}  // namespace probewalk
