// Runs a fuzz target without libFuzzer, so that every build on every compiler does it: the kept corpus, then its small
// files cut off everywhere and with bits flipped, then mutations from a seed until time is up.
// usage: TARGET CORPUS_FOLDER_OR_FILE… [--seconds N] [--seed S] [--out FOLDER]
// A failure (a signal, an exception, a sanitizer's report, ten seconds without an end) leaves the input in --out.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz_target.h"

extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());

namespace {

namespace fs = std::filesystem;
using Input = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kSmall_bytes = 8192;        // larger files are neither cut off nor flipped, only mutated
constexpr std::size_t kMost_bytes = 32768;        // mutations do not grow beyond it
constexpr std::size_t kSystematic = 6000;         // cuts and flips of one file; evenly spread where there are more
constexpr unsigned kSecondsPerRun = 10;

// What a handler may look at: the input that runs, and where it goes if it is the last one.
const Input* g_running = nullptr;
char g_finding[4096];

void keep_running_input() {
  const Input* input = g_running;
  g_running = nullptr;  // once, whatever else goes wrong
  if (input == nullptr) return;
  const int fd = ::open(g_finding, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const bool written = fd >= 0 && ::write(fd, input->data(), input->size()) == static_cast<ssize_t>(input->size());
  const char* said = written ? "fuzz: the input is in " : "fuzz: the input could not be written to ";
  for (const char* text : {said, static_cast<const char*>(g_finding), "\n"}) {
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) break;
  }
  if (fd >= 0) ::close(fd);
}

void on_signal(int number) {
  if (number == SIGALRM) {
    constexpr std::string_view kSlow = "fuzz: one input takes longer than ten seconds\n";
    if (::write(STDERR_FILENO, kSlow.data(), kSlow.size()) < 0) _exit(70);
  }
  keep_running_input();
  _exit(70);
}

void catch_failures() {
  static std::uint8_t stack[65536];  // a handler needs one of its own when the stack is what ran out
  const stack_t alternative{.ss_sp = stack, .ss_flags = 0, .ss_size = sizeof stack};
  ::sigaltstack(&alternative, nullptr);
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_ONSTACK | static_cast<int>(SA_RESETHAND);
  for (const int number : {SIGABRT, SIGALRM, SIGBUS, SIGFPE, SIGILL}) ::sigaction(number, &action, nullptr);
  if (__sanitizer_set_death_callback != nullptr) {
    __sanitizer_set_death_callback(keep_running_input);
  } else {
    ::sigaction(SIGSEGV, &action, nullptr);
  }
}

void run(const Input& input) {
  g_running = &input;
  ::alarm(kSecondsPerRun);
  // A copy of exactly its size, so that AddressSanitizer sees a read beyond its end.
  const Input exact(input);
  try {
    LLVMFuzzerTestOneInput(exact.data(), exact.size());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz: exception: %s\n", error.what());
    std::abort();
  }
  ::alarm(0);
  g_running = nullptr;
}

// SplitMix64.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}
  std::size_t below(std::size_t count) {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<std::size_t>((z ^ (z >> 31)) % count);
  }
  std::uint8_t byte() { return static_cast<std::uint8_t>(below(256)); }

 private:
  std::uint64_t state_;
};

// One small change. Numbers that programmers forget about come more often than chance would bring them.
void mutate(Input& input, const std::vector<Input>& corpus, Numbers& numbers) {
  constexpr std::uint32_t kEdges[] = {0,       1,          0x7f,       0x80,       0xff,       0x7fff,    0xffff,
                                      0x10000, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0xff800000};
  if (input.empty()) input.push_back(numbers.byte());
  const std::size_t at = numbers.below(input.size());
  const std::size_t count = std::min(input.size() - at, 1 + numbers.below(16));
  const auto here = input.begin() + static_cast<std::ptrdiff_t>(at);
  switch (numbers.below(8)) {
    case 0: *here ^= static_cast<std::uint8_t>(1u << numbers.below(8)); break;
    case 1: *here = numbers.byte(); break;
    case 2: {
      const std::uint32_t edge = kEdges[numbers.below(std::size(kEdges))];
      std::memcpy(&*here, &edge, std::min<std::size_t>(4, input.size() - at));
      break;
    }
    case 3: input.erase(here, here + static_cast<std::ptrdiff_t>(count)); break;
    case 4: {
      const Input piece(here, here + static_cast<std::ptrdiff_t>(count));
      if (input.size() < kMost_bytes) input.insert(here, piece.begin(), piece.end());
      break;
    }
    case 5: {  // decimal digits, as JSON has them
      const std::string digits =
          std::to_string(static_cast<std::int64_t>(numbers.below(~std::size_t{0})) >> numbers.below(64));
      const auto digit = std::find_if(here, input.end(), [](std::uint8_t c) { return c >= '0' && c <= '9'; });
      const auto end = std::find_if(digit, input.end(), [](std::uint8_t c) { return c < '0' || c > '9'; });
      if (digit == input.end() || input.size() > kMost_bytes) break;
      input.insert(input.erase(digit, end), digits.begin(), digits.end());
      break;
    }
    case 6: {  // a piece of another file
      const Input& other = corpus[numbers.below(corpus.size())];
      if (other.empty()) break;
      const std::size_t from = numbers.below(other.size()), length = std::min(count * 4, other.size() - from);
      for (std::size_t k = 0; k < length && at + k < input.size(); ++k) input[at + k] = other[from + k];
      break;
    }
    default: std::swap(*here, input[numbers.below(input.size())]); break;
  }
}

Input read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return Input(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
}

[[noreturn]] void bad_usage(const std::string& what) {
  std::fprintf(stderr, "fuzz: %s; usage: TARGET CORPUS… [--seconds N] [--seed S] [--out FOLDER]\n", what.c_str());
  std::exit(2);
}

std::uint64_t number(std::string_view option, const char* text) {
  const std::string_view digits = text == nullptr ? "" : text;
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) {
    bad_usage(std::string(option) + " needs a whole number");
  }
  return value;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<fs::path> files;
  std::uint64_t seconds = 2, seed = 1;
  fs::path out = fs::current_path();
  for (int k = 1; k < argc; ++k) {
    const std::string_view argument = argv[k];
    const char* value = k + 1 < argc ? argv[k + 1] : nullptr;
    if (argument == "--seconds") {
      seconds = number(argument, value), ++k;
    } else if (argument == "--seed") {
      seed = number(argument, value), ++k;
    } else if (argument == "--out") {
      if (value == nullptr) bad_usage("--out needs a folder");
      out = value, ++k;
    } else if (fs::is_directory(argument)) {
      for (const auto& entry : fs::directory_iterator(argument)) files.push_back(entry.path());
    } else if (fs::is_regular_file(argument)) {
      files.emplace_back(argument);
    } else {
      bad_usage("there is no corpus at " + std::string(argument));
    }
  }
  if (files.empty()) bad_usage("no corpus");
  std::sort(files.begin(), files.end());
  const std::string name = fs::path(argv[0]).filename().string();
  const std::string finding = (fs::absolute(out) / (name + "-finding")).string();
  if (finding.size() >= sizeof g_finding) bad_usage("the path of --out is too long");
  std::copy(finding.begin(), finding.end(), g_finding);
  catch_failures();

  const auto begin = Clock::now();
  std::size_t executions = 0;
  const auto execute = [&](const Input& input) {
    run(input);
    ++executions;
  };
  std::vector<Input> corpus;
  for (const fs::path& file : files) corpus.push_back(read(file));
  for (const Input& input : corpus) execute(input);
  std::size_t cuts = 0, flips = 0;
  for (const Input& input : corpus) {
    if (input.size() > kSmall_bytes) continue;
    const std::size_t step = std::max<std::size_t>(1, 2 * input.size() / kSystematic);
    for (std::size_t at = 0; at < input.size(); at += step, ++cuts) {
      execute(Input(input.begin(), input.begin() + static_cast<std::ptrdiff_t>(at)));
    }
    for (std::size_t at = 0; at < input.size(); at += step, ++flips) {
      Input flipped = input;
      flipped[at] ^= static_cast<std::uint8_t>(1u << (at % 8));
      execute(flipped);
    }
  }
  Numbers numbers(seed);
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  std::size_t mutations = 0;
  for (; Clock::now() < end; ++mutations) {
    Input input = corpus[numbers.below(corpus.size())];
    for (std::size_t k = 1 + numbers.below(8); k > 0; --k) mutate(input, corpus, numbers);
    execute(input);
  }
  const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
  std::printf("%s: %zu executions in %.1f s: %zu files, %zu truncations, %zu flips, %zu mutations from seed %llu\n",
              name.c_str(), executions, took_s, corpus.size(), cuts, flips, mutations,
              static_cast<unsigned long long>(seed));
  return 0;
}
