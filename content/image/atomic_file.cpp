#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "content/error.h"
#include "content/image/image.h"
#include "content/image/temporary_file.h"

namespace probewalk {

TemporaryFile::TemporaryFile(const std::filesystem::path& target)
    : target_(target), path_(target.string() + fmt::format(".{}.part", ::getpid())) {}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(path_, ignored);
}

void TemporaryFile::commit() {
  std::error_code error;
  std::filesystem::rename(path_, target_, error);
  if (error) throw BadInput(fmt::format("{}: cannot be written ({})", target_.string(), error.message()));
  committed_ = true;
}

void write_file_atomically(const std::filesystem::path& file, const std::string& bytes) {
  TemporaryFile temporary(file);
  errno = 0;
  std::ofstream stream(temporary.path(), std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) {
    throw BadInput(fmt::format("{}: cannot be written ({}); check the folder and its free space", file.string(),
                               errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
  temporary.commit();
}

}  // namespace probewalk
