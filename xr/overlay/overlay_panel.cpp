#include "xr/overlay/overlay_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "shaders/shared/display_transform.h"
#include "shaders/shared/lookup_colors.h"

namespace probewalk {
namespace {

static_assert(sizeof(ImDrawVert) == sizeof(OverlayVertex) && sizeof(ImDrawIdx) == 2);

// Dear ImGui has one current context, whatever the thread.
std::mutex imgui_mutex;

constexpr float kMargin_px = 8.0f;
constexpr float kPanel_px = 392.0f;
constexpr float kGraph_px = 96.0f;
constexpr int kScaleSteps = 20;  // a multiple of the colours' own
constexpr double kMiB = 1 << 20;

constexpr ImU32 kGood = IM_COL32(92, 190, 126, 255);
constexpr ImU32 kOver = IM_COL32(232, 178, 64, 255);
constexpr ImU32 kMissed = IM_COL32(232, 80, 72, 255);
constexpr ImU32 kDevice = IM_COL32(130, 190, 255, 255);
constexpr ImU32 kLine = IM_COL32(255, 255, 255, 190);
constexpr ImU32 kFaint = IM_COL32(255, 255, 255, 6);

void text(const std::string& line) {
  ImGui::TextUnformatted(line.data(), line.data() + line.size());
}

void wrapped(const std::string& line) {
  ImGui::PushTextWrapPos(0.0f);
  text(line);
  ImGui::PopTextWrapPos();
}

std::string ms_text(const std::optional<double>& ms) {
  return ms ? fmt::format("{:.1f}", *ms) : std::string("-");
}

// A bar a frame, its device's part in front; the budget as a line; refreshes without a frame as marks from top to foot.
void show_graph(const OverlayFacts& facts) {
  const ImVec2 size(ImGui::GetContentRegionAvail().x, kGraph_px);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::Dummy(size);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end(corner.x + size.x, corner.y + size.y);
  list.AddRectFilled(corner, end, kFaint);
  if (facts.frames.empty()) {
    const char* const none = "no frame is complete yet";
    const ImVec2 letters = ImGui::CalcTextSize(none);
    list.AddText({std::round(corner.x + (size.x - letters.x) / 2), std::round(corner.y + (size.y - letters.y) / 2)},
                 kLine, none);
    return;
  }
  double highest_ms = facts.budget_ms * 1.5;
  for (const OverlayFrame& frame : facts.frames) highest_ms = std::max(highest_ms, double(frame.frame_ms));
  highest_ms = std::max(facts.budget_ms > 0.0 ? std::min(highest_ms, 4.0 * facts.budget_ms) : highest_ms, 1.0);
  const auto y_of = [&](double ms) {
    return end.y - static_cast<float>(std::clamp(ms / highest_ms, 0.0, 1.0)) * size.y;
  };
  const float step = size.x / static_cast<float>(OverlayBoard::kFrames);
  // Whole pixels: the edges of bars between them would make a pattern of their own.
  std::size_t to_come = facts.frames.size();
  const auto edge = [&](std::size_t bars_before_end) {
    return std::round(end.x - step * static_cast<float>(bars_before_end));
  };
  for (const OverlayFrame& frame : facts.frames) {
    const float x = edge(to_come), right = edge(--to_come);
    if (frame.missed > 0) list.AddRectFilled({x, corner.y}, {right, end.y}, IM_COL32(232, 80, 72, 110));
    if (frame.frame_ms >= 0.0f) {
      const bool over = facts.budget_ms > 0.0 && frame.frame_ms > 1.05 * facts.budget_ms;
      list.AddRectFilled({x, y_of(frame.frame_ms)}, {right, end.y}, frame.missed > 0 ? kMissed : over ? kOver : kGood);
    }
    if (frame.gpu_busy_ms >= 0.0f) {
      const float y = std::round(y_of(frame.gpu_busy_ms));
      list.AddRectFilled({x, y - 1.0f}, {right, y + 1.0f}, kDevice);
    }
  }
  if (facts.budget_ms > 0.0) {
    const float y = std::round(y_of(facts.budget_ms));
    list.AddRectFilled({corner.x, y}, {end.x, y + 1.0f}, kLine);
    const std::string label = fmt::format("budget {:.1f} ms", facts.budget_ms);
    list.AddText({corner.x + 4.0f, y - ImGui::GetTextLineHeight() - 1.0f}, kLine, label.c_str());
  }
  const std::string top = fmt::format("{:.0f} ms", highest_ms);
  list.AddText({end.x - ImGui::CalcTextSize(top.c_str()).x - 4.0f, corner.y + 1.0f}, kLine, top.c_str());
}

void show_legend() {
  const auto entry = [](ImU32 colour, const char* name) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 3.0f}, {at.x + 8.0f, at.y + 11.0f}, colour);
    ImGui::Dummy({9.0f, 8.0f});
    ImGui::SameLine(0.0f, 3.0f);
    text(name);
  };
  entry(kGood, "frame");
  ImGui::SameLine();
  entry(kOver, "late");
  ImGui::SameLine();
  entry(kMissed, "missed");
  ImGui::SameLine();
  entry(kDevice, "device");
}

void show_percentiles(const OverlayFacts& facts) {
  if (!ImGui::BeginTable("percentiles", 6, ImGuiTableFlags_SizingStretchProp)) return;
  for (const char* name : {"ms", "p50", "p90", "p99", "max", "n"}) {
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", name);
  }
  for (const OverlayRow& row : facts.rows) {
    ImGui::TableNextColumn();
    text(row.name);
    for (const auto& value : {row.p50_ms, row.p90_ms, row.p99_ms, row.max_ms}) {
      ImGui::TableNextColumn();
      text(ms_text(value));
    }
    ImGui::TableNextColumn();
    text(fmt::format("{}", row.n));
  }
  ImGui::EndTable();
}

// What the colours of the look-ups picture mean.
void show_lookup_scale() {
  text("look-ups of a pixel");
  const float width = ImGui::GetContentRegionAvail().x, line = ImGui::GetTextLineHeight();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::Dummy({width, line});
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto color_at = [](int k) {
    const glm::vec3 linear = lookup_color(kMostLookups * static_cast<float>(k) / kScaleSteps);
    return ImGui::ColorConvertFloat4ToU32({srgb_encode(linear.r), srgb_encode(linear.g), srgb_encode(linear.b), 1.0f});
  };
  for (int k = 0; k < kScaleSteps; ++k) {
    const float left = corner.x + width * static_cast<float>(k) / kScaleSteps;
    const float right = corner.x + width * static_cast<float>(k + 1) / kScaleSteps;
    list.AddRectFilledMultiColor({left, corner.y}, {right, corner.y + line}, color_at(k), color_at(k + 1),
                                 color_at(k + 1), color_at(k));
  }
  constexpr int kMarks = 4;
  for (int k = 0; k <= kMarks; ++k) {
    const std::string mark =
        fmt::format("{:.0f}{}", kMostLookups * static_cast<float>(k) / kMarks, k == kMarks ? "+" : "");
    const float share = static_cast<float>(k) / kMarks;
    ImGui::SetCursorPosX(ImGui::GetStyle().WindowPadding.x + share * (width - ImGui::CalcTextSize(mark.c_str()).x));
    text(mark);
    if (k < kMarks) ImGui::SameLine();
  }
}

std::string level_text(std::int32_t level) {
  return level < 0 ? std::string("none") : fmt::format("{}", level);
}

void show_streaming(const OverlayStatus& status) {
  const double resident = static_cast<double>(status.device_bytes), budget = static_cast<double>(status.budget_bytes);
  if (status.budget_bytes > 0) {
    ImGui::ProgressBar(static_cast<float>(std::min(resident / budget, 1.0)), {-1.0f, 0.0f},
                       fmt::format("{:.1f} of {:.0f} MiB resident", resident / kMiB, budget / kMiB).c_str());
  } else {
    text(fmt::format("{:.1f} MiB resident, no budget stated", resident / kMiB));
  }
  text(fmt::format("queue: {} levels, {:.1f} MiB in flight", status.queue_depth,
                   static_cast<double>(status.bytes_in_flight) / kMiB));
  if (!status.last_error.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, status.troubled_levels > 0 ? kMissed : kOver);
    wrapped(status.troubled_levels > 0
                ? fmt::format("{} levels cannot be loaded: {}", status.troubled_levels, status.last_error)
                : fmt::format("over: {}", status.last_error));
    ImGui::PopStyleColor();
  }
}

void show_all(const OverlayFacts& facts) {
  const OverlayStatus& status = facts.status;
  text(fmt::format("{}, method {}", status.display, status.method));
  show_graph(facts);
  show_legend();
  text(fmt::format("{} frames, {} missed", facts.frames_counted, facts.missed));
  if (status.eye_scale < 1.0f) {
    ImGui::SameLine();
    text(fmt::format("eyes at {:.0f} %", 100.0 * status.eye_scale));
  }
  show_percentiles(facts);
  ImGui::Separator();
  text(fmt::format("room {}: level {} shown, {} wanted", status.room, level_text(status.level_shown),
                   level_text(status.level_wanted)));
  show_streaming(status);
  ImGui::Separator();
  if (status.shows_lookups) show_lookup_scale();
  wrapped(fmt::format("F1 (in a headset: menu, held) hides this, F2 {} look-ups",
                      status.shows_lookups ? "hides" : "shows"));
  if (!status.credits.empty()) wrapped(status.credits);
}

void lay_out(const OverlayFacts& facts) {
  ImGui::NewFrame();
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float width = std::min(kPanel_px, std::max(screen.x - 2.0f * kMargin_px, 64.0f));
  const float most = std::max(screen.y - 2.0f * kMargin_px, 64.0f);
  ImGui::SetNextWindowPos({kMargin_px, kMargin_px});
  ImGui::SetNextWindowSizeConstraints({width, 0.0f}, {width, most});
  if (ImGui::Begin("overlay", nullptr,
                   ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoSavedSettings |
                       ImGuiWindowFlags_AlwaysAutoResize)) {
    show_all(facts);
  }
  ImGui::End();
  ImGui::Render();
}

OverlayPicture picture_of(const ImDrawData& data, VkExtent2D screen) {
  OverlayPicture picture;
  picture.vertices.reserve(static_cast<std::size_t>(data.TotalVtxCount));
  picture.indices.reserve(static_cast<std::size_t>(data.TotalIdxCount));
  for (int i = 0; i < data.CmdListsCount; ++i) {
    const ImDrawList& list = *data.CmdLists[i];
    const auto first_vertex = static_cast<std::uint32_t>(picture.vertices.size());
    for (const ImDrawVert& vertex : list.VtxBuffer) {
      picture.vertices.push_back({{vertex.pos.x, vertex.pos.y}, {vertex.uv.x, vertex.uv.y}, vertex.col});
    }
    for (const ImDrawCmd& command : list.CmdBuffer) {
      const auto clamped = [](float value, std::uint32_t most) {
        return static_cast<std::int32_t>(std::clamp(value, 0.0f, static_cast<float>(most)));
      };
      const std::int32_t left = clamped(command.ClipRect.x, screen.width),
                         top = clamped(command.ClipRect.y, screen.height);
      const std::int32_t right = clamped(command.ClipRect.z, screen.width);
      const std::int32_t foot = clamped(command.ClipRect.w, screen.height);
      if (right <= left || foot <= top || command.ElemCount == 0) continue;
      picture.parts.push_back(
          {{{left, top}, {static_cast<std::uint32_t>(right - left), static_cast<std::uint32_t>(foot - top)}},
           static_cast<std::uint32_t>(picture.indices.size()),
           command.ElemCount});
      for (unsigned k = 0; k < command.ElemCount; ++k) {
        picture.indices.push_back(first_vertex + command.VtxOffset +
                                  list.IdxBuffer[static_cast<int>(command.IdxOffset + k)]);
      }
    }
  }
  return picture;
}

}  // namespace

OverlayPanel::OverlayPanel() {
  const std::scoped_lock lock(imgui_mutex);
  context_ = ImGui::CreateContext();
  ImGui::SetCurrentContext(context_);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.AntiAliasedLinesUseTex = false;  // the atlas is not filtered
  style.WindowRounding = 0.0f;
  style.WindowBorderSize = 0.0f;
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.02f, 0.02f, 0.03f, 0.97f);
  style.Colors[ImGuiCol_TextDisabled] = ImVec4(0.7f, 0.7f, 0.7f, 1.0f);
  style.Colors[ImGuiCol_PlotHistogram] = ImGui::ColorConvertU32ToFloat4(IM_COL32(70, 120, 190, 255));
  unsigned char* coverage = nullptr;
  int width = 0, height = 0;
  io.Fonts->GetTexDataAsAlpha8(&coverage, &width, &height);
  atlas_.extent = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  atlas_.coverage = {coverage, static_cast<std::size_t>(width) * static_cast<std::size_t>(height)};
}

OverlayPanel::~OverlayPanel() {
  const std::scoped_lock lock(imgui_mutex);
  ImGui::DestroyContext(context_);
}

OverlayPicture OverlayPanel::draw(const OverlayFacts& facts, VkExtent2D screen) {
  const std::scoped_lock lock(imgui_mutex);
  ImGui::SetCurrentContext(context_);
  ImGui::GetIO().DisplaySize = {static_cast<float>(screen.width), static_cast<float>(screen.height)};
  ImGui::GetIO().DeltaTime = 1.0f / 60.0f;
  // A panel that fits itself to its contents shows nothing the first time: it has not measured them yet.
  if (!is_measured_) lay_out(facts);
  is_measured_ = true;
  lay_out(facts);
  return picture_of(*ImGui::GetDrawData(), screen);
}

}  // namespace probewalk
