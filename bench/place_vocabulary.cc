// SPDX-License-Identifier: BSD-3-Clause
// slamdb_place_vocabulary FILE ATLAS...: trains the words by which a store recognises places, on descriptors of
// atlases, as many of each. schema/0005_places.words is what it makes of session_a, stereo_inertial, mono_dist,
// fisheye_stereo, race_mono and mono_small, in this order. Layout: schema/store.md.
#include <fstream>
#include <iostream>

#include "slamdb/align/detail/train_vocabulary.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/detail/packing.h"

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

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  std::vector<slamdb::Descriptor> sample;
  for (int i = 2; i < argc; ++i) AddSample(slamdb::ReadAtlas(slamdb::Location(argv[i])), sample);
  const slamdb::VocabularyTree tree = slamdb::detail::TrainVocabulary(sample, 16, 3);
  slamdb::detail::ByteWriter out;
  for (std::size_t node = 0; node < tree.node_count(); ++node)
    out.Put(static_cast<std::uint8_t>(tree.first_child[node + 1] - tree.first_child[node]));
  for (std::size_t node = 1; node < tree.node_count(); ++node) out.Put(tree.descriptors[node]);
  std::ofstream(argv[1], std::ios::binary)
      .write(reinterpret_cast<const char*>(out.bytes().data()), static_cast<std::streamsize>(out.bytes().size()));
  std::cout << sample.size() << " descriptors, " << tree.word_count << " words, " << tree.node_count() << " nodes\n";
}
