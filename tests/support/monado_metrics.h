// Reads what Monado writes to XRT_METRICS_FILE: length-delimited protobuf records. Of these, what it knows of each
// frame of a session. All times CLOCK_MONOTONIC ns; 0 = did not happen.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace probewalk::test {

struct MonadoFrame {
  std::int64_t frame_id = 0;
  std::int64_t predicted_display_ns = 0;
  // Taken in the service, when the application's calls have crossed over: woken inside xrWaitFrame, xrBeginFrame,
  // the layers of xrEndFrame, and the device's work on them known to be over.
  std::int64_t woke_ns = 0, began_ns = 0, delivered_ns = 0, gpu_done_ns = 0;
  bool discarded = false;
};

namespace detail {

class ProtobufReader {
 public:
  explicit ProtobufReader(std::string_view bytes) : bytes_(bytes) {}
  bool at_end() const { return bytes_.empty(); }

  // Empty: cut short.
  std::optional<std::uint64_t> varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !bytes_.empty(); shift += 7) {
      const auto byte = static_cast<unsigned char>(take(1)->front());
      value |= std::uint64_t{byte & 0x7fu} << shift;
      if (byte < 0x80) return value;
    }
    return std::nullopt;
  }
  std::optional<std::string_view> take(std::size_t count) {
    if (count > bytes_.size()) return std::nullopt;
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

 private:
  std::string_view bytes_;
};

// Calls visit(field, number, bytes) for each field of a message; `bytes` of those that have some.
template <typename Visit>
void each_field(std::string_view message, const Visit& visit) {
  ProtobufReader reader(message);
  const auto need = [](const auto& value) {
    if (!value) throw std::runtime_error("Monado's records: a message is cut short");
    return *value;
  };
  while (!reader.at_end()) {
    const std::uint64_t key = need(reader.varint());
    const auto field = static_cast<unsigned>(key >> 3);
    switch (key & 7) {
      case 0:
        visit(field, need(reader.varint()), std::string_view());
        break;
      case 1:
        need(reader.take(8));
        break;
      case 2:
        visit(field, std::uint64_t{0}, need(reader.take(need(reader.varint()))));
        break;
      case 5:
        need(reader.take(4));
        break;
      default:
        throw std::runtime_error("Monado's records: an unknown kind of field");
    }
  }
}

}  // namespace detail

// The frames of all sessions, in the order of their records. A last record that is cut short is left out: a service
// that is killed leaves one.
inline std::vector<MonadoFrame> read_monado_metrics(std::string_view file) {
  constexpr unsigned kSessionFrame = 2;
  std::vector<MonadoFrame> frames;
  detail::ProtobufReader reader(file);
  while (!reader.at_end()) {
    const auto length = reader.varint();
    const auto record = length ? reader.take(*length) : std::nullopt;
    if (!record) break;
    detail::each_field(*record, [&](unsigned kind, std::uint64_t, std::string_view message) {
      if (kind != kSessionFrame) return;
      MonadoFrame frame;
      detail::each_field(message, [&](unsigned field, std::uint64_t number, std::string_view) {
        const auto value = static_cast<std::int64_t>(number);
        switch (field) {
          case 2:
            frame.frame_id = value;
            break;
          case 6:
            frame.predicted_display_ns = value;
            break;
          case 10:
            frame.woke_ns = value;
            break;
          case 11:
            frame.began_ns = value;
            break;
          case 12:
            frame.delivered_ns = value;
            break;
          case 13:
            frame.gpu_done_ns = value;
            break;
          case 14:
            frame.discarded = value != 0;
            break;
          default:
            break;
        }
      });
      frames.push_back(frame);
    });
  }
  return frames;
}

}  // namespace probewalk::test
