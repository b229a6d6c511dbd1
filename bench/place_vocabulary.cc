// SPDX-License-Identifier: BSD-3-Clause
// slamdb_place_vocabulary FILE ATLAS...: trains the words by which a store recognises places, on descriptors of
// atlases, as many of each. schema/0005_places.words is what it makes of session_a, stereo_inertial, mono_dist,
// fisheye_stereo, race_mono and mono_small, in this order. Layout: schema/store.md.
#include <fstream>
#include <iostream>

#include "slamdb/align/detail/train_vocabulary.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/detail/packing.h"
#include "slamdb/model/picture_features.h"

namespace {

constexpr std::size_t kOfEach = 20'000;  // descriptors

void AddSample(const slamdb::Atlas& atlas, std::vector<slamdb::Descriptor>& sample) {
  std::size_t total = 0, at = 0;
  for (const slamdb::Map& map : atlas.maps)
    for (const slamdb::KeyFrame& keyframe : map.keyframes) total += keyframe.features.descriptors.size();
  const std::size_t step = total / kOfEach + 1;
  for (const slamdb::Map& map : atlas.maps)
    for (const slamdb::KeyFrame& keyframe : map.keyframes)
      for (const slamdb::Descriptor& descriptor : keyframe.features.descriptors)
        if (at++ % step == 0) sample.push_back(descriptor);
}

// Adds to `counts`, by word, in how many keyframes it is, and returns how many there are.
std::size_t CountWords(const slamdb::Atlas& atlas, const slamdb::VocabularyTree& tree, std::vector<double>& counts) {
  std::size_t keyframes = 0;
  for (const slamdb::Map& map : atlas.maps)
    for (const slamdb::KeyFrame& keyframe : map.keyframes) {
      const std::span<const slamdb::Descriptor> descriptors = slamdb::LeftDescriptors(keyframe.features);
      ++keyframes;
      for (const std::uint32_t word :
           slamdb::ComputeWords(tree, {descriptors.begin(), descriptors.end()}).bag_of_words.words)
        ++counts[word];
    }
  return keyframes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  std::vector<slamdb::Atlas> atlases;
  for (int i = 2; i < argc; ++i) atlases.push_back(slamdb::ReadAtlas(slamdb::Location(argv[i])));
  std::vector<slamdb::Descriptor> sample;
  for (const slamdb::Atlas& atlas : atlases) AddSample(atlas, sample);
  const slamdb::VocabularyTree tree = slamdb::detail::TrainVocabulary(sample, 16, 3);
  slamdb::detail::ByteWriter out;
  for (std::size_t node = 0; node < tree.node_count(); ++node)
    out.Put(static_cast<std::uint8_t>(tree.first_child[node + 1] - tree.first_child[node]));
  for (std::size_t node = 1; node < tree.node_count(); ++node) out.Put(tree.descriptors[node]);
  std::vector<double> counts(tree.word_count, 0);
  std::size_t keyframes = 0;
  for (const slamdb::Atlas& atlas : atlases) keyframes += CountWords(atlas, tree, counts);
  for (const double count : counts)  // one of no keyframe is taken to be in half a one
    out.Put(static_cast<std::uint16_t>(65535 * (count + 0.5) / (static_cast<double>(keyframes) + 1)));
  std::ofstream(argv[1], std::ios::binary)
      .write(reinterpret_cast<const char*>(out.bytes().data()), static_cast<std::streamsize>(out.bytes().size()));
  std::cout << sample.size() << " descriptors of " << keyframes << " keyframes, " << tree.word_count << " words, "
            << tree.node_count() << " nodes\n";
}
