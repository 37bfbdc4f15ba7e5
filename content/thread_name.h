// What the system knows of a thread of ours: its name, in debuggers, profilers and /proc, and what it gives way to.
#pragma once

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <string>

namespace probewalk {

// Of the calling thread; the first 15 characters count.
inline void name_this_thread(const std::string& name) {
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
}

// The calling thread gives way to those that frames depend on, where they want the same core: their work is late when
// it waits for a slice of ours. Not allowed or not known here = as it is.
inline void give_way_to_frames() {
  constexpr int kNice = 5;
  // Whoever hands such a thread work would lose the core to it for a slice: one that is woken as a batch waits.
  const sched_param none{};
  sched_setscheduler(static_cast<pid_t>(gettid()), SCHED_BATCH, &none);
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}

}  // namespace probewalk
