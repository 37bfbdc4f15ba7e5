// What every OpenXR API layer for tests begins with.
#pragma once

#include <openxr/openxr.h>
#include <openxr/openxr_loader_negotiation.h>

#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

namespace probewalk::test {

// "key=value;..." of an environment variable.
inline std::map<std::string, std::string> layer_settings(const char* variable) {
  std::map<std::string, std::string> settings;
  const char* text = std::getenv(variable);
  std::istringstream all(text != nullptr ? text : "");
  for (std::string entry; std::getline(all, entry, ';');) {
    const std::size_t at = entry.find('=');
    if (at != std::string::npos) settings[entry.substr(0, at)] = entry.substr(at + 1);
  }
  return settings;
}

// The instance of the next layer, or of the runtime.
inline XrResult create_next_instance(const XrInstanceCreateInfo& info, const XrApiLayerCreateInfo& chain,
                                     XrInstance* instance) {
  XrApiLayerCreateInfo rest = chain;
  rest.nextInfo = chain.nextInfo->next;
  return chain.nextInfo->nextCreateApiLayerInstance(&info, &rest, instance);
}

// What xrNegotiateLoaderApiLayerInterface answers.
inline XrResult negotiate(const XrNegotiateLoaderInfo* loader, XrNegotiateApiLayerRequest* request,
                          PFN_xrGetInstanceProcAddr get_proc, PFN_xrCreateApiLayerInstance create_instance) {
  if (loader == nullptr || request == nullptr || loader->minInterfaceVersion > XR_CURRENT_LOADER_API_LAYER_VERSION) {
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  request->layerInterfaceVersion = XR_CURRENT_LOADER_API_LAYER_VERSION;
  request->layerApiVersion = XR_CURRENT_API_VERSION;
  request->getInstanceProcAddr = get_proc;
  request->createApiLayerInstance = create_instance;
  return XR_SUCCESS;
}

}  // namespace probewalk::test
