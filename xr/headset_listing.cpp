#include "xr/headset_listing.h"

#include <fmt/format.h>

#include "xr/openxr_extensions.h"
#include "xr/openxr_refresh.h"
#include "xr/openxr_session.h"

namespace probewalk {

std::string list_headset() {
  const OpenXrInstance instance;
  const OpenXrViews views = read_views(instance, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO);
  const Device device(instance.device_hooks(), {});
  XrOwned<XrSession, xrDestroySession> session;
  check_xr(create_session(instance, device, session.out()), "xrCreateSession");
  const std::string refresh = OpenXrRefresh(instance, session.get()).in_words();

  std::string text = instance.description() + "\n";
  const auto line = [&](const char* label, const std::string& words) {
    text += fmt::format("  {:<14}{}\n", label, words);
  };
  line("eyes", fmt::format("{} of {}x{} as recommended, {}x{} at most", views.count, views.recommended.width,
                           views.recommended.height, views.most.width, views.most.height));
  line("refresh rate", refresh.empty() ? "as the runtime's own settings say; none can be chosen" : refresh);
  line("device", device.info().name);
  for (const OpenXrExtension& extension : wanted_openxr_extensions()) {
    line(instance.has(extension.name) ? "has" : "lacks",
         instance.has(extension.name) ? std::string(extension.name)
                                      : fmt::format("{}: {}", extension.name, extension.without_it));
  }
  return text;
}

}  // namespace probewalk
