// What a walk keeps whatever becomes of its displays: where it is, and the books of its frames.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "xr/frame_source.h"
#include "xr/latency/ledger.h"
#include "xr/latency/run_info.h"
#include "xr/overlay/overlay_board.h"
#include "xr/path.h"
#include "xr/walk_view.h"

namespace probewalk {

struct WalkBooks {
  WalkView view;
  std::optional<std::uint64_t> frames;  // submitted, then the walk ends
  Ledger ledger;
  RunInfo info;
  std::unique_ptr<PathWriter> recorder;
  OverlayBoard overlay;
  bool shows_lookups = false;

  std::uint64_t frame = 0;  // index of the frame under way
  std::uint64_t pictures = 0;
  std::uint32_t validation_messages = 0;
  std::optional<std::int64_t> first_display_ns;
  std::optional<ViewPose> head;         // of the frame drawn last
  std::optional<std::int64_t> left_ns;  // when the display before was left, until the next one's first frame is done
};

}  // namespace probewalk
