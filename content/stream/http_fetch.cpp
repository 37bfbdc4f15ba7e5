#include "content/stream/http_fetch.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <utility>

#include "content/error.h"

namespace probewalk {
namespace {

constexpr int kMostRedirections = 5;

using Handle = std::unique_ptr<CURL, decltype(&curl_easy_cleanup)>;
using UrlParts = std::unique_ptr<CURLU, decltype(&curl_url_cleanup)>;

// What one attempt fills.
struct Transfer {
  CURL* handle = nullptr;
  std::vector<std::byte>& body;
  std::uint64_t limit_bytes = 0;
  const std::function<bool()>& cancelled;
  std::size_t resumed_at = 0;
  const std::function<void()>& on_quiet;
  double quiet_s = 0.0;
  bool is_first_piece = true;
  bool is_too_long = false;
  curl_off_t known_bytes = 0;  // that had come by then
  std::chrono::steady_clock::time_point known_at = std::chrono::steady_clock::now();
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

// Called about once a second, more often while bytes come.
int on_progress(void* user, curl_off_t, curl_off_t came_bytes, curl_off_t, curl_off_t) {
  Transfer& transfer = *static_cast<Transfer*>(user);
  const auto now = std::chrono::steady_clock::now();
  const double passed_s = std::chrono::duration<double>(now - transfer.known_at).count();
  if (passed_s >= transfer.quiet_s) {
    const double least = static_cast<double>(FetchLimits::kStall_bytes_s) * passed_s;
    if (static_cast<double>(came_bytes - transfer.known_bytes) < least) transfer.on_quiet();
    transfer.known_bytes = came_bytes;
    transfer.known_at = now;
  }
  return transfer.cancelled() ? 1 : 0;
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

// What people set for the curl command and for OpenSSL; the library by itself heeds neither. Empty: the system's.
std::string own_ca_file() {
  for (const char* name : {"CURL_CA_BUNDLE", "SSL_CERT_FILE"}) {
    if (const char* file = std::getenv(name); file != nullptr && *file != '\0') return file;
  }
  return {};
}

bool is_redirection(long status) {
  return status == 301 || status == 302 || status == 303 || status == 307 || status == 308;
}

std::string part_of(const UrlParts& url, CURLUPart which) {
  char* text = nullptr;
  if (curl_url_get(url.get(), which, &text, CURLU_DEFAULT_PORT) != CURLUE_OK) return {};
  const std::unique_ptr<char, decltype(&curl_free)> owner(text, &curl_free);
  return text;
}

// Where a redirection leads. Empty: to another server, which may be anything in the walker's own network.
std::string redirection(CURL* handle, const std::string& url) {
  char* to = nullptr;
  curl_easy_getinfo(handle, CURLINFO_REDIRECT_URL, &to);
  const UrlParts here(curl_url(), &curl_url_cleanup), there(curl_url(), &curl_url_cleanup);
  if (to == nullptr || curl_url_set(here.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK ||
      curl_url_set(there.get(), CURLUPART_URL, to, 0) != CURLUE_OK) {
    return {};
  }
  const auto is_same = [&](CURLUPart which) { return part_of(here, which) == part_of(there, which); };
  const bool is_upgrade = part_of(here, CURLUPART_SCHEME) == "http" && part_of(there, CURLUPART_SCHEME) == "https";
  const bool is_same_origin = is_same(CURLUPART_SCHEME) && is_same(CURLUPART_PORT);
  return is_same(CURLUPART_HOST) && (is_same_origin || is_upgrade) ? to : std::string();
}

// Trying again is no use.
bool is_for_good(CURLcode code, long status, const Transfer& transfer) {
  if (transfer.is_too_long) return true;
  switch (code) {
    case CURLE_OK: return status != 408 && status != 416 && status != 429 && status < 500;
    case CURLE_URL_MALFORMAT:
    case CURLE_UNSUPPORTED_PROTOCOL:
    case CURLE_PEER_FAILED_VERIFICATION:
    case CURLE_SSL_CACERT_BADFILE: return true;
    default: return false;
  }
}

std::string describe(CURLcode code, long status, const Transfer& transfer) {
  if (transfer.is_too_long) {
    return fmt::format("is longer than the {} bytes that it should have at most", transfer.limit_bytes);
  }
  if (code == CURLE_OK && is_redirection(status)) {
    return fmt::format("the server answers {} and sends us to another one; give that one's address", status);
  }
  switch (code) {
    case CURLE_OK: return fmt::format("the server answers {}", status);
    case CURLE_OPERATION_TIMEDOUT: return "the server does not deliver in time";
    case CURLE_PEER_FAILED_VERIFICATION:
      return fmt::format("{}; if you trust its certificate, name the file of who signed it in SSL_CERT_FILE",
                         curl_easy_strerror(code));
    default: return curl_easy_strerror(code);
  }
}

}  // namespace

struct HttpFetcher::Impl {
  FetchLimits limits;
  std::string ca_file = own_ca_file();
  std::mutex mutex;
  std::vector<Handle> idle;
  FetchCounts counts;
  std::atomic<std::uint64_t> quiet{0};

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
  void count_request(std::size_t bytes) {
    const std::lock_guard lock(mutex);
    ++counts.requests;
    counts.bytes += bytes;
  }
  void count_quiet(const std::string& url) {
    const std::lock_guard lock(mutex);
    counts.last_quiet = url;
    ++quiet;
  }
  void count_failure(const std::string& reason) {
    const std::lock_guard lock(mutex);
    ++counts.failed;
    counts.last_failure = reason;
  }

  CURLcode attempt(CURL* handle, const std::string& url, Transfer& transfer) {
    curl_easy_reset(handle);  // connections stay
    check(curl_easy_setopt(handle, CURLOPT_URL, url.c_str()), "CURLOPT_URL");
    check(curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https"), "CURLOPT_PROTOCOLS_STR");
    check(curl_easy_setopt(handle, CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_2TLS}), "CURLOPT_HTTP_VERSION");
    check(curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L), "CURLOPT_NOSIGNAL");
    check(curl_easy_setopt(handle, CURLOPT_USERAGENT, "probewalk"), "CURLOPT_USERAGENT");
    check(curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, limits.connect_timeout_s), "CURLOPT_CONNECTTIMEOUT");
    check(curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, FetchLimits::kStall_bytes_s), "CURLOPT_LOW_SPEED_LIMIT");
    check(curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, limits.stall_timeout_s), "CURLOPT_LOW_SPEED_TIME");
    check(curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, &on_data), "CURLOPT_WRITEFUNCTION");
    check(curl_easy_setopt(handle, CURLOPT_WRITEDATA, static_cast<void*>(&transfer)), "CURLOPT_WRITEDATA");
    check(curl_easy_setopt(handle, CURLOPT_XFERINFOFUNCTION, &on_progress), "CURLOPT_XFERINFOFUNCTION");
    check(curl_easy_setopt(handle, CURLOPT_XFERINFODATA, static_cast<void*>(&transfer)), "CURLOPT_XFERINFODATA");
    check(curl_easy_setopt(handle, CURLOPT_NOPROGRESS, 0L), "CURLOPT_NOPROGRESS");
    if (!ca_file.empty()) check(curl_easy_setopt(handle, CURLOPT_CAINFO, ca_file.c_str()), "CURLOPT_CAINFO");
    if (transfer.resumed_at > 0) {
      const std::string range = fmt::format("{}-", transfer.resumed_at);
      check(curl_easy_setopt(handle, CURLOPT_RANGE, range.c_str()), "CURLOPT_RANGE");
    }
    const CURLcode code = curl_easy_perform(handle);
    curl_off_t came_bytes = 0;
    curl_easy_getinfo(handle, CURLINFO_SIZE_DOWNLOAD_T, &came_bytes);
    count_request(static_cast<std::size_t>(came_bytes));
    return code;
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
  std::string place = url;  // where redirections have led
  int redirections = 0, in_vain = 0;
  const std::function<void()> on_quiet = [&] { impl_->count_quiet(url); };
  while (true) {
    if (cancelled()) throw Interrupted(url + ": not wanted any more");
    Transfer transfer{handle.get(), body, limit_bytes, cancelled, body.size(), on_quiet, impl_->limits.quiet_s};
    const CURLcode code = impl_->attempt(handle.get(), place, transfer);
    long status = 0;
    curl_easy_getinfo(handle.get(), CURLINFO_RESPONSE_CODE, &status);
    if (cancelled()) throw Interrupted(url + ": not wanted any more");
    if (code == CURLE_OK && (status == 200 || status == 206)) {
      impl_->give_back(std::move(handle));
      return body;
    }
    if (code == CURLE_OK && is_redirection(status) && redirections++ < kMostRedirections) {
      if (std::string to = redirection(handle.get(), place); !to.empty()) {
        place = std::move(to);
        continue;
      }
    }
    const std::string reason = url + ": " + describe(code, status, transfer);
    impl_->count_failure(reason);
    if (is_for_good(code, status, transfer)) throw BadInput(reason);
    if (status == 416) body.clear();  // the file has changed under us
    in_vain = body.size() >= transfer.resumed_at + FetchLimits::kProgress_bytes ? 0 : in_vain + 1;
    if (in_vain >= impl_->limits.attempts) throw Unavailable(fmt::format("{}, {} times in a row", reason, in_vain));
    pause(impl_->limits.first_pause_s * static_cast<double>(1 << std::max(in_vain - 1, 0)), cancelled);
  }
}

FetchCounts HttpFetcher::counts() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->counts;
}

std::uint64_t HttpFetcher::times_quiet() const {
  return impl_->quiet;
}

std::string without_slash(std::string url) {
  while (url.ends_with('/')) url.pop_back();
  return url;
}

bool is_http_url(const std::string& text) {
  return text.starts_with("http://") || text.starts_with("https://");
}

}  // namespace probewalk
