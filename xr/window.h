// A window on the desktop and what the user does in it. The only files that include GLFW are window*.cpp.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "render/device.h"

struct GLFWwindow;

namespace probewalk {

// What happened since the last poll.
struct WindowInput {
  glm::dvec2 wish{0.0};     // keys held: x to the right, y forward
  bool run = false;         // shift is held
  double turn = 0.0;        // keys held: -1 left, 1 right
  bool recentre = false;    // R
  glm::dvec2 drag_px{0.0};  // the mouse moved by this with its button held, y down
  // The button is held, and has not been dragged: place in the window, (0, 0) top left to (1, 1).
  std::optional<glm::dvec2> press;
  bool click = false;       // it was let go there
  bool overlay = false;     // F1, an odd number of times: what it switches is switched
  bool lookups = false;     // F2, likewise
  bool screenshot = false;  // F12
  bool closed = false;      // Esc, or the window's own button
};

class Window {
 public:
  // Throws NoDevice when there is no display or it cannot show Vulkan.
  Window(const std::string& title, VkExtent2D size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // What the Vulkan device needs to present here. The hooks hold no reference to the window.
  DeviceHooks device_hooks() const;
  // The caller destroys it, before the instance.
  VkSurfaceKHR create_surface(VkInstance instance) const;

  WindowInput poll();
  VkExtent2D framebuffer_extent() const;  // 0 while minimised
  // Of the monitor; 60 where it does not say.
  double refresh_hz() const;

 private:
  struct Library {  // GLFW itself, so that a constructor that throws still ends it
    Library();
    ~Library();
  };
  struct KeyPresses {  // since the last poll
    int recentre = 0, overlay = 0, lookups = 0, screenshot = 0;
  };

  Library library_;
  GLFWwindow* window_ = nullptr;
  glm::dvec2 cursor_px_{0.0};
  double dragged_px_ = 0.0;  // since the button went down
  bool button_was_down_ = false;
  KeyPresses presses_;
};

}  // namespace probewalk
