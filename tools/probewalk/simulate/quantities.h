// Numbers with units on the command line: 50MB/s, 20ms, 1%.
#pragma once

#include <string>

namespace probewalk {

// "50MB/s", "1.5GB/s", "800kB/s", "20Mbit/s": bytes a second. Throws BadUsage naming the option.
double parse_rate(const std::string& option, const std::string& text);
// "20ms", "0.3s": seconds, 0 to 3600.
double parse_time_s(const std::string& option, const std::string& text);
// "1%" or "0.01": a share of 1.
double parse_share(const std::string& option, const std::string& text);

}  // namespace probewalk
