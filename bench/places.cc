// SPDX-License-Identifier: BSD-3-Clause
// slamdb_places_bench FOLDER [SIZES]: how long it takes to find a place, on one core, as markdown.
//   in a store: which of its atlases know a picture, from opening the store to the pose. SIZES: 50,200 atlases of 60
//   keyframes with 1,000 features, each of a room of its own; the stores are made in FOLDER, and stay there
//   in a list of bags of words: PlaceIndex, for 625 to 10,000 keyframes
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <sstream>

#include "slamdb/align/place_index.h"
#include "slamdb/many/locate_in_store.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

template <class Work>
double SecondsOf(int times, const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  for (int time = 0; time < times; ++time) work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / times;
}

// Two sessions in one room; the second is what is asked.
Atlas MakeRoom(std::uint64_t seed) {
  return SynthesizeAtlas({.sensor = Sensor::kStereo,
                          .maps = 2,
                          .keyframes = 60,
                          .points = 3000,
                          .features = 1000,
                          .flipped_bits = 24,
                          .sessions = SessionOptions{.overlap = 0.6},
                          .seed = seed});
}

void FillStore(const std::string& path, std::size_t atlases) {
  Store store = Store::OpenForWriting(path, {.sync = false});
  for (std::size_t i = store.Names().size(); i < atlases; ++i) {
    Atlas room = MakeRoom(i + 1);
    room.maps.pop_back();
    store.Save("room" + std::to_string(i + 1), room);
  }
}

void MeasureStore(const std::string& folder, std::size_t atlases) {
  const std::string path = folder + "/rooms" + std::to_string(atlases) + ".db";
  FillStore(path, atlases);
  const std::size_t number = std::min<std::size_t>(17, atlases);
  const Atlas room = MakeRoom(number);
  std::vector<PictureFeatures> pictures;
  for (const KeyFrame& keyframe : room.maps[1].keyframes) pictures.push_back(FeaturesOf(room, keyframe));
  const auto ask = [&](std::span<const PictureFeatures> asked) {
    Store store = Store::Open(path);
    const LocatedInStore located =
        LocateInStore(store, asked, [&](std::size_t i, const Atlas&) { return asked[i]; }, {.threads = 1});
    std::size_t found = 0;
    for (const std::vector<AtlasLocalization>& answers : located.pictures)
      found += !answers.empty() && answers[0].localization.verdict == LocateVerdict::kFound &&
               answers[0].atlas == "room" + std::to_string(number);
    return found;
  };
  std::size_t found = ask(pictures), next = 0;
  const double one = SecondsOf(static_cast<int>(pictures.size()),
                               [&] { ask(std::span(pictures).subspan(next++ % pictures.size(), 1)); });
  const double all = SecondsOf(1, [&] { found = ask(pictures); });
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  std::cout << "| store of " << atlases << " atlases, " << bytes / 1e6 << " MB | a picture | " << one << " s |\n";
  std::cout << "| the same | " << pictures.size() << " pictures, " << found << " found | " << all << " s |\n";
}

void MeasureIndex(std::size_t keyframes) {
  std::vector<BagOfWords> bags;
  for (std::uint64_t seed = 1; bags.size() < keyframes; ++seed)
    for (Map& map : MakeRoom(seed).maps)
      for (KeyFrame& keyframe : map.keyframes)
        if (bags.size() < keyframes) bags.push_back(std::move(keyframe.features.bag_of_words));
  std::vector<const BagOfWords*> pointers;
  for (const BagOfWords& bag : bags) pointers.push_back(&bag);
  const double make = SecondsOf(3, [&] { const PlaceIndex index(pointers); });
  const PlaceIndex index(pointers);
  std::size_t next = 0;
  float sum = 0;
  const double query = SecondsOf(200, [&] { sum += index.Query(bags[next++ % bags.size()])[0]; });
  std::cout << "| PlaceIndex of " << keyframes << " keyframes | made | " << make << " s |\n";
  std::cout << "| the same | a query | " << query << " s |" << (sum < 0 ? " " : "") << "\n";
}

}  // namespace
}  // namespace slamdb

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  std::cout << "| of | what | time |\n|---|---|---|\n";
  std::istringstream sizes(argc > 2 ? argv[2] : "50,200");
  for (std::string size; std::getline(sizes, size, ',');) slamdb::MeasureStore(argv[1], std::stoul(size));
  for (std::size_t keyframes = 625; keyframes <= 10'000; keyframes *= 2) slamdb::MeasureIndex(keyframes);
}
