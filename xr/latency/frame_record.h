// The time points of one frame, CLOCK_MONOTONIC nanoseconds; the words are those of the CSV, the JSON and the page.
// 0 = did not happen.
#pragma once

#include <cstddef>
#include <cstdint>

namespace probewalk {

// A call's or a pass's enter and leave.
struct Interval {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

// Whether the runtime was asked, after the fact, what the pose of a frame should have been.
enum class PoseAnswer : std::uint8_t {
  kNone,      // this display has no later answer, or the frame was not shown
  kPending,   // the walk ended before the frame's time had come
  kMeasured,  // it answered: the pose errors are known
  kTooLate,   // we asked when the runtime no longer had to know
  kRefused,   // it had no valid answer
};
inline constexpr std::size_t kPoseAnswers = 5;

struct FrameRecord {
  std::uint64_t frame_id = 0;
  // Of the frame's thread, one after the other. In `wait` it stands until it can go on with the frame.
  Interval wait, begin, locate_early, record, locate_late, submit, end;
  // The runtime's own call that `wait` waits for: made ahead on a thread of its own it begins, and may end, while the
  // frame before is drawn. Else the same as `wait`.
  Interval runtime_wait;
  // The ledger's own questions (device times, poses after the fact): after end.end, before the next wait.
  Interval ledger;
  // Of wait.end .. end.end: time spent blocked on a swapchain image, on the device or for its queue, wherever it falls.
  std::int64_t blocked_ns = 0;
  // Processor time that the process had used by wait.end, all its threads together: from frame to frame it grows by
  // what a frame takes, a software device's work included.
  std::int64_t process_cpu_ns = 0;
  std::uint32_t pipelines_built = 0;
  // Device, on the same axis when clock_calibrated.
  Interval gpu, gpu_trace, gpu_resolve;
  bool clock_calibrated = false;
  std::int64_t clock_deviation_ns = 0;
  // From the runtime.
  std::int64_t predicted_display = 0;
  std::int64_t period = 0;
  bool should_render = true;
  bool discarded = false;
  bool early_pose = false;  // shown with the early pose, since the late one was not valid
  // Pose used against the runtime's later answer; negative = not measured.
  PoseAnswer pose_answer = PoseAnswer::kNone;
  double pose_error_mm = -1.0;
  double pose_error_deg = -1.0;
  // Streaming.
  std::uint64_t bytes_uploaded = 0;
  std::uint32_t queue_depth = 0;
  std::int32_t room = -1;
  std::int32_t level_shown = -1;
  std::int32_t level_wanted = -1;
  std::int64_t streaming_ns = 0;  // the frame thread in or blocked on streaming; some of it inside of `record`
  std::uint64_t device_bytes = 0;
  double eye_scale = 1.0;  // of both sides of what was drawn, against the display's own size
  // Mirror: on the frame thread, which only hands pictures over, and where its own thread brought one to the window.
  Interval mirror;
  Interval mirror_shown;
  bool mirror_presented = false;
};

// What became of a picture that was handed to the mirror; known only later.
struct MirrorShown {
  std::uint64_t frame_id = 0;
  Interval interval;       // the mirror's thread at it
  bool presented = false;  // false: the window was gone, or of another size by then
};

}  // namespace probewalk
