// One file from a web server, as far as it goes: retries with growing pauses, resumed where it broke off, given up when
// nobody wants it any more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace probewalk {

struct FetchLimits {
  int attempts = 4;
  double first_pause_s = 0.25;  // before the second attempt; doubles
  long connect_timeout_s = 10;
  long stall_timeout_s = 15;  // with less than a byte a second
};

// Connections are kept and used again. Thread-safe: as many fetches at a time as threads ask.
class HttpFetcher {
 public:
  explicit HttpFetcher(const FetchLimits& limits = {});
  ~HttpFetcher();
  HttpFetcher(const HttpFetcher&) = delete;
  HttpFetcher& operator=(const HttpFetcher&) = delete;

  // The whole body; at most limit_bytes of it are ever held. Throws BadInput at once where trying again is no use (404
  // and its like, an answer that is too long), Unavailable after the last attempt, both naming the address and what
  // happened; Interrupted soon after `cancelled`, which is asked often, says true.
  std::vector<std::byte> get(const std::string& url, std::uint64_t limit_bytes,
                             const std::function<bool()>& cancelled) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

bool is_http_url(const std::string& text);
// The address of a folder, as names can be hung on to it.
std::string without_slash(std::string url);

}  // namespace probewalk
