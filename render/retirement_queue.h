// Holds what the GPU may still read until the frame that could read it last has finished.
#pragma once

#include <cstdint>
#include <deque>
#include <utility>

namespace probewalk {

template <typename Resource>
class RetirementQueue {
 public:
  // `last_frame` is the last frame whose commands may use the resource; frames are retired in rising order.
  void retire(Resource resource, std::uint64_t last_frame) { retired_.emplace_back(last_frame, std::move(resource)); }
  // Destroys what no frame after `completed_frame` uses; returns whether there was any.
  bool release(std::uint64_t completed_frame) {
    bool any = false;
    for (; !retired_.empty() && retired_.front().first <= completed_frame; any = true) retired_.pop_front();
    return any;
  }
  template <typename Visitor>
  void for_each(Visitor visit) const {
    for (const auto& [frame, resource] : retired_) visit(resource);
  }

 private:
  std::deque<std::pair<std::uint64_t, Resource>> retired_;
};

}  // namespace probewalk
