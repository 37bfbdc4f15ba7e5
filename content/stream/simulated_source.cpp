#include "content/stream/simulated_source.h"

#include <algorithm>

namespace probewalk {

void SimulatedSource::request(LevelKey key, std::uint64_t bytes) {
  const double size = static_cast<double>(bytes);
  const double chance = static_cast<double>(dice_() >> 11) * 0x1p-53;
  loads_.push_back({key, model_.latency_s, size, size / model_.decode_bytes_per_s, chance < model_.failure_share});
}

void SimulatedSource::cancel(LevelKey key) {
  std::erase_if(loads_, [&](const Load& load) { return load.key == key; });
}

std::vector<SimulatedSource::Ended> SimulatedSource::advance(double step_s) {
  std::vector<Ended> ended;
  double left_s = step_s;
  while (left_s > 0.0 && !loads_.empty()) {
    // Until the next change of what shares the rate.
    std::size_t moving = 0, decoding = 0;
    for (const Load& load : loads_) moving += load.wait_s <= 0.0 && load.bytes_left > 0.0;
    const double rate = moving > 0 ? model_.bytes_per_s / static_cast<double>(moving) : 0.0;
    double next_s = left_s;
    for (const Load& load : loads_) {
      if (load.wait_s > 0.0) {
        next_s = std::min(next_s, load.wait_s);
      } else if (load.bytes_left > 0.0) {
        next_s = std::min(next_s, load.bytes_left / rate);
      } else if (decoding < model_.decoders) {
        ++decoding;
        next_s = std::min(next_s, load.decode_left_s);
      }
    }
    next_s = std::max(next_s, 1e-9);
    decoding = 0;
    for (Load& load : loads_) {
      if (load.wait_s > 0.0) {
        load.wait_s -= next_s;
      } else if (load.bytes_left > 0.0) {
        const double bytes = std::min(load.bytes_left, rate * next_s);
        bytes_moved_ += bytes;
        load.bytes_left -= bytes;
        if (load.bytes_left < 0.5) load.bytes_left = 0.0;  // of a byte
      } else if (decoding < model_.decoders) {
        ++decoding;
        load.decode_left_s -= next_s;
      }
    }
    for (auto load = loads_.begin(); load != loads_.end();) {
      const bool fails = load->fails && load->wait_s <= 1e-12;
      if (fails || (load->wait_s <= 1e-12 && load->bytes_left <= 0.0 && load->decode_left_s <= 1e-12)) {
        ended.push_back({load->key, fails});
        load = loads_.erase(load);
      } else {
        ++load;
      }
    }
    left_s -= next_s;
  }
  return ended;
}

}  // namespace probewalk
