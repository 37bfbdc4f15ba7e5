// OpenXR with its Vulkan and POSIX time bindings, and how its results are checked. Included by openxr_*.cpp only.
#pragma once

#include <volk.h>

#include <ctime>

#define XR_USE_GRAPHICS_API_VULKAN
#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <string>

namespace probewalk {

// "XR_ERROR_FORM_FACTOR_UNAVAILABLE"; works without an instance.
std::string xr_result_name(XrResult result);

// The runtime, the session or the instance is gone: no error of ours, and nothing that a frame can repair.
inline bool means_lost(XrResult result) {
  return result == XR_ERROR_INSTANCE_LOST || result == XR_ERROR_SESSION_LOST || result == XR_ERROR_RUNTIME_FAILURE ||
         result == XR_SESSION_LOSS_PENDING || result == XR_ERROR_RUNTIME_UNAVAILABLE;
}

// What came of a call, and its name for a message.
struct OpenXrOutcome {
  XrResult result = XR_SUCCESS;
  const char* call = "";
};

// Owns a handle; destroyed in the reverse order of the members that hold it.
template <typename Handle, XrResult(XRAPI_PTR* kDestroy)(Handle)>
class XrOwned {
 public:
  XrOwned() = default;
  ~XrOwned() { reset(); }
  XrOwned(const XrOwned&) = delete;
  XrOwned& operator=(const XrOwned&) = delete;
  void reset() {
    if (handle_ != XR_NULL_HANDLE) kDestroy(handle_);
    handle_ = XR_NULL_HANDLE;
  }
  Handle get() const { return handle_; }
  // For the creating call; whatever was held is destroyed.
  Handle* out() {
    reset();
    return &handle_;
  }

 private:
  Handle handle_ = XR_NULL_HANDLE;
};

// Throws NoDevice naming the call and the result when it is an error. Success codes pass.
void check_xr(XrResult result, const char* call);

}  // namespace probewalk
