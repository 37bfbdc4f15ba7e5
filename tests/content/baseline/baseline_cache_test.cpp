#include "content/cache_folder.h"
#include "content/baseline/baseline_cache.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack_fixture.h"
#include "support/room_pack.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;

// Counts the rays' rows, so that it shows whether maps were made or read.
class CountingProgress final : public Progress {
 public:
  void begin(std::string_view, std::uint64_t, std::string_view) override { ++stages; }
  void advance(std::uint64_t) override {}
  void note(std::string_view line) override { notes.emplace_back(line); }
  int stages = 0;
  std::vector<std::string> notes;
};

class BaselineCacheTest : public testing::Test {
 protected:
  BaselineCacheTest() {
    test::write_room_pack(folder.path() / "room.probes");
    scene.content_hash = "0123456789abcdef0123456789abcdef";
  }
  BaselineMaps cached(Progress& progress) const {
    return cached_baseline_maps(scene, Pack::open(folder.path() / "room.probes"), 16, folder.path() / "cache", progress);
  }
  fs::path only_file() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder.path() / "cache")) files.push_back(entry.path());
    EXPECT_EQ(files.size(), 1u);
    return files.front();
  }

  TemporaryFolder folder{"baseline-cache"};
  Scene scene = test::furnished_room();
};

void expect_equal(const BaselineMaps& a, const BaselineMaps& b) {
  ASSERT_EQ(a.n, b.n);
  ASSERT_EQ(a.farthest_m, b.farthest_m);
  ASSERT_EQ(a.probes.size(), b.probes.size());
  for (std::size_t k = 0; k < a.probes.size(); ++k) {
    EXPECT_EQ(a.probes[k].distance_m, b.probes[k].distance_m);
    EXPECT_EQ(a.probes[k].normal, b.probes[k].normal);
    EXPECT_EQ(a.probes[k].minimum_m, b.probes[k].minimum_m);
    EXPECT_EQ(a.probes[k].record.mean_m, b.probes[k].record.mean_m);
    EXPECT_EQ(a.probes[k].record.box_max_m, b.probes[k].record.box_max_m);
  }
}

TEST_F(BaselineCacheTest, MapsAreMadeOnceAndReadAsTheyWere) {
  CountingProgress first, second;
  const BaselineMaps made = cached(first);
  EXPECT_EQ(made.probes.size(), 8u);
  EXPECT_EQ(first.stages, 1);
  const BaselineMaps read = cached(second);
  EXPECT_EQ(second.stages, 0);
  EXPECT_TRUE(second.notes.empty());
  expect_equal(made, read);
}

TEST_F(BaselineCacheTest, ADamagedFileIsMadeAnewAndSaidSo) {
  SilentProgress silent;
  const BaselineMaps made = cached(silent);
  const fs::path file = only_file();
  const std::vector<std::byte> whole = read_file(file, 1u << 30);
  const auto expect_made_anew = [&](const std::vector<std::byte>& bytes, const char* what) {
    write_file_whole(file, bytes);
    CountingProgress progress;
    expect_equal(made, cached(progress));
    EXPECT_EQ(progress.stages, 1) << what;
    EXPECT_EQ(progress.notes.size(), 1u) << what;
    EXPECT_EQ(read_file(file, 1u << 30), whole) << what;
  };
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{100}, whole.size() / 2, whole.size() - 1}) {
    expect_made_anew({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}, "truncated");
  }
  std::vector<std::byte> longer = whole;
  longer.push_back(std::byte{0});
  expect_made_anew(longer, "longer");
  for (const std::size_t at : {std::size_t{3}, std::size_t{20}, std::size_t{60}, std::size_t{110}, whole.size() - 2}) {
    std::vector<std::byte> edited = whole;
    edited[at] ^= std::byte{0x10};
    expect_made_anew(edited, "edited");
  }
}

TEST_F(BaselineCacheTest, AFileOfAnotherSceneOrSizeIsNotTaken) {
  SilentProgress silent;
  cached(silent);
  const Pack pack = Pack::open(folder.path() / "room.probes");
  const BaselineKey key = baseline_key(scene, pack, 16);
  EXPECT_TRUE(read_baseline_file(only_file(), key));
  std::string why;
  BaselineKey other = key;
  other.scene_hash = "f123456789abcdef0123456789abcdef";
  EXPECT_NE(baseline_file_name(other), baseline_file_name(key));
  EXPECT_FALSE(read_baseline_file(only_file(), other, &why));
  EXPECT_NE(why.find("another scene"), std::string::npos) << why;
  other = key;
  other.pack_hash[5] ^= 1;
  EXPECT_FALSE(read_baseline_file(only_file(), other, &why));
  other = key;
  other.n = 32;
  EXPECT_FALSE(read_baseline_file(only_file(), other, &why));
  why.clear();
  EXPECT_FALSE(read_baseline_file(folder.path() / "nothing", key, &why));
  EXPECT_TRUE(why.empty());
}

TEST_F(BaselineCacheTest, AFolderThatCannotBeWrittenIsNotedNotFatal) {
  std::ofstream(folder.path() / "cache") << "a file where the folder should be";
  CountingProgress progress;
  EXPECT_EQ(cached(progress).probes.size(), 8u);
  ASSERT_EQ(progress.notes.size(), 1u);
  EXPECT_NE(progress.notes.front().find("not kept"), std::string::npos);
}

TEST(BaselineFolder, FollowsTheEnvironment) {
  const char* old_cache = std::getenv("XDG_CACHE_HOME");
  const std::string kept = old_cache != nullptr ? old_cache : "";
  ::setenv("XDG_CACHE_HOME", "/tmp/elsewhere", 1);
  EXPECT_EQ(default_cache_folder(), fs::path("/tmp/elsewhere/probewalk"));
  ::setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_TRUE(default_cache_folder().is_absolute());
  if (old_cache != nullptr) {
    ::setenv("XDG_CACHE_HOME", kept.c_str(), 1);
  } else {
    ::unsetenv("XDG_CACHE_HOME");
  }
}

}  // namespace
}  // namespace probewalk
