#include "content/pack/file_io.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "content/error.h"

namespace probewalk {

namespace {

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  ~FileDescriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  // Closing is where some file systems report that a write has failed.
  bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

[[noreturn]] void fail(const char* what, const std::filesystem::path& file, const char* remedy) {
  throw BadInput(fmt::format("cannot {} {}: {}; {}", what, file.string(), std::strerror(errno), remedy));
}

bool write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

void flush_folder(const std::filesystem::path& folder) {
  const FileDescriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) ::fsync(fd.get());  // file systems that cannot do this lose nothing but the order of two renames
}

}  // namespace

std::vector<std::byte> read_file(const std::filesystem::path& file, std::uint64_t limit_bytes) {
  const FileDescriptor fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (fd.get() < 0) fail("read", file, "check the path");
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0) fail("read", file, "check the path");
  if (!S_ISREG(status.st_mode)) throw BadInput(fmt::format("cannot read {}: it is no regular file", file.string()));
  if (static_cast<std::uint64_t>(status.st_size) > limit_bytes) {
    throw BadInput(fmt::format("cannot read {}: it has {} bytes, at most {} are expected", file.string(),
                               status.st_size, limit_bytes));
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
  std::size_t at = 0;
  while (at < bytes.size()) {
    const ssize_t got = ::pread(fd.get(), bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("read", file, "check the disk");
    if (got == 0) break;  // it shrank; what there is will not match its hash
    at += static_cast<std::size_t>(got);
  }
  bytes.resize(at);
  return bytes;
}

void write_file_whole(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  const std::filesystem::path partial =
      file.parent_path() / fmt::format("{}{}-{}", kPartialFilePrefix, ::getpid(), file.filename().string());
  constexpr const char* kRemedy = "check free space and permissions";
  FileDescriptor fd(::open(partial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (fd.get() < 0) fail("write", file, kRemedy);
  if (!write_all(fd.get(), bytes) || ::fsync(fd.get()) != 0 || !fd.close() ||
      ::rename(partial.c_str(), file.c_str()) != 0) {
    const int cause = errno;
    ::unlink(partial.c_str());
    errno = cause;
    fail("write", file, kRemedy);
  }
  flush_folder(file.parent_path());
}

}  // namespace probewalk
