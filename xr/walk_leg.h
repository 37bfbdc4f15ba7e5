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
#include "xr/eye_resolution.h"
#include "xr/frame_book.h"
#include "xr/headset_watch.h"
#include "xr/locomotion.h"
#include "xr/spectator.h"
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
  ~WalkLeg();
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
  void write(const std::vector<ViewPose>& views, VkExtent2D extent);
  // None where a path is replayed: it is shown as it was recorded. Valid until the source's next wait.
  Guides guides() const;
  void save_pictures(const FrameTarget& target, const std::vector<ViewPose>& views);
  void note_for_overlay(const FrameRecord& record);
  // Enters a frame that has ended.
  void book(FrameRecord& record, std::uint64_t drawn);
  void take_late_answers();
  // Times `work` where the ledger takes part in the frame under way.
  template <typename Work>
  Interval stamped(const Work& work) const;
  void note_arrival();
  bool is_over(const FrameTiming& timing);

  const WalkOptions& options_;
  const Manifest& manifest_;
  const Display& display_;
  FrameSource& source_;
  WalkBooks& books_;
  const HeadsetWatch* watch_;
  Progress& progress_;
  bool settle_;
  WalkRooms rooms_;
  std::unique_ptr<BaselineStore> baselines_;  // null: the method reads the pack alone
  std::unique_ptr<Spectator> spectator_;      // null: the mirror shows eyes, or there is none
  FrameRenderer renderer_;
  FrameSettings settings_;
  EyeResolution eyes_;
  WallFade wall_fade_;
  FrameBook book_;
  std::uint32_t pipelines_built_ = 0;  // before the frame under way
  std::int64_t period_ns_ = 0;
  bool keeps_books_ = true;  // of the frame under way
  bool screenshot_ = false;
};

}  // namespace probewalk
