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
  static constexpr long kStall_bytes_s = 1024;            // less than that is no delivery
  static constexpr std::size_t kProgress_bytes = 1 << 16;  // an attempt that brought so much was none in vain
  int attempts = 4;  // in vain, one after the other
  double first_pause_s = 0.25;  // before the second attempt; doubles
  long connect_timeout_s = 10;
  long stall_timeout_s = 8;  // with less than kStall_bytes_s
  double quiet_s = 2.0;      // with less than that: worth a word
};

struct FetchCounts {
  std::uint64_t requests = 0;
  std::uint64_t failed = 0;  // those that did not bring what was missing
  std::uint64_t bytes = 0;   // of bodies
  std::string last_failure;  // the address, and what happened
  std::string last_quiet;    // the address that was waited for as long as FetchLimits::quiet_s; empty = none
};

// Servers are trusted by the system's certificates, or those in the file that CURL_CA_BUNDLE or SSL_CERT_FILE names.
// Connections are kept and used again. Thread-safe: as many fetches at a time as threads ask.
class HttpFetcher {
 public:
  explicit HttpFetcher(const FetchLimits& limits = {});
  ~HttpFetcher();
  HttpFetcher(const HttpFetcher&) = delete;
  HttpFetcher& operator=(const HttpFetcher&) = delete;

  // The whole body, at most limit_bytes of it; redirections are followed on the same server, to https too. Throws BadInput
  // at once where trying again is no use (404 and its like, an answer that is too long), Unavailable after the last attempt,
  // both naming the address and what happened; Interrupted soon after `cancelled`, which is asked often, says true.
  std::vector<std::byte> get(const std::string& url, std::uint64_t limit_bytes,
                             const std::function<bool()>& cancelled) const;
  // So far. Any thread.
  FetchCounts counts() const;
  // How often an answer was waited for so long, so far. Any thread, any time: it is a number.
  std::uint64_t times_quiet() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

bool is_http_url(const std::string& text);
// The address of a folder, as names can be hung on to it.
std::string without_slash(std::string url);

}  // namespace probewalk
