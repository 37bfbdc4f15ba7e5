#include "content/stream/http_fetch.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <chrono>
#include <mutex>
#include <thread>

#include "content/error.h"

namespace probewalk {
namespace {

using Handle = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;

// What one attempt fills.
struct Transfer {
  CURL* handle = nullptr;
  std::vector<std::byte>& body;
  std::uint64_t limit_bytes = 0;
  const std::function<bool()>& cancelled;
  std::size_t resumed_at = 0;
  bool is_first_piece = true;
  bool is_too_long = false;
};

std::size_t on_data(char* data, std::size_t size, std::size_t count, void* user) {
  Transfer& transfer = *static_cast<Transfer*>(user);
  const std::size_t bytes = size * count;
  long status = 0;
  curl_easy_getinfo(transfer.handle, CURLINFO_RESPONSE_CODE, &status);
  // The words of an error page are not the file.
  if (status != 200 && status != 206) return bytes;
  // A server that knows no ranges sends everything again.
  if (transfer.is_first_piece && status == 200) transfer.body.clear();
  transfer.is_first_piece = false;
  if (bytes > transfer.limit_bytes - transfer.body.size()) {
    transfer.is_too_long = true;
    return CURL_WRITEFUNC_ERROR;
  }
  const auto* from = reinterpret_cast<const std::byte*>(data);
  transfer.body.insert(transfer.body.end(), from, from + bytes);
  return bytes;
}

int on_progress(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<const Transfer*>(user)->cancelled() ? 1 : 0;
}

void check(CURLcode code, const char* option) {
  if (code != CURLE_OK) throw std::runtime_error(fmt::format("{}: {}", option, curl_easy_strerror(code)));
}

// Seconds in small steps, so that a cancellation is heard.
void pause(double seconds, const std::function<bool()>& cancelled) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end && !cancelled()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

bool may_be_otherwise_later(long status) {
  return status == 408 || status == 429 || status >= 500;
}

}  // namespace

struct HttpFetcher::Impl {
  FetchLimits limits;
  std::mutex mutex;
  std::vector<Handle> idle;

  Handle take() {
    {
      const std::lock_guard lock(mutex);
      if (!idle.empty()) {
        Handle handle = std::move(idle.back());
        idle.pop_back();
        return handle;
      }
    }
    Handle handle(curl_easy_init(), &curl_easy_cleanup);
    if (!handle) throw std::runtime_error("curl_easy_init failed");
    return handle;
  }
  void give_back(Handle handle) {
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(handle));
  }

  CURLcode attempt(CURL* handle, const std::string& url, Transfer& transfer) const {
    curl_easy_reset(handle);  // connections stay
    check(curl_easy_setopt(handle, CURLOPT_URL, url.c_str()), "CURLOPT_URL");
    check(curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https"), "CURLOPT_PROTOCOLS_STR");
    check(curl_easy_setopt(handle, CURLOPT_REDIR_PROTOCOLS_STR, "http,https"), "CURLOPT_REDIR_PROTOCOLS_STR");
    check(curl_easy_setopt(handle, CURLOPT_FOLLOWLOCATION, 1L), "CURLOPT_FOLLOWLOCATION");
    check(curl_easy_setopt(handle, CURLOPT_MAXREDIRS, 5L), "CURLOPT_MAXREDIRS");
    check(curl_easy_setopt(handle, CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_2TLS}), "CURLOPT_HTTP_VERSION");
    check(curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L), "CURLOPT_NOSIGNAL");
    check(curl_easy_setopt(handle, CURLOPT_USERAGENT, "probewalk"), "CURLOPT_USERAGENT");
    check(curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, limits.connect_timeout_s), "CURLOPT_CONNECTTIMEOUT");
    check(curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, 1L), "CURLOPT_LOW_SPEED_LIMIT");
    check(curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, limits.stall_timeout_s), "CURLOPT_LOW_SPEED_TIME");
    check(curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, &on_data), "CURLOPT_WRITEFUNCTION");
    check(curl_easy_setopt(handle, CURLOPT_WRITEDATA, static_cast<void*>(&transfer)), "CURLOPT_WRITEDATA");
    check(curl_easy_setopt(handle, CURLOPT_XFERINFOFUNCTION, &on_progress), "CURLOPT_XFERINFOFUNCTION");
    check(curl_easy_setopt(handle, CURLOPT_XFERINFODATA, static_cast<void*>(&transfer)), "CURLOPT_XFERINFODATA");
    check(curl_easy_setopt(handle, CURLOPT_NOPROGRESS, 0L), "CURLOPT_NOPROGRESS");
    if (transfer.resumed_at > 0) {
      const std::string range = fmt::format("{}-", transfer.resumed_at);
      check(curl_easy_setopt(handle, CURLOPT_RANGE, range.c_str()), "CURLOPT_RANGE");
    }
    return curl_easy_perform(handle);
  }
};

HttpFetcher::HttpFetcher(const FetchLimits& limits) : impl_(std::make_unique<Impl>()) {
  static const CURLcode global = curl_global_init(CURL_GLOBAL_DEFAULT);
  check(global, "curl_global_init");
  impl_->limits = limits;
}

HttpFetcher::~HttpFetcher() = default;

std::vector<std::byte> HttpFetcher::get(const std::string& url, std::uint64_t limit_bytes,
                                        const std::function<bool()>& cancelled) const {
  std::vector<std::byte> body;
  Handle handle = impl_->take();
  std::string reason;
  for (int attempt = 0; attempt < impl_->limits.attempts; ++attempt) {
    if (attempt > 0) pause(impl_->limits.first_pause_s * static_cast<double>(1 << (attempt - 1)), cancelled);
    if (cancelled()) throw Interrupted(url + ": not wanted any more");
    Transfer transfer{handle.get(), body, limit_bytes, cancelled, body.size()};
    const CURLcode code = impl_->attempt(handle.get(), url, transfer);
    long status = 0;
    curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &status);
    if (cancelled()) throw Interrupted(url + ": not wanted any more");
    if (transfer.is_too_long) {
      throw BadInput(fmt::format("{}: is longer than the {} bytes that it should have at most", url, limit_bytes));
    }
    if (code == CURLE_OK && (status == 200 || status == 206)) {
      impl_->give_back(std::move(handle));
      return body;
    }
    if (status == 416) body.clear();  // the file has changed under us
    reason = code != CURLE_OK ? curl_easy_strerror(code) : fmt::format("the server answers {}", status);
    if (code == CURLE_OK && status != 416 && !may_be_otherwise_later(status))
      throw BadInput(fmt::format("{}: {}", url, reason));
    // An address that cannot be read does not become one.
    if (code == CURLE_URL_MALFORMAT || code == CURLE_UNSUPPORTED_PROTOCOL)
      throw BadInput(fmt::format("{}: {}", url, reason));
  }
  throw Unavailable(fmt::format("{}: {}, {} times in a row", url, reason, impl_->limits.attempts));
}

std::string without_slash(std::string url) {
  while (url.ends_with('/')) url.pop_back();
  return url;
}

bool is_http_url(const std::string& text) {
  return text.starts_with("http://") || text.starts_with("https://");
}

}  // namespace probewalk
