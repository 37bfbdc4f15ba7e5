// What lenses hide, behind the scripted layer.
//   masks=FRAME:LEFT:RIGHT,...  from that frame on the left and the right view lack that half of what one sees: left,
//                               right, up, down or none; said from the first frame on by xrGetVisibilityMaskKHR, later
//                               by an event for each view that changes, too. Without an order the runtime's own
//   masks_grow=1                while the first mask is being read it is replaced by one with more vertices, and an
//                               event says so
#include <array>

#include "scripted.h"

namespace probewalk::test {
namespace {

constexpr float kFar = 10.0f;  // on the plane a metre ahead: beyond any field of view

struct Masks {
  std::array<std::string, 2> hidden;  // empty = the runtime's own
  bool grows = false;                 // and has not yet
  bool has_grown = false;
};
Masks masks;

struct Mesh {
  std::vector<XrVector2f> vertices;
  std::vector<std::uint32_t> indices;
};

Mesh mesh_of(const std::string& half) {
  if (half == "none") return {};
  const float left = half == "right" ? 0.0f : -kFar, right = half == "left" ? 0.0f : kFar;
  const float foot = half == "up" ? 0.0f : -kFar, top = half == "down" ? 0.0f : kFar;
  return {{{left, foot}, {right, foot}, {right, top}, {left, top}}, {0, 1, 2, 0, 2, 3}};
}

void send_change(std::uint32_t view) {
  layer.send(XrEventDataVisibilityMaskChangedKHR{XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR, nullptr,
                                                 layer.session.handle, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO,
                                                 view});
}

// The orders in force in `frame`.
std::array<std::string, 2> hidden_in(std::uint64_t frame) {
  std::array<std::string, 2> hidden;
  for (const Order& order : orders_of(layer.setting("masks"))) {
    if (frame >= order.frame) hidden = {order.words.at(0), order.words.at(1)};
  }
  return hidden;
}

XRAPI_ATTR XrResult XRAPI_CALL get_mask(XrSession session, XrViewConfigurationType configuration, std::uint32_t view,
                                        XrVisibilityMaskTypeKHR type, XrVisibilityMaskKHR* mask) {
  {
    const std::scoped_lock lock(layer.mutex);
    if (view < 2 && !masks.hidden[view].empty() && type == XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR) {
      Mesh mesh = mesh_of(masks.hidden[view]);
      if (masks.grows && mask->vertexCapacityInput != 0) {
        masks.grows = false;
        masks.has_grown = true;
        send_change(view);
      }
      if (masks.has_grown) mesh.vertices.resize(2 * mesh.vertices.size());
      mask->vertexCountOutput = static_cast<std::uint32_t>(mesh.vertices.size());
      mask->indexCountOutput = static_cast<std::uint32_t>(mesh.indices.size());
      if (mask->vertexCapacityInput == 0 && mask->indexCapacityInput == 0) return XR_SUCCESS;
      if (mask->vertexCapacityInput < mask->vertexCountOutput || mask->indexCapacityInput < mask->indexCountOutput) {
        return XR_ERROR_SIZE_INSUFFICIENT;
      }
      std::copy(mesh.vertices.begin(), mesh.vertices.end(), mask->vertices);
      std::copy(mesh.indices.begin(), mesh.indices.end(), mask->indices);
      return XR_SUCCESS;
    }
  }
  return layer.next<PFN_xrGetVisibilityMaskKHR>("xrGetVisibilityMaskKHR")(session, configuration, view, type, mask);
}

}  // namespace

void begin_masks() {
  masks = {};
  masks.hidden = hidden_in(1);
  masks.grows = layer.number("masks_grow") != 0.0;
}

void change_masks() {
  const std::array<std::string, 2> hidden = hidden_in(layer.session.frame);
  for (std::uint32_t view = 0; view < 2; ++view) {
    if (hidden[view] != masks.hidden[view]) send_change(view);
  }
  masks.hidden = hidden;
}

Hooks mask_hooks() {
  return {hook<"xrGetVisibilityMaskKHR", get_mask>()};
}

}  // namespace probewalk::test
