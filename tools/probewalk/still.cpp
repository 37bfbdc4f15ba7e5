#include "tools/probewalk/still.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "content/error.h"
#include "content/stream/room_streamer.h"
#include "render/baseline_store.h"
#include "render/readback.h"
#include "shaders/shared/view_ray.h"

namespace probewalk {
namespace {

constexpr auto kPatience = std::chrono::minutes(5);
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;

// Distances along the rays of a view to distances along its axis.
std::vector<float> along_axis(const std::vector<float>& distance_m, const ViewConstants& view, VkExtent2D extent) {
  const glm::ivec2 size_px(extent.width, extent.height);
  std::vector<float> depth_m;
  depth_m.reserve(distance_m.size());
  for (int y = 0; y < size_px.y; ++y) {
    for (int x = 0; x < size_px.x; ++x) {
      depth_m.push_back(distance_m[depth_m.size()] * view_ray_cosine(view, {x, y}, size_px));
    }
  }
  return depth_m;
}

}  // namespace

struct StillDrawer::Impl {
  Impl(const Pack& pack_in, const Device& device_in, VkExtent2D extent_px, std::uint32_t view_count,
       std::uint32_t samples, Progress& progress_in, const TracerChoice& choice, const BaselineMaps* maps,
       const std::optional<Foveation>& foveation, bool second_from_first)
      : pack(pack_in),
        device(device_in),
        progress(progress_in),
        extent(extent_px),
        views(view_count),
        store(device, pack.manifest().grid, static_cast<std::uint32_t>(pack.manifest().probe_positions_m.size()),
              {.frame_slots = kFrameSlots}),
        baselines(choice.needs_maps() && maps != nullptr ? std::make_unique<BaselineStore>(device, *maps, choice)
                                                         : nullptr),
        picture(device,
                {kFormat, extent, views, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT}),
        renderer(device, store,
                 {{.extent_px = extent,
                   .views = views,
                   .aov = true,
                   .samples = samples,
                   .foveation = foveation,
                   .setup = {choice, baselines.get()},
                   .second_from_first = second_from_first},
                  kFormat}),
        source(pack.path()),
        streamer(
            pack.manifest(), source,
            [this](LoadedLevel&& loaded) {
              store.upload({loaded.room, loaded.level, loaded.first_probe, std::move(loaded.probes)});
            },
            [this](LevelKey key) { store.evict(key.room, key.level); }, {.loader = {.samples = choice.samples}}) {}

  void load_rooms(glm::dvec3 head_m) {
    const bool is_settled = streamer.settle({.head_m = head_m}, kPatience);
    for (const std::string& error : streamer.take_errors()) progress.note(error);
    if (!is_settled) throw BadInput(pack.path().string() + ": the rooms did not load within five minutes");
    store.settle();
  }

  const Pack& pack;
  const Device& device;
  Progress& progress;
  const VkExtent2D extent;
  const std::uint32_t views;
  ProbeStore store;
  const std::unique_ptr<BaselineStore> baselines;  // null: the method reads the pack alone
  Image picture;
  FrameRenderer renderer;
  FolderSource source;
  RoomStreamer streamer;  // last: its loaders end before what they load into
};

StillDrawer::StillDrawer(const Pack& pack, const Device& device, VkExtent2D extent_px, std::uint32_t view_count,
                         std::uint32_t samples, Progress& progress, const TracerChoice& choice,
                         const BaselineMaps* maps, const std::optional<Foveation>& foveation, bool second_from_first)
    : impl_(std::make_unique<Impl>(pack, device, extent_px, view_count, samples, progress, choice, maps, foveation,
                                   second_from_first)) {}

StillDrawer::~StillDrawer() = default;

Still StillDrawer::draw(glm::dvec3 head_m, const std::vector<ViewConstants>& views, const FrameSettings& settings) {
  Impl& own = *impl_;
  own.load_rooms(head_m);

  FrameTarget target;
  target.image = own.picture.handle();
  target.format = kFormat;
  target.extent = own.extent;
  target.layers = own.views;
  target.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  own.renderer.record(target);
  own.renderer.write(views, settings);
  own.renderer.submit();
  own.renderer.wait();

  Still still;
  still.shown = read_pictures(own.device, own.picture.handle(), target.final_layout, kFormat, own.extent, own.views);
  still.radiance_cd_m2 = read_radiance(own.device, own.renderer.tracer().radiance());
  for (ImageRgbF& image : still.radiance_cd_m2) {
    for (glm::vec3& color : image.rgb) color /= settings.trace.radiance_scale;
  }
  still.distance_m = read_floats(own.device, own.renderer.tracer().distance());
  for (std::size_t view = 0; view < views.size(); ++view) {
    std::vector<float>& distance_m = still.distance_m[view];
    std::replace_if(distance_m.begin(), distance_m.end(), [](float t) { return t >= kMissDistance_m; },
                    std::numeric_limits<float>::infinity());
    still.depth_m.push_back(along_axis(distance_m, views[view], own.extent));
  }
  still.counts = read_uints(own.device, own.renderer.tracer().aov());
  still.times = own.renderer.take_times().value();
  return still;
}

}  // namespace probewalk
