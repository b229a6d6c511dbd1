// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "slamdb/edit/repair/recover.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

namespace slamdb {
namespace {

// A store of two atlases, of which one has two revisions, on a file system in memory, where there is one, and its
// bytes.
class Template {
 public:
  Template() : path_(Folder() + "/slamdb_fuzz_" + std::to_string(::getpid()) + ".db") {
    atlas_ = SynthesizeAtlas({.inertial = true, .maps = 2, .keyframes = 4, .points = 20, .features = 60, .threads = 1});
    for (const char* name : {"one", "two"}) WriteAtlas(atlas_, path_ + "#" + name);
    Atlas next = atlas_;
    next.maps[0].points.pop_back();
    next.maps[0].keyframes[1].camera_from_world.translation.x() += 1;
    next.maps[1].keyframes[2].features.map_points.assign(60, MapPointId());
    Store::OpenForWriting(path_).Save("two", next);
    std::ifstream stream(path_, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
    hash_ = HashOf(atlas_, 1);
  }
  ~Template() { Remove(); }
  Template(const Template&) = delete;
  Template& operator=(const Template&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t hash() const { return hash_; }

  // Writes the store with patches: each four bytes for the place, one for how many bytes follow (modulo 8), and these.
  void WritePatched(const std::uint8_t* data, std::size_t size) const {
    std::string patched = bytes_;
    for (std::size_t at = 0; at + 5 <= size;) {
      std::uint32_t place = 0;
      std::memcpy(&place, data + at, 4);
      std::size_t length = 1 + data[at + 4] % 8;
      at += 5;
      length = std::min({length, size - at, patched.size() - place % patched.size()});
      patched.replace(place % patched.size(), length, reinterpret_cast<const char*>(data + at), length);
      at += length;
    }
    Remove();
    std::ofstream(path_, std::ios::binary).write(patched.data(), static_cast<std::streamsize>(patched.size()));
  }

 private:
  static std::string Folder() {
    return std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path().string();
  }
  void Remove() const {
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) std::filesystem::remove(path_ + suffix);
  }

  std::string path_, bytes_;
  Atlas atlas_;
  std::uint64_t hash_ = 0;
};

}  // namespace
}  // namespace slamdb

// A store of which any bytes are others. What is loaded of it is what was saved, or is refused; what is recovered can
// be told.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  static const Template store;
  store.WritePatched(data, size);
  ReadOptions options;
  options.threads = 1;
  for (const char* name : {"one", "two@1"})
    fuzz::MayRefuse([&] {
      const Atlas loaded = ReadAtlas(store.path() + "#" + name, options);
      fuzz::Require(HashOf(loaded, 1) == store.hash(), "what is loaded is what was saved");
    });
  fuzz::MayRefuse([&] {
    for (const StoredAtlas& atlas : Store::Open(store.path()).List()) fuzz::Require(!atlas.name.empty(), "names");
  });
  fuzz::MayRefuse([&] {
    const MapQuery query{
        .times = MapQuery::Times{0, 1e12}, .keyframes = MapQuery::Ids{0, 100}, .near = MapQuery::Ball{}};
    fuzz::Require(Store::Open(store.path()).Find(query).size() <= 2, "what is found is there");
  });
  fuzz::MayRefuse([&] {
    const std::vector<Descriptor> picture(50, Descriptor{1, 2, 3});
    const StoredPlaces places =
        Store::Open(store.path()).PlacesLike(std::vector<std::span<const Descriptor>>{picture}, {.threads = 1});
    for (const StoredPlace& place : places.by_picture.at(0)) fuzz::Require(place.likeness > 0, "what is alike is so");
  });
  fuzz::MayRefuse([&] {
    Salvage salvage = SalvageAtlas(Location{store.path(), "one"}, options);
    fuzz::Require(!ToJson(RecoverSalvage(salvage, {.threads = 1})).empty(), "the losses can be told");
  });
  return 0;
}
