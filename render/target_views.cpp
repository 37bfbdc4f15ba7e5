#include "render/target_views.h"

#include "render/image.h"

namespace probewalk {

TargetViews::~TargetViews() {
  forget();
}

void TargetViews::forget() {
  for (const auto& [image, views] : views_) {
    for (VkImageView view : views) vkDestroyImageView(device_.handle(), view, nullptr);
  }
  views_.clear();
}

std::span<const VkImageView> TargetViews::of(VkImage image, VkFormat format, std::uint32_t layers) {
  std::vector<VkImageView>& views = views_[image];
  while (views.size() < layers) {
    views.push_back(make_layer_view(device_, image, format, static_cast<std::uint32_t>(views.size())));
  }
  return std::span(views).first(layers);
}

}  // namespace probewalk
