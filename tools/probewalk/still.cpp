#include "tools/probewalk/still.h"

#include <chrono>
#include <utility>

#include "content/error.h"
#include "content/stream/room_streamer.h"
#include "render/readback.h"

namespace probewalk {
namespace {

constexpr auto kPatience = std::chrono::minutes(5);
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;

void load_rooms(const Pack& pack, ProbeStore& store, glm::dvec3 head_m, Progress& progress) {
  const FolderSource source(pack.path());
  RoomStreamer streamer(
      pack.manifest(), source,
      [&](LoadedLevel&& loaded) {
        store.upload({loaded.room, loaded.level, loaded.first_probe, std::move(loaded.probes)});
      },
      [&](LevelKey key) { store.evict(key.room, key.level); });
  const bool is_settled = streamer.settle({.head_m = head_m}, kPatience);
  for (const std::string& error : streamer.take_errors()) progress.note(error);
  if (!is_settled) throw BadInput(pack.path().string() + ": the rooms did not load within five minutes");
  store.settle();
}

}  // namespace

Still draw_still(const Pack& pack, const Device& device, glm::dvec3 head_m, const std::vector<ViewConstants>& views,
                 VkExtent2D extent_px, const FrameSettings& settings, Progress& progress) {
  const auto view_count = static_cast<std::uint32_t>(views.size());
  ProbeStore store(device, pack.manifest().grid,
                   static_cast<std::uint32_t>(pack.manifest().probe_positions_m.size()), {.frame_slots = kFrameSlots});
  load_rooms(pack, store, head_m, progress);

  const Image picture(device, {kFormat, extent_px, view_count,
                               VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
  FrameTarget target;
  target.image = picture.handle();
  target.format = kFormat;
  target.extent = extent_px;
  target.layers = view_count;
  target.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  FrameRenderer renderer(device, store, {{extent_px, view_count, true}, kFormat});
  renderer.record(target);
  renderer.write(views, settings);
  renderer.submit();
  renderer.wait();

  Still still;
  still.shown = read_pictures(device, picture.handle(), target.final_layout, kFormat, extent_px, view_count);
  still.radiance_cd_m2 = read_radiance(device, renderer.tracer().radiance());
  for (ImageRgbF& image : still.radiance_cd_m2) {
    for (glm::vec3& color : image.rgb) color /= settings.trace.radiance_scale;
  }
  still.distance_m = read_floats(device, renderer.tracer().distance());
  still.counts = read_uints(device, renderer.tracer().aov());
  still.times = renderer.take_times().value();
  return still;
}

}  // namespace probewalk
