// A file that appears under its name only when whole.
#pragma once

#include <filesystem>

namespace probewalk {

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target);
  ~TemporaryFile();  // removes what was not committed
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }  // where to write, in the target's folder
  void commit();                                               // renames; throws BadInput naming the target

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
  bool committed_ = false;
};

}  // namespace probewalk
