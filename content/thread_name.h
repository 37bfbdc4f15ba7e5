// Threads by their names in debuggers, profilers and /proc.
#pragma once

#include <pthread.h>

#include <string>

namespace probewalk {

// Of the calling thread; the first 15 characters count.
inline void name_this_thread(const std::string& name) {
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
}

}  // namespace probewalk
