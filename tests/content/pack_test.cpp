// Packs on disk: written whole, read back, and damage found wherever it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "pack_fixture.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string refusal(const fs::path& pack) {
  try {
    Pack::open(pack);
  } catch (const BadInput& error) {
    return error.what();
  }
  return "accepted";
}

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

void flip_byte(const fs::path& file, std::streamoff at) {
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  stream.seekg(at);
  const int byte = stream.get();
  stream.seekp(at);
  stream.put(static_cast<char>(byte ^ 0x10));
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(ContentHash, IsXxh3Of128Bits) {
  // As `xxhsum -H2` prints it for an empty file.
  EXPECT_EQ(content_hash({}), "99aa06d3014798d86001c324468d497f");
}

TEST(Pack, RoundTrip) {
  const TemporaryFolder folder("pack-round-trip");
  const fs::path path = folder.path() / "house.probes";
  const Manifest written = write_small_pack(path, 2);
  const Pack pack = Pack::open(path);
  EXPECT_EQ(serialise_manifest(pack.manifest()), serialise_manifest(written));
  EXPECT_TRUE(same_level(pack.read_level(1, 1), noise_level(2, 16, 16, true, 116)));
  SilentProgress progress;
  EXPECT_THAT(pack.verify(progress), IsEmpty());
}

TEST(Pack, TwoWritesAreByteIdentical) {
  const TemporaryFolder folder("pack-twice");
  for (const char* name : {"a.probes", "b.probes"}) write_small_pack(folder.path() / name, 2);
  EXPECT_EQ(files_in(folder.path() / "a.probes/chunks"), files_in(folder.path() / "b.probes/chunks"));
  EXPECT_EQ(read_file(folder.path() / "a.probes/pack.json", 1 << 20),
            read_file(folder.path() / "b.probes/pack.json", 1 << 20));
}

TEST(Pack, FinishRemovesWhatTheManifestDoesNotNameAndNothingElse) {
  const TemporaryFolder folder("pack-surplus");
  const fs::path path = folder.path() / "house.probes";
  write_small_pack(path, 3);
  write_text(path / "chunks/.partial-1-abc", "left by a crash");
  write_text(path / "chunks/notes.txt", "mine");
  write_text(path / "rooms.png", "a picture");
  write_small_pack(path, 1);
  EXPECT_EQ(files_in(path / "chunks").size(), 2u + 1u);
  EXPECT_THAT(files_in(path), ElementsAre("chunks", "pack.json", "rooms.png"));
}

TEST(Pack, AChunkThatIsThereButDamagedIsWrittenAnew) {
  const TemporaryFolder folder("pack-rewrite");
  const auto chunk = encode_chunk(noise_level(1, 8, 8, false));
  PackWriter writer(folder.path());
  const std::string hash = writer.add_chunk(chunk);
  flip_byte(folder.path() / "chunks" / hash, 70);
  EXPECT_THROW(read_chunk_file(folder.path(), hash, chunk.size()), BadInput);
  EXPECT_EQ(writer.add_chunk(chunk), hash);
  EXPECT_EQ(read_chunk_file(folder.path(), hash, chunk.size()), chunk);
}

TEST(Pack, AManifestIsNotWrittenOverMissingChunks) {
  const TemporaryFolder folder("pack-missing-chunk");
  PackWriter writer(folder.path());
  EXPECT_THROW(writer.finish(small_manifest({{{std::string(32, '0'), 8, 8, 10, 10, -1.0}}})), BadInput);
  EXPECT_FALSE(fs::exists(folder.path() / "pack.json"));
}

TEST(Pack, EveryFlippedByteOfAChunkIsFound) {
  const TemporaryFolder folder("pack-flip");
  const auto chunk = encode_chunk(noise_level(1, 8, 8, true));
  const std::string hash = PackWriter(folder.path()).add_chunk(chunk);
  const fs::path file = folder.path() / "chunks" / hash;
  for (std::size_t at = 0; at < chunk.size(); ++at) {
    flip_byte(file, static_cast<std::streamoff>(at));
    ASSERT_THROW(read_chunk_file(folder.path(), hash, chunk.size()), BadInput) << at;
    flip_byte(file, static_cast<std::streamoff>(at));
  }
  EXPECT_EQ(read_chunk_file(folder.path(), hash, chunk.size()), chunk);
}

TEST(Pack, VerifyNamesEachDamagedChunk) {
  const TemporaryFolder folder("pack-verify");
  const Manifest m = write_small_pack(folder.path(), 2);
  flip_byte(folder.path() / "chunks" / m.rooms[0].levels[1].chunk, 200);
  fs::remove(folder.path() / "chunks" / m.rooms[1].levels[0].chunk);
  fs::resize_file(folder.path() / "chunks" / m.rooms[1].levels[1].chunk, 100);
  SilentProgress progress;
  const auto damage = Pack::open(folder.path()).verify(progress);
  EXPECT_THAT(damage, ElementsAre(testing::AllOf(HasSubstr("room hall, level 1"), HasSubstr(m.rooms[0].levels[1].chunk),
                                                 HasSubstr("do not match")),
                                  HasSubstr("room kitchen-1, level 0"),
                                  testing::AllOf(HasSubstr("room kitchen-1, level 1"), HasSubstr("100 of"))));
}

TEST(Pack, ASoundChunkInTheWrongPlaceIsFound) {
  const TemporaryFolder folder("pack-swap");
  PackWriter writer(folder.path());
  const auto chunk = encode_chunk(noise_level(2, 8, 8, false));
  const LevelEntry entry{writer.add_chunk(chunk), 16, 8, chunk.size(), 10, -1.0};
  writer.finish(small_manifest({{entry}}));
  EXPECT_THROW(Pack::open(folder.path()).read_level(0, 0), BadInput);
}

// Links are followed, as everywhere on disk, but a chunk is what its hash says wherever it lies: a link leaks nothing,
// and writing replaces the link, never what it points to.
TEST(Pack, LinksAmongTheChunksReadOnlyWhatTheirNamesSay) {
  const TemporaryFolder folder("pack-links");
  const fs::path chunks = folder.path() / "p/chunks";
  const auto sound = encode_chunk(noise_level(1, 8, 8, false));
  const std::string hash = PackWriter(folder.path() / "p").add_chunk(sound);
  const auto link_to = [&](const fs::path& target) {
    fs::remove(chunks / hash);
    fs::create_symlink(target, chunks / hash);
  };
  const auto refused_with = [&](const fs::path& target) -> std::string {
    link_to(target);
    try {
      read_chunk_file(folder.path() / "p", hash, sound.size());
    } catch (const BadInput& error) {
      return error.what();
    }
    return "accepted";
  };
  fs::rename(chunks / hash, folder.path() / "elsewhere");
  EXPECT_EQ(refused_with(folder.path() / "elsewhere"), "accepted");
  const std::string secret(sound.size(), 's');
  write_text(folder.path() / "secret", secret);
  EXPECT_THAT(refused_with(folder.path() / "secret"),
              testing::AllOf(HasSubstr("damaged"), testing::Not(HasSubstr("sss"))));
  EXPECT_THAT(refused_with("/dev/zero"), HasSubstr("no regular file"));
  EXPECT_THAT(refused_with(chunks), HasSubstr("no regular file"));
  EXPECT_THAT(refused_with("nowhere"), HasSubstr("cannot read"));
  EXPECT_THAT(refused_with(chunks / hash), HasSubstr("cannot read"));  // to itself

  link_to(folder.path() / "secret");
  PackWriter(folder.path() / "p").add_chunk(sound);
  EXPECT_FALSE(fs::is_symlink(chunks / hash));
  EXPECT_EQ(read_chunk_file(folder.path() / "p", hash, sound.size()), sound);
  const auto kept = read_file(folder.path() / "secret", secret.size());
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(kept.data()), kept.size()), secret);
}

TEST(Pack, ALevelThatIsLargerThanItsManifestSaysIsRefusedBeforeItIsDecompressed) {
  const TemporaryFolder folder("pack-understated");
  Manifest m = write_small_pack(folder.path(), 1);
  // The sections are rubbish: only the header can have been looked at.
  auto chunk = encode_chunk(noise_level(2, 16, 16, true, 16));
  std::fill(chunk.begin() + 200, chunk.end(), std::byte{0xff});
  const auto refused = [&](const Manifest& manifest) -> std::string {
    try {
      decode_level(manifest, 0, 1, chunk);
    } catch (const BadInput& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refused(m), HasSubstr("position"));  // what its first section makes
  Manifest fewer = m;
  fewer.rooms[0].probe_count = 1;
  EXPECT_THAT(refused(fewer), HasSubstr("number of probes differ"));
  Manifest smaller = m;
  smaller.rooms[0].levels[1].radiance_size = 8;
  EXPECT_THAT(refused(smaller), HasSubstr("map sizes differ"));
  m.rooms[0].levels[1].bytes_device = 2 * device_probe_bytes(16, 16) - 1;
  EXPECT_THAT(refused(m), HasSubstr("bytes on the device differ"));
}

TEST(Pack, WhatIsNoPackIsRefusedWithTheRemedy) {
  const TemporaryFolder folder("pack-foreign");
  EXPECT_THAT(refusal(folder.path() / "absent.probes"), HasSubstr("probewalk bake"));
  EXPECT_THAT(refusal(folder.path()), HasSubstr("is not a pack"));
  write_text(folder.path() / "scene.glb", "glTF");
  EXPECT_THAT(refusal(folder.path() / "scene.glb"), HasSubstr("is not a pack"));
  write_text(folder.path() / "pack.json", "{\"name\": \"npm\"}");
  EXPECT_THAT(refusal(folder.path()), HasSubstr("is not the manifest"));
  write_small_pack(folder.path(), 1);
  fs::resize_file(folder.path() / "pack.json", 500);
  EXPECT_THAT(refusal(folder.path()), HasSubstr("truncated"));
  fs::remove(folder.path() / "pack.json");
  ASSERT_EQ(::mkfifo((folder.path() / "pack.json").c_str(), 0600), 0);
  EXPECT_THAT(refusal(folder.path()), HasSubstr("no regular file"));
}

TEST(Pack, NamesNeverBecomePaths) {
  const TemporaryFolder folder("pack-traversal");
  write_text(folder.path() / "secret", "secret");
  fs::create_directories(folder.path() / "p/chunks");
  for (const char* name : {"../../secret", "/etc/passwd", "", "..", "99AA06D3014798D86001C324468D497F"}) {
    EXPECT_THROW(read_chunk_file(folder.path() / "p", name, 6), BadInput) << name;
  }
}

TEST(Pack, AFolderThatCannotBeMadeIsOneClearError) {
  const TemporaryFolder folder("pack-blocked");
  write_text(folder.path() / "file", "");
  EXPECT_THROW(PackWriter(folder.path() / "file"), BadInput);
}

}  // namespace
}  // namespace probewalk
