// One stretch of a walk: on one display, from its first frame until the walk or the display ends.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "content/pack/pack_io.h"
#include "content/progress.h"
#include "render/baseline_store.h"
#include "render/frame_renderer.h"
#include "xr/display.h"
#include "xr/frame_book.h"
#include "xr/headset_watch.h"
#include "xr/locomotion.h"
#include "xr/walk.h"
#include "xr/walk_books.h"
#include "xr/walk_rooms.h"

namespace probewalk {

enum class LegEnd {
  kDone,         // the walk's own end has come: frames, seconds or path are over
  kClosed,       // the user left
  kInterrupted,  // progress.cancelled()
  kLost,         // the display went away
  kHeadsetBack,  // a headset is there that was not
};

class WalkLeg {
 public:
  // All outlive the leg. `watch` may be null: nobody waits for a headset.
  WalkLeg(const WalkOptions& options, const Pack& pack, const Display& display, WalkBooks& books,
          const HeadsetWatch* watch, Progress& progress);
  // Frames whose device times are still missing reach the ledger without them.
  ~WalkLeg() { book_.close(); }
  WalkLeg(const WalkLeg&) = delete;
  WalkLeg& operator=(const WalkLeg&) = delete;

  LegEnd run();
  // Waits for the frames in flight and closes the books of this leg.
  void finish();

 private:
  // False when the walk's own end has come.
  bool frame();
  // Draws into the source's next image; the views that were drawn, and the frame's number with the renderer.
  std::vector<ViewPose> draw(const FrameTiming& timing, FrameRecord& record, std::uint64_t& drawn);
  void write(const std::vector<ViewPose>& views);
  void save_pictures(const FrameTarget& target);
  void take_late_answers();
  void note_arrival();
  bool is_over(const FrameTiming& timing);

  const WalkOptions& options_;
  const Display& display_;
  FrameSource& source_;
  WalkBooks& books_;
  const HeadsetWatch* watch_;
  Progress& progress_;
  bool settle_;
  WalkRooms rooms_;
  std::unique_ptr<BaselineStore> baselines_;  // null: the method reads the pack alone
  FrameRenderer renderer_;
  FrameSettings settings_;
  WallFade wall_fade_;
  FrameBook book_;
  std::uint32_t pipelines_built_ = 0;  // before the frame under way
  bool screenshot_ = false;
};

}  // namespace probewalk
