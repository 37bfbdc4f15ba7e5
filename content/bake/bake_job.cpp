#include "content/bake/bake_job.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <span>
#include <vector>

#include "content/bake/bake_estimate.h"
#include "content/bake/bake_state.h"
#include "content/bake/exposure.h"
#include "content/bake/map_store.h"
#include "content/bake/placement/bare_rooms.h"
#include "content/bake/plan/plan_report.h"
#include "content/bake/plan_picture.h"
#include "content/bake/probe_lattice.h"
#include "content/bake/quantised_level.h"
#include "content/bake/rebake/bake_inputs.h"
#include "content/bake/rebake/room_reuse.h"
#include "content/error.h"
#include "content/pack/pack_format.h"
#include "content/pack/pack_io.h"
#include "content/probe/device_probe.h"
#include "content/scene/space.h"

namespace probewalk {

namespace fs = std::filesystem;

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check_options(const BakeOptions& options) {
  const auto check_side = [](int side, const char* name) {
    const bool power = side > 0 && (side & (side - 1)) == 0;
    if (!power || side < static_cast<int>(PackLimits::kMinMapSide) || side > static_cast<int>(PackLimits::kMapSide)) {
      throw BadUsage(fmt::format("{} {} is not a power of two from {} to {}; 512 is the default", name, side,
                                 PackLimits::kMinMapSide, PackLimits::kMapSide));
    }
  };
  check_side(options.resolution, "--resolution");
  if (options.radiance_resolution != 0) check_side(options.radiance_resolution, "--radiance-resolution");
  check_side(options.coarse_resolution, "the coarse level's resolution");
  if (options.target.error < 0.0 || options.target.error >= 1.0 || !std::isfinite(options.target.error)) {
    throw BadUsage(fmt::format("--error {} is not a share between 0 and 1; 0.05 is a good start", options.target.error));
  }
  if (options.target.error > 0.0 && options.target.budget_bytes > 0) {
    throw BadUsage("--error and --budget ask the same question the two ways round; give one of them");
  }
  if (options.shares < 0 || options.share < 0 || options.share > options.shares) {
    throw BadUsage(fmt::format("--share {}/{}: shares are 0/N, then 1/N to N/N", options.share, options.shares));
  }
  if (options.shares > 0 && options.target.asked()) {
    throw BadUsage("--share does not go with --error or --budget: a plan is made in one place, and its maps with it");
  }
  if (options.target.asked() && options.placement.spacing_m != 0.0) {
    throw BadUsage("--spacing is for grids; with --error or --budget probes stand where they are needed");
  }
  if (!(options.light_tolerance >= 0.0 && options.light_tolerance <= 1.0)) {
    throw BadUsage(fmt::format("--light-tolerance {} is not a share between 0 and 1; 0.01 is the default",
                               options.light_tolerance));
  }
  if (options.pack.extension() != ".probes") {
    throw BadUsage(fmt::format("a pack's name ends in .probes, this one does not: {}", options.pack.string()));
  }
  std::error_code error;
  if (fs::exists(options.pack, error) && !fs::is_directory(options.pack, error)) {
    throw BadUsage(fmt::format("{} is a file, a pack is a folder; choose another name", options.pack.string()));
  }
}

LevelSize fine_size(const BakeOptions& options) {
  return {options.resolution, options.radiance_resolution ? options.radiance_resolution : options.resolution};
}

// Coarse to fine. A fine level no finer than the coarse one is the only one.
std::vector<LevelSize> level_sizes(const BakeOptions& options, LevelSize fine) {
  const LevelSize coarse{std::min(options.coarse_resolution, fine.geometry), std::min(options.coarse_resolution, fine.radiance)};
  if (coarse.geometry == fine.geometry && coarse.radiance == fine.radiance) return {fine};
  return {coarse, fine};
}

// Everything besides the scene's own bytes that decides what is baked. Threads do not.
std::string hash_options(const BakeOptions& options, const Scene& scene) {
  const glm::dvec3 start = options.start_m.value_or(glm::dvec3(0.0));
  const std::string text = fmt::format(
      "{} format {} resolution {} radiance {} coarse {} spacing {:a} probes {} samples {} bounces {} cache {:a} seed {} "
      "scale {:a} recentre {} start {} {:a} {:a} {:a} isa '{}'",
      options.producer, kPackFormatVersion, options.resolution, options.radiance_resolution, options.coarse_resolution,
      options.placement.spacing_m, options.placement.max_probes, options.light.samples, options.light.bounces,
      options.light.cache_spacing_m, options.light.seed, scene.scale, options.load.recentre, options.start_m.has_value(),
      start.x, start.y, start.z, options.isa);
  const PlanTarget& target = options.target;
  const std::string planned = target.asked() ? fmt::format(" error {:a} budget {} most {} {} {}", target.error,
                                                           target.budget_bytes, target.most_probes, target.most_geometry,
                                                           target.most_radiance) : "";
  const std::string all =
      text + planned + fmt::format(" samples {} light {}", static_cast<int>(options.samples), kLightVersion);
  return content_hash(std::as_bytes(std::span(all)));
}

class BakeJob {
 public:
  BakeJob(const BakeOptions& options, Progress& progress)
      : options_(options), progress_(progress), scene_(load_scene(options.scene_file, options.load)),
        rays_(scene_, options.isa), levels_(level_sizes(options, fine_size(options))) {}

  BakeReport run() {
    const auto start = std::chrono::steady_clock::now();
    describe_scene();
    find_space_and_tour();
    inputs_.options_hash = manifest_.options_hash;
    if (!options_.all) earlier_ = find_earlier_bake(options_.pack, manifest_.options_hash);
    inputs_.cells = earlier_ ? earlier_->inputs.cells : SpaceCells::around(scene_.bounds);
    if (!options_.target.asked()) place();
    const SpaceCells& cells = inputs_.cells;
    const std::string key_text = fmt::format(
        "{}{} {:a} {:a} {} {} {} {} {} {}", manifest_.scene_hash, manifest_.options_hash, earlier_scale().value_or(0.0),
        cells.cell_m, cells.lower.x, cells.lower.y, cells.lower.z, cells.dims.x, cells.dims.y, cells.dims.z);
    const std::string key = content_hash(std::as_bytes(std::span(key_text)));
    const fs::path folder = options_.pack.string() + ".partial";
    if (options_.share > 0 && !BakeState::is_there(folder, key)) {
      throw BadUsage(fmt::format("--share {}/{}: {} holds no light of this bake; run --share 0/{} first", options_.share,
                                 options_.shares, folder.string(), options_.shares));
    }
    const BakeState state(folder, key);
    std::vector<CachedLight> kept_light = state.load_light();
    const bool same_scene = earlier_ && earlier_->pack.manifest().scene_hash == manifest_.scene_hash;
    if (kept_light.empty() && same_scene) kept_light = earlier_->inputs.light.indirect;
    const LightField light(scene_, rays_, options_.light, progress_, std::move(kept_light));
    if (options_.share == 0) state.store_light(light.cache_values());
    if (options_.shares > 0 && options_.share == 0) return report_;
    const Exposure exposure = exposure_of(light);
    manifest_.radiance_scale = exposure.radiance_scale;
    manifest_.exposure_ev = exposure.exposure_ev;
    MapStore maps(rays_, light, static_cast<float>(manifest_.radiance_scale), state, inputs_.cells);
    if (options_.target.asked()) plan(light, exposure, maps);
    find_what_is_kept(light);
    if (options_.shares > 0) {
      bake_share(maps);
      return report_;
    }
    bake_rooms(maps, state, wanted_);
    report_.rays += maps.rays_cast();
    report_.rays += light.rays_cast();
    report_.seconds = seconds_since(start);
    report_.rooms = manifest_.rooms.size();
    report_.probes = manifest_.probe_positions_m.size();
    for (const RoomEntry& room : manifest_.rooms) report_.levels = std::max(report_.levels, room.levels.size());
    report_.bytes_disk = manifest_.bytes_disk();
    report_.bytes_device = manifest_.bytes_device();
    return report_;
  }

 private:
  void describe_scene() {
    manifest_.producer = options_.producer;
    manifest_.scene_name = scene_.name;
    manifest_.scene_hash = scene_.content_hash;
    manifest_.options_hash = hash_options(options_, scene_);
    manifest_.scale = scene_.scale;
    manifest_.scale_statement = scene_.scale_statement;
    manifest_.light_statement = scene_.light_statement;
    manifest_.light = BakedLight{options_.light.samples, options_.light.bounces, options_.light.cache_spacing_m,
                                 options_.light.seed, options_.load.recentre};
    manifest_.credits = scene_.credits;
    manifest_.bounds = scene_.bounds;
    manifest_.warnings = scene_.warnings;
    for (const std::string& line : {scene_.scale_statement, scene_.light_statement}) {
      if (!line.empty()) progress_.note(line);
    }
    for (const std::string& warning : scene_.warnings) progress_.note("warning: " + warning);
  }

  void find_space_and_tour() {
    SpaceOptions space_options;
    space_options.start_m = options_.start_m;
    space_ = find_space(scene_, rays_, space_options, progress_);
    manifest_.start = space_.start;
    tour_ = space_.tour;
    if (tour_.empty()) tour_.push_back(space_.start);
    manifest_.tour = tour_;
  }

  std::optional<double> earlier_scale() const {
    return earlier_ ? earlier_->pack.manifest().radiance_scale : options_.kept_radiance_scale;
  }

  Exposure exposure_of(const LightField& light) const {
    Exposure exposure = choose_exposure(light, tour_);
    const std::optional<double> kept = earlier_scale();
    const double change = kept ? *kept / double(exposure.radiance_scale) : 0.0;
    if (change >= 0.5 && change <= 2.0) exposure.radiance_scale = static_cast<float>(*kept);
    return exposure;
  }

  // By the grid and the sizes of the options.
  void place() {
    PlacementOptions wanted = options_.placement;
    if (earlier_) wanted.kept_grid = earlier_->pack.manifest().grid;
    Placement placement = place_probes(scene_, rays_, space_, wanted);
    if (placement.sites.empty()) {
      throw BadInput(fmt::format("{}: there is no place for a probe; give --start x,y,z inside the scene or --scale",
                                 options_.scene_file.string()));
    }
    if (!placement.statement.empty()) progress_.note(placement.statement);
    stand(std::move(placement));
    wanted_ = wanted_rooms();
    if (!earlier_ || !options_.only_room.empty()) note_estimate();
  }

  // By need.
  void plan(const LightField& light, const Exposure& exposure, MapStore& maps) {
    const HeadSpace heads(scene_, rays_, space_);
    PlanTarget target = options_.target;
    target.coarse_side = options_.coarse_resolution;
    target.samples = options_.samples;
    report_.planned = plan_bake(space_, heads, rays_, light, exposure, maps, target, progress_);
    const Plan& planned = *report_.planned;
    Placement placement;
    placement.grid = planned.grid;
    for (std::size_t k = 0; k < planned.rooms.size(); ++k) {
      for (const glm::dvec3& position : planned.rooms[k].probes_m) placement.sites.push_back({position, int(k)});
    }
    for (std::string& statement : shortfalls(planned)) {
      progress_.note("warning: " + statement);
      manifest_.warnings.push_back(std::move(statement));
    }
    stand(std::move(placement));
    wanted_ = wanted_rooms();
  }

  void stand(Placement placement) {
    plan_ = draw_plan(scene_, space_, placement).image;
    for (const std::string& warning : space_.warnings) {
      progress_.note("warning: " + warning);
      manifest_.warnings.push_back(warning);
    }
    for (std::size_t k = 0; k < space_.rooms.size(); ++k) {
      const RoomRegion& region = space_.rooms[k];
      RoomEntry room;
      room.id = region.id;
      room.name = region.name;
      room.bounds = region.bounds;
      room.origin_m = glm::round(0.5 * (region.bounds.lower_m + region.bounds.upper_m));
      room.first_probe = static_cast<std::uint32_t>(manifest_.probe_positions_m.size());
      for (const ProbeSite& site : placement.sites) {
        if (site.room == static_cast<int>(k)) manifest_.probe_positions_m.push_back(on_lattice(site.position_m));
      }
      room.probe_count = static_cast<std::uint32_t>(manifest_.probe_positions_m.size()) - room.first_probe;
      manifest_.rooms.push_back(std::move(room));
    }
    name_rooms_without_probes();
    manifest_.grid = std::move(placement.grid);
    manifest_.portals = std::move(space_.portals);
    manifest_.floor = std::move(space_.floor);
  }

  // A plan may leave a room to its neighbours' probes; it is only short of probes when it used all.
  void name_rooms_without_probes() {
    const auto most = options_.target.asked() ? options_.target.most_probes : std::size_t(options_.placement.max_probes);
    if (options_.target.asked() && manifest_.probe_positions_m.size() < most) return;
    const std::string warning = bare_rooms_warning(space_, manifest_.rooms, most);
    if (warning.empty()) return;
    progress_.note("warning: " + warning);
    manifest_.warnings.push_back(warning);
  }

  std::vector<LevelSize> levels_of(std::size_t room) const {
    return report_.planned ? level_sizes(options_, report_.planned->rooms[room].size) : levels_;
  }

  // By room: whether it is baked. With --only-room the other rooms' chunks come from the pack that is there.
  std::vector<bool> wanted_rooms() {
    std::vector<bool> wanted(manifest_.rooms.size(), true);
    if (options_.only_room.empty()) return wanted;
    const auto room = std::find_if(manifest_.rooms.begin(), manifest_.rooms.end(),
                                   [&](const RoomEntry& r) { return r.id == options_.only_room; });
    if (room == manifest_.rooms.end()) {
      std::vector<std::string> ids;
      for (const RoomEntry& r : manifest_.rooms) ids.push_back(r.id);
      throw BadUsage(fmt::format("--only-room {}: there is no such room; the scene's rooms are {}", options_.only_room,
                                 fmt::join(ids, ", ")));
    }
    const Manifest old = Pack::open(options_.pack).manifest();
    if (old.scene_hash != manifest_.scene_hash || old.options_hash != manifest_.options_hash ||
        old.probe_positions_m != manifest_.probe_positions_m || old.rooms.size() != manifest_.rooms.size()) {
      throw BadUsage(fmt::format("--only-room {}: {} was baked from another scene or with other options, its other rooms "
                                 "would not fit; bake all rooms", options_.only_room, options_.pack.string()));
    }
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      wanted[k] = manifest_.rooms[k].id == options_.only_room;
      if (!wanted[k]) manifest_.rooms[k].levels = old.rooms[k].levels;
    }
    manifest_.features = old.features;
    return wanted;
  }

  std::uint64_t probes_in(const std::vector<bool>& wanted) const {
    std::uint64_t count = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) count += wanted[k] ? manifest_.rooms[k].probe_count : 0;
    return count;
  }

  // Of probes whose radiance is baked, which is most of the work.
  void note_estimate() {
    std::vector<bool> anew = wanted_;
    for (std::size_t k = 0; k < reuse_.size(); ++k) anew[k] = anew[k] && !reuse_[k].keeps_radiance;
    const BakeEstimate estimate =
        estimate_bake(scene_, rays_, options_.light, levels_, probes_in(anew), manifest_.probe_positions_m.front());
    progress_.note(fmt::format("{} probes in {} rooms, {:.1f} million texels: about {:.0f} s and {:.0f} MiB on disk",
                               probes_in(anew), std::count(anew.begin(), anew.end(), true),
                               static_cast<double>(estimate.texels) * 1e-6, estimate.seconds,
                               static_cast<double>(estimate.bytes_disk) / (1 << 20)));
  }

  // By room, what of the earlier pack is what would be baked again.
  void find_what_is_kept(const LightField& light) {
    reuse_.resize(manifest_.rooms.size());
    inputs_.rooms.resize(manifest_.rooms.size());
    if ((options_.shares > 0 || !options_.only_room.empty()) && !earlier_) return;  // nobody will ask
    inputs_.scene = hash_scene(scene_, inputs_.cells);
    inputs_.light = hash_light(light, inputs_.cells);
    if (!earlier_) return;
    const std::size_t points = inputs_.light.identities.size();
    const std::vector<std::uint32_t> numbers = numbers_now(earlier_->inputs.light, inputs_.light);
    if (!options_.only_room.empty()) {  // wanted_rooms() has seen that the earlier rooms are these
      for (std::size_t k = 0; k < wanted_.size(); ++k) {
        const RoomReuse whole{int(k), true, true, earlier_->inputs.rooms[k].drift, {}};
        if (!wanted_[k]) inputs_.rooms[k] = kept_inputs(*earlier_, whole, numbers, points);
      }
      return;
    }
    Manifest sized = manifest_;
    for (std::size_t k = 0; k < sized.rooms.size(); ++k) {
      for (const LevelSize& size : levels_of(k)) {
        LevelEntry& level = sized.rooms[k].levels.emplace_back();
        level.geometry_size = static_cast<std::uint32_t>(size.geometry);
        level.radiance_size = static_cast<std::uint32_t>(size.radiance);
      }
    }
    reuse_ = compare_rooms(*earlier_, sized, inputs_.scene, inputs_.light, options_.light_tolerance);
    for (std::size_t k = 0; k < reuse_.size(); ++k) {
      const RoomReuse& reuse = reuse_[k];
      inputs_.rooms[k] = kept_inputs(*earlier_, reuse, numbers, points);
      report_.kept.push_back(
          {manifest_.rooms[k].id, reuse.keeps_geometry, reuse.keeps_radiance, reuse.drift, reuse.reason});
    }
    const auto whole = std::count_if(reuse_.begin(), reuse_.end(),
                                     [](const RoomReuse& r) { return r.keeps_geometry && r.keeps_radiance; });
    progress_.note(
        fmt::format("{} of {} rooms are kept as they are in {}", whole, reuse_.size(), options_.pack.string()));
    if (!options_.target.asked()) note_estimate();
  }

  void bake_rooms(MapStore& maps, const BakeState& state, const std::vector<bool>& wanted) {
    PackWriter writer(options_.pack);
    std::uint64_t texels = 0;
    for (std::size_t k = 0; k < manifest_.rooms.size(); ++k) {
      if (!wanted[k] || reuse_[k].keeps_radiance) continue;
      for (const LevelSize& size : levels_of(k)) texels += std::uint64_t(manifest_.rooms[k].probe_count) * size.radiance * size.radiance;
    }
    progress_.begin("probes", texels, "texels");
    for (std::size_t k = 0; k < manifest_.rooms.size(); ++k) {
      RoomEntry& room = manifest_.rooms[k];
      if (!wanted[k] || room.probe_count == 0) continue;
      const std::vector<LevelSize> sizes = levels_of(k);
      for (std::size_t l = 0; l < sizes.size(); ++l) room.levels.push_back(make_level(maps, k, l, sizes[l], writer));
      if (report_.planned && report_.planned->rooms[k].held_back.measured) {
        room.levels.back().error = report_.planned->rooms[k].held_back.worst();
      }
    }
    report_.texels = done_texels_;
    if (maps.baked_texels() > 0) {
      report_.seconds_per_million_texels = maps.baking_seconds() * 1e6 / static_cast<double>(maps.baked_texels());
    }
    std::uint64_t cut = 0, all = 0;
    bool sees_sky = false;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (!wanted[k]) continue;
      cut += inputs_.rooms[k].cut_cells;
      all += inputs_.rooms[k].cells;
      sees_sky |= inputs_.rooms[k].sees_sky;
    }
    if (all > 0) report_.connected_fraction = 1.0 - static_cast<double>(cut) / static_cast<double>(all);
    if (sees_sky) add_feature("sky");
    if (cut > 0) add_feature("cuts");
    writer.finish(manifest_);
    keep_record();
    state.remove();
    report_.plan = fs::path(options_.pack).replace_extension(".plan.png");
    write_png(report_.plan, plan_);
    const fs::path plan_file = fs::path(options_.pack).replace_extension(".plan.json");
    if (report_.planned) {
      report_.plan_file = plan_file;
      write_file_atomically(plan_file, plan_json(*report_.planned));
    } else {
      std::error_code ignored;  // that of an earlier pack of this name
      fs::remove(plan_file, ignored);
    }
  }

  // For the next bake. After one of a room alone the record is whole only if there was one of the others.
  void keep_record() {
    if (options_.only_room.empty() || earlier_) {
      write_inputs(options_.pack, std::move(inputs_));
    } else {
      std::error_code ignored;
      fs::remove(inputs_file(options_.pack), ignored);
    }
  }

  // Every so many-th of the maps, which stay in the state.
  void bake_share(MapStore& maps) {
    std::uint64_t unit = 0;
    const auto is_ours = [&] { return unit++ % std::uint64_t(options_.shares) == std::uint64_t(options_.share - 1); };
    progress_.begin("share", 2 * probes_in(wanted_) * levels_.size() / std::uint64_t(options_.shares), "maps");
    const auto count = [&] {
      ++report_.share_maps;
      progress_.advance(1);
      stop_if_asked();
    };
    for (std::size_t k = 0; k < manifest_.rooms.size(); ++k) {
      const RoomEntry& room = manifest_.rooms[k];
      if (!wanted_[k]) continue;
      const RoomReuse& reuse = reuse_[k];
      for (const LevelSize& size : levels_) {
        for (std::uint32_t p = 0; p < room.probe_count; ++p) {
          const glm::dvec3 position = manifest_.probe_positions_m[room.first_probe + p];
          if (!reuse.keeps_geometry && is_ours()) {
            maps.geometry(position, size.geometry);
            count();
          }
          if (!reuse.keeps_radiance && is_ours()) {
            maps.radiance(position, size.radiance);
            count();
          }
        }
      }
    }
  }

  // What the earlier pack has of it is taken from there.
  LevelEntry make_level(MapStore& maps, std::size_t room_index, std::size_t level, LevelSize size, PackWriter& writer) {
    const RoomReuse& reuse = reuse_[room_index];
    const RoomEntry& room = manifest_.rooms[room_index];
    report_.maps += 2u * room.probe_count;
    report_.kept_maps += (std::size_t(reuse.keeps_geometry) + std::size_t(reuse.keeps_radiance)) * room.probe_count;
    if (!reuse.keeps_geometry && !reuse.keeps_radiance) return bake_level(maps, room_index, size, {}, writer);
    const LevelEntry& before = earlier_->pack.manifest().rooms[std::size_t(reuse.earlier)].levels[level];
    if (reuse.keeps_radiance && !reuse.keeps_geometry) {
      const RoomLevel kept = earlier_->pack.read_level(std::size_t(reuse.earlier), level);
      return bake_level(maps, room_index, size, kept.probes, writer);
    }
    LevelEntry entry = before;
    entry.error = -1.0;
    if (entry.quantised) add_feature(kQuantisedFeature);
    if (reuse.keeps_radiance) return entry;
    std::vector<ProbeRadiance> radiance;
    for (std::uint32_t k = 0; k < room.probe_count; ++k) {
      radiance.push_back(bake_radiance_of(maps, room_index, k, size));
    }
    const std::vector<std::byte> chunk =
        replace_radiance(earlier_->pack.read_chunk(before), std::move(radiance), options_.pack.string());
    entry.bytes_disk = chunk.size();
    entry.chunk = writer.add_chunk(chunk);
    return entry;
  }

  ProbeRadiance bake_radiance_of(MapStore& maps, std::size_t room, std::uint32_t probe, LevelSize size) {
    stop_if_asked();
    const glm::dvec3 position = manifest_.probe_positions_m[manifest_.rooms[room].first_probe + probe];
    ProbeRadiance map = maps.radiance(position, size.radiance, &inputs_.rooms[room].radiance);
    const std::uint64_t texels = std::uint64_t(size.radiance) * size.radiance;
    done_texels_ += texels;
    progress_.advance(texels);
    return map;
  }

  // with_radiance: of these maps; all are baked when there are none.
  LevelEntry bake_level(MapStore& maps, std::size_t room_index, LevelSize size, std::span<const ProbeMap> with_radiance,
                        PackWriter& writer) {
    const RoomEntry& room = manifest_.rooms[room_index];
    RoomInputs& inputs = inputs_.rooms[room_index];
    RoomLevel level;
    level.origin_m = room.origin_m;
    LevelEntry entry;
    entry.geometry_size = static_cast<std::uint32_t>(size.geometry);
    entry.radiance_size = static_cast<std::uint32_t>(size.radiance);
    for (std::uint32_t k = 0; k < room.probe_count; ++k) {
      stop_if_asked();
      const glm::dvec3 position = manifest_.probe_positions_m[room.first_probe + k];
      ProbeMap probe;
      probe.geometry = maps.geometry(position, size.geometry, &inputs.geometry);
      probe.radiance = with_radiance.empty() ? bake_radiance_of(maps, room_index, k, size) : with_radiance[k].radiance;
      const CutCells cut = count_cut_cells(probe.geometry);
      inputs.cut_cells += cut.all;
      inputs.cells += std::uint64_t(size.geometry) * size.geometry;
      inputs.sees_sky |= std::find(probe.geometry.w.begin(), probe.geometry.w.end(), 0.0f) != probe.geometry.w.end();
      entry.bytes_device += device_probe_bytes(size.geometry, size.radiance, cut);
      level.probes.push_back(std::move(probe));
    }
    const std::vector<std::byte> chunk = encode_level(level, entry);
    entry.bytes_disk = chunk.size();
    entry.chunk = writer.add_chunk(chunk);
    return entry;
  }

  // On the device.
  static void state_tiled_bytes(const RoomLevel& level, LevelEntry& entry) {
    if (entry.geometry_size < std::uint32_t(kLeastTiledSide)) return;
    std::atomic<std::uint64_t> words = 0;
    tbb::parallel_for(std::size_t{0}, level.probes.size(), [&](std::size_t k) {
      const DeviceProbe probe = build_device_probe(level.probes[k], PyramidMaker::kDevice, DeviceSamples::kTiled);
      words += probe.geometry.size() + probe.radiance.size();
    });
    const std::uint64_t bytes = words * sizeof(std::uint32_t);
    if (bytes < entry.bytes_device) entry.bytes_tiled = bytes;
  }

  // Quantised where that is asked for, or is smaller and stays within its bounds: looked at in what a reader will see.
  std::vector<std::byte> encode_level(const RoomLevel& level, LevelEntry& entry) {
    SampleSizes sizes;
    std::vector<std::byte> chunk = encode_chunk(level, options_.samples, &sizes);
    const bool tried = sizes.bytes_quantised > 0 && (sizes.bytes_float == 0 || sizes.bytes_quantised < sizes.bytes_float);
    if (tried) {
      const RoomLevel stored = decode_chunk(chunk, "the chunk just made");
      const QuantisedLevel found = compare_samples(level, stored);
      entry.quantised = options_.samples == SampleCoding::kQuantised || found.keeps_bounds();
      if (entry.quantised) {
        ++report_.quantised_levels;
        report_.worst_sample_error = std::max(report_.worst_sample_error, found.worst);
        planar_before_ += found.planar_before;
        planar_after_ += found.planar_after;
        add_feature(kQuantisedFeature);
        state_tiled_bytes(stored, entry);
      } else {
        chunk = encode_chunk(level);
      }
    }
    if (!entry.quantised) state_tiled_bytes(level, entry);
    report_.samples_bytes_float += sizes.bytes_float;
    report_.samples_bytes_disk += entry.quantised ? sizes.bytes_quantised : sizes.bytes_float;
    if (planar_before_ > 0) report_.planar_fraction = double(planar_after_) / double(planar_before_);
    return chunk;
  }

  void stop_if_asked() const {
    if (!progress_.cancelled()) return;
    throw Interrupted(fmt::format("interrupted; {:.1f} million texels are kept in {}.partial, the same command goes on "
                                  "from there", static_cast<double>(done_texels_) * 1e-6, options_.pack.string()));
  }

  void add_feature(const char* name) {
    if (std::find(manifest_.features.begin(), manifest_.features.end(), name) == manifest_.features.end()) {
      manifest_.features.emplace_back(name);
    }
  }

  const BakeOptions& options_;
  Progress& progress_;
  const Scene scene_;
  const RayScene rays_;
  const std::vector<LevelSize> levels_;
  Manifest manifest_;
  Space space_;
  std::vector<bool> wanted_;  // rooms that are baked now
  std::vector<Pose> tour_;
  ImageRgb8 plan_;
  BakeReport report_;
  std::optional<EarlierBake> earlier_;  // whose rooms may be kept
  std::vector<RoomReuse> reuse_;        // by room
  BakeInputs inputs_;                   // of the pack that is made now
  std::uint64_t done_texels_ = 0, planar_before_ = 0, planar_after_ = 0;
};

}  // namespace

BakeReport bake(const BakeOptions& options, Progress& progress) {
  check_options(options);
  std::optional<tbb::global_control> limit;
  if (options.light.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, options.light.threads);
  return BakeJob(options, progress).run();
}

}  // namespace probewalk
