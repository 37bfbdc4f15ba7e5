#include "xr/window.h"

#include <volk.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <utility>

#include "content/error.h"
#include "render/check.h"

namespace probewalk {
namespace {

constexpr double kClickSlack_px = 4.0;  // a hand that clicks trembles
constexpr double kAssumedRefresh_hz = 60.0;

std::string glfw_reason() {
  const char* text = nullptr;
  return glfwGetError(&text) == GLFW_NO_ERROR || text == nullptr ? "no reason given" : text;
}

}  // namespace

Window::Library::Library() {
  if (glfwInit() != GLFW_TRUE) throw NoDevice(fmt::format("no window: no display answers ({})", glfw_reason()));
}

Window::Library::~Library() {
  glfwTerminate();
}

Window::Window(const std::string& title, VkExtent2D size) {
  if (glfwVulkanSupported() != GLFW_TRUE)
    throw NoDevice("no window: no Vulkan driver can show pictures on this display");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  window_ =
      glfwCreateWindow(static_cast<int>(size.width), static_cast<int>(size.height), title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) throw NoDevice(fmt::format("no window: {}", glfw_reason()));
  // A key that was pressed and let go between two polls counts all the same: frames may be slow.
  glfwSetInputMode(window_, GLFW_STICKY_KEYS, GLFW_TRUE);
  glfwSetInputMode(window_, GLFW_STICKY_MOUSE_BUTTONS, GLFW_TRUE);
  // Keys that switch something are counted as they come. Asked for once a frame, a key that was let go and pressed again
  // in between would seem never to have been let go.
  glfwSetWindowUserPointer(window_, &presses_);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    if (action != GLFW_PRESS) return;
    auto& presses = *static_cast<KeyPresses*>(glfwGetWindowUserPointer(window));
    switch (key) {
      case GLFW_KEY_R:
        ++presses.recentre;
        break;
      case GLFW_KEY_F1:
        ++presses.overlay;
        break;
      case GLFW_KEY_F2:
        ++presses.lookups;
        break;
      case GLFW_KEY_F12:
        ++presses.screenshot;
        break;
      default:
        break;
    }
  });
  glfwGetCursorPos(window_, &cursor_px_.x, &cursor_px_.y);
}

Window::~Window() {
  if (window_ != nullptr) glfwDestroyWindow(window_);
}

DeviceHooks Window::device_hooks() const {
  DeviceHooks hooks;
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (names == nullptr) throw NoDevice(fmt::format("no window: Vulkan cannot present here ({})", glfw_reason()));
  hooks.instance_extensions.assign(names, names + count);
  hooks.device_extensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  hooks.can_present = [](VkInstance instance, VkPhysicalDevice device, std::uint32_t family) {
    return glfwGetPhysicalDevicePresentationSupport(instance, device, family) == GLFW_TRUE;
  };
  return hooks;
}

VkSurfaceKHR Window::create_surface(VkInstance instance) const {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  check(glfwCreateWindowSurface(instance, window_, nullptr, &surface), "glfwCreateWindowSurface");
  return surface;
}

WindowInput Window::poll() {
  glfwPollEvents();
  WindowInput input;
  const auto down = [&](int key) { return glfwGetKey(window_, key) == GLFW_PRESS; };
  input.wish = {static_cast<double>(down(GLFW_KEY_D)) - static_cast<double>(down(GLFW_KEY_A)),
                static_cast<double>(down(GLFW_KEY_W)) - static_cast<double>(down(GLFW_KEY_S))};
  input.run = down(GLFW_KEY_LEFT_SHIFT) || down(GLFW_KEY_RIGHT_SHIFT);
  input.turn = static_cast<double>(down(GLFW_KEY_E) || down(GLFW_KEY_RIGHT)) -
               static_cast<double>(down(GLFW_KEY_Q) || down(GLFW_KEY_LEFT));
  const KeyPresses presses = std::exchange(presses_, {});
  input.recentre = presses.recentre > 0;
  input.overlay = presses.overlay % 2 == 1;
  input.lookups = presses.lookups % 2 == 1;
  input.screenshot = presses.screenshot > 0;
  input.closed = down(GLFW_KEY_ESCAPE) || glfwWindowShouldClose(window_) == GLFW_TRUE;

  glm::dvec2 cursor_px;
  glfwGetCursorPos(window_, &cursor_px.x, &cursor_px.y);
  const bool button = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
  if (button && button_was_down_) {
    input.drag_px = cursor_px - cursor_px_;
    dragged_px_ += glm::length(input.drag_px);
  } else if (button) {
    dragged_px_ = 0.0;
  }
  glm::ivec2 size;
  glfwGetWindowSize(window_, &size.x, &size.y);
  if ((button || button_was_down_) && dragged_px_ < kClickSlack_px && size.x > 0 && size.y > 0) {
    input.press = cursor_px / glm::dvec2(size);
    input.click = !button;
  }
  button_was_down_ = button;
  cursor_px_ = cursor_px;
  return input;
}

VkExtent2D Window::framebuffer_extent() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

double Window::refresh_hz() const {
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor == nullptr ? nullptr : glfwGetVideoMode(monitor);
  return mode == nullptr || mode->refreshRate <= 0 ? kAssumedRefresh_hz : mode->refreshRate;
}

}  // namespace probewalk
