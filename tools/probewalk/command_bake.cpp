// probewalk bake: from a glTF scene to a pack.
#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "content/bake/bake_job.h"
#include "content/bake/plan/plan_report.h"
#include "content/error.h"
#include "tools/probewalk/commands.h"

namespace probewalk {

namespace {

struct BakeArguments {
  BakeOptions bake;
  double scale = 0.0;
  std::vector<double> start;
  double budget_mib = 0.0;
  std::string share;  // K/N
  std::string rooms_file, credits_file;
};

void read_share(const std::string& text, BakeOptions& options) {
  int end = 0;
  if (std::sscanf(text.c_str(), "%9d/%9d%n", &options.share, &options.shares, &end) != 2 ||
      std::size_t(end) != text.size() || options.shares < 1) {
    throw BadUsage(fmt::format("--share {} is not K/N; shares are 0/N, then 1/N to N/N", text));
  }
}

void print_share(const BakeOptions& options, const BakeReport& report, bool as_json) {
  const std::string folder = options.pack.string() + ".partial";
  if (as_json) {
    const nlohmann::json json = {{"share", options.share}, {"shares", options.shares}, {"maps", report.share_maps}, {"folder", folder}};
    std::puts(json.dump(2).c_str());
    return;
  }
  const std::string what = options.share == 0 ? "the light is" : fmt::format("share {} of {}, {} maps, is", options.share, options.shares, report.share_maps);
  std::puts(fmt::format("{} in {}; the same command without --share finishes the pack", what, folder).c_str());
}

// Room by room, what was kept and why.
void print_kept(const BakeReport& report) {
  if (report.kept.empty()) return;
  std::fputs(fmt::format("  {} of {} maps kept from before:\n", report.kept_maps, report.maps).c_str(), stdout);
  for (const RoomKept& room : report.kept) {
    const char* what = room.geometry && room.radiance ? "kept"
                       : room.geometry                ? "lit anew"
                       : room.radiance                ? "light kept"
                                                      : "baked anew";
    std::fputs(fmt::format("    {:<20} {:<11} {}\n", room.room, what, room.reason).c_str(), stdout);
  }
}

void print_report(const BakeOptions& options, const BakeReport& report, bool as_json) {
  if (as_json) {
    nlohmann::json json = {{"pack", options.pack.string()},
                                 {"plan", report.plan.string()},
                                 {"rooms", report.rooms},
                                 {"probes", report.probes},
                                 {"levels", report.levels},
                                 {"texels", report.texels},
                                 {"rays", report.rays},
                                 {"seconds", report.seconds},
                                 {"seconds_per_million_texels", report.seconds_per_million_texels},
                                 {"bytes_disk", report.bytes_disk},
                                 {"bytes_device", report.bytes_device},
                                 {"connected_fraction", report.connected_fraction},
                                 {"quantised_levels", report.quantised_levels},
                                 {"samples_bytes_disk", report.samples_bytes_disk},
                                 {"samples_bytes_float", report.samples_bytes_float > 0 ? nlohmann::json(report.samples_bytes_float) : nlohmann::json()},
                                 {"worst_sample_error", report.worst_sample_error},
                                 {"planar_fraction", report.planar_fraction}};
    json["maps"] = report.maps;
    json["maps_kept"] = report.kept_maps;
    json["kept"] = nlohmann::json::array();
    for (const RoomKept& room : report.kept) {
      json["kept"].push_back({{"room", room.room},
                              {"geometry", room.geometry},
                              {"radiance", room.radiance},
                              {"light_off", room.light_off},
                              {"reason", room.reason}});
    }
    if (report.planned) {
      json["plan_file"] = report.plan_file.string();
      json["planned"] = nlohmann::json::parse(plan_json(*report.planned));
    }
    std::puts(json.dump(2).c_str());
    return;
  }
  constexpr double kMiB = 1 << 20;
  std::fputs(fmt::format("{}: {} probes in {} rooms, {} level{}\n"
                         "  {:.{}f} million texels, baked at {:.2f} s per million; {:.0f} s in all, {:.0f} million rays\n"
                         "  {:.2f} MiB on disk, {:.2f} MiB on the device, {:.2f} % of cells without a cut\n"
                         "  seen from above: {}\n",
                         options.pack.string(), report.probes, report.rooms, report.levels, report.levels == 1 ? "" : "s",
                         static_cast<double>(report.texels) * 1e-6, report.texels < 1000000 ? 3 : 1, report.seconds_per_million_texels, report.seconds,
                         static_cast<double>(report.rays) * 1e-6, static_cast<double>(report.bytes_disk) / kMiB,
                         static_cast<double>(report.bytes_device) / kMiB, 100.0 * report.connected_fraction, report.plan.string())
                 .c_str(),
             stdout);
  if (report.quantised_levels > 0) {
    const std::string instead = report.samples_bytes_float > 0 ? fmt::format(" instead of {:.2f}", static_cast<double>(report.samples_bytes_float) / kMiB) : "";
    std::fputs(fmt::format("  samples quantised in {} of the rooms' levels: {:.2f}{} MiB, off by {:.1e} of themselves at most, {:.2f} % of "
                           "planar entries kept\n", report.quantised_levels, static_cast<double>(report.samples_bytes_disk) / kMiB,
                           instead, report.worst_sample_error, 100.0 * report.planar_fraction).c_str(), stdout);
  }
  print_kept(report);
  if (!report.planned) return;
  std::fputs(plan_table(*report.planned).c_str(), stdout);
  std::fputs(fmt::format("  the plan: {}\n", report.plan_file.string()).c_str(), stdout);
}

void run_bake(BakeArguments arguments, const CommonOptions& common) {
  BakeOptions& options = arguments.bake;
  if (arguments.scale > 0.0) options.load.scale = arguments.scale;
  if (!arguments.rooms_file.empty()) options.load.rooms_file = arguments.rooms_file;
  if (!arguments.credits_file.empty()) options.load.credits_file = arguments.credits_file;
  if (!arguments.start.empty()) options.start_m = glm::dvec3(arguments.start[0], arguments.start[1], arguments.start[2]);
  options.target.budget_bytes = static_cast<std::uint64_t>(arguments.budget_mib * (1 << 20));
  options.target.most_probes = static_cast<std::size_t>(options.placement.max_probes);
  options.light.threads = common.threads;
  options.producer = std::string("probewalk ") + PROBEWALK_VERSION;
  const std::unique_ptr<Progress> progress = make_progress(common);
  if (!arguments.share.empty()) read_share(arguments.share, options);
  const BakeReport report = bake(options, *progress);
  if (options.shares > 0) return print_share(options, report, common.json);
  print_report(options, report, common.json);
}

}  // namespace

void add_bake_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("bake", "Bake a glTF scene into a probe pack");
  command->footer(
      "States the unit and the lights it assumes, estimates time and size, then shows progress. Interrupted (Ctrl-C), "
      "it\n"
      "keeps what is finished beside the pack; the same command goes on from there. The same scene and options give "
      "the\n"
      "same bytes, whatever the number of threads. NAME.plan.png beside the pack is the plan of\n"
      "every storey: walls, windows, furniture, rooms by name, portals, probes by number, the tour.\n"
      "README.md lists the glTF extensions that are read.\n\n"
      "Rooms are those that the author named (node extras, or rooms.json beside the scene), else they are found: where "
      "the\n"
      "way for heads narrows to a door's width, one room ends; halls of over 150 m^2 are cut.\n\n"
      "With --error E the pack is as small as keeps two numbers below E for eyes anywhere in walkable space: mean FLIP "
      "of\n"
      "what a display shows at 20 pixels a degree, and the share of rays that are wrong or holes. Both are measured "
      "on\n"
      "views that nothing was chosen by. Rooms get probes where they are needed and maps of their own sizes; a table "
      "and\n"
      "NAME.plan.json tell what was chosen and what the next coarser choice would have cost, or why E cannot be "
      "kept.\n\n"
      "Onto a pack that was baked with the same options, only what has changed in the scene since is baked. A room is "
      "kept\n"
      "when nothing that its probes or their light's rays pass by has changed, and the light that arrives there by no "
      "more\n"
      "than --light-tolerance; a table tells what was kept and why. What is kept has the bytes of a full bake, unless "
      "the\n"
      "table says that its light changed. Probes stay on the grid of the earlier bake as long as it covers the scene. "
      "What\n"
      "the pack was made of is in NAME.inputs beside it; without that file, or with --all, all is baked.\n\n"
      "  probewalk bake house.glb -o house.probes\n"
      "  probewalk bake house.glb -o house.probes --error 0.05    the smallest pack that is off by no more\n"
      "  probewalk bake house.glb -o house.probes --budget 20     the best pack in 20 MiB\n"
      "  probewalk bake flat.gltf -o flat.probes --scale 0.01 --max-probes 60    a scene in centimetres, small pack");
  auto arguments = std::make_shared<BakeArguments>();
  BakeOptions& bake = arguments->bake;
  command->add_option("scene", bake.scene_file, "The scene: .gltf or .glb")->required();
  command->add_option("-o,--output", bake.pack, "The pack, a folder NAME.probes; an older one of that name is replaced")
      ->required();
  command->add_option("--resolution", bake.resolution,
                      "Cells per side of a probe's map, a power of two: 256 for a first look, 512 for rooms, 1024 and more "
                      "for clutter and foliage")->capture_default_str();
  command->add_option("--radiance-resolution", bake.radiance_resolution,
                      "Texels per side of a probe's picture, a power of two (0 = as --resolution): what textures need, "
                      "whatever the geometry needs")->capture_default_str();
  command
      ->add_option("--geometry-samples", bake.samples,
                   "How distances are stored on disk: float to the bit; quantised within 1e-6 of a sample on a plane and "
                   "3e-5 of any other, in about a third of the bytes; auto quantises the rooms and levels where that is "
                   "smaller and walls stay planes for the tracer")
      ->transform(CLI::CheckedTransformer(std::map<std::string, SampleCoding>{{"auto", SampleCoding::kSmaller},
                                                                              {"float", SampleCoding::kFloat},
                                                                              {"quantised", SampleCoding::kQuantised}},
                                          CLI::ignore_case))
      ->default_str("auto");
  command->add_option("--spacing", bake.placement.spacing_m,
                      "Metres between probes (0 = from the rooms' sizes); widened until --max-probes suffice")
      ->check(CLI::Range(0.0, 1000.0))->capture_default_str();
  command->add_option("--max-probes", bake.placement.max_probes, "At most this many probes: time and size grow with them")
      ->check(CLI::Range(1, 4096))->capture_default_str();
  command->add_option("--error", bake.target.error,
                      "Promise this error (mean FLIP, and wrong + holes of all rays) with the smallest pack; 0.05 is a good start")
      ->check(CLI::Range(1e-4, 0.99));
  command->add_option("--budget", arguments->budget_mib, "The least error that fits in this many MiB on disk")
      ->check(CLI::PositiveNumber);
  command->add_option("--samples", bake.light.samples, "Rays a point and bounce of indirect light; more is smoother")
      ->check(CLI::Range(8, 65536))->capture_default_str();
  command->add_option("--bounces", bake.light.bounces,
                      "Bounces of indirect light that are gathered one by one; all that follow are gathered together. 0: "
                      "nothing is reflected")
      ->check(CLI::Range(0, 64))->capture_default_str();
  command->add_option("--seed", bake.light.seed, "Turns the sampling patterns of indirect light")->capture_default_str();
  command->add_option(
      "--rooms", arguments->rooms_file,
      "Rooms as boxes and polygons, or edits of those that are found (merge, rename, split), instead of "
      "rooms.json beside the scene; `probewalk info PACK --rooms` prints those that were found, and `probewalk "
      "info --help` tells the form");
  command->add_option("--scale", arguments->scale, "Metres per unit of the file, instead of the guess that is stated")
      ->check(CLI::PositiveNumber);
  command->add_flag("--recentre", bake.load.recentre, "Move the scene's middle to x = z = 0 and its lowest point to y = 0");
  command->add_option("--start", arguments->start, "Where a walk starts: x,y,z in metres, moved to the nearest floor")
      ->delimiter(',')->expected(3);
  command->add_option("--credits", arguments->credits_file, "Text file of credits, instead of the scene's own");
  command->add_flag("--all", bake.all, "Bake all rooms anew, whatever an earlier pack of that name has");
  command
      ->add_option(
          "--light-tolerance", bake.light_tolerance,
          "Keep a room of an earlier pack whose light changed by no more than this share of it, all bakes since "
          "it was lit together; 0 keeps only what a full bake would make to the bit")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--only-room", bake.only_room, "Bake this room of an existing pack anew (`probewalk info` lists rooms)");
  command->add_option("--share", arguments->share,
                      "Part K of N of the work, for several machines over one folder (tools/bake-slurm): 0/N makes the light, "
                      "then 1/N to N/N in any order bake the maps; the same command without it finishes the pack");
  command->add_option("--isa", bake.isa,
                      "Instruction set of the ray caster (sse2, sse4.2, avx, avx2, avx512), for equal bytes on unequal "
                      "processors");
  add_common_options(*command, common);
  command->callback([arguments, &common] { run_bake(*arguments, common); });
}

}  // namespace probewalk
