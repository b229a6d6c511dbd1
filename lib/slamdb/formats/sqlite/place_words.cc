// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/place_words.h"

#include <algorithm>
#include <cstring>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/place_tree.h"
#include "slamdb/model/detail/bit_columns.h"
#include "slamdb/model/picture_features.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kWords = 8 * sizeof(PlaceWords);

// The tree of schema/0005_places.words: how many children each node has, breadth first, then the centres of all but the
// root, then how frequent each word is.
class PlaceTree {
 public:
  PlaceTree() : centres_(CentresOf(PlaceTreeBytes())) {
    std::uint32_t next = 1, words = 0;
    for (const unsigned char children : PlaceTreeBytes().first(centres_.size())) {
      nodes_.push_back({next, children, children == 0 ? words++ : 0});
      next += children;
    }
  }

  // Calls visit(word) for the word of each descriptor: down to the child at the least distance, the first of equals.
  // All go down one level before any goes down the next, so that the processor need not wait for one to end.
  template <class Visit>
  void ForEachWord(std::span<const Descriptor> descriptors, Visit visit) const {
    struct Walker {
      detail::Bits bits;
      Node node;
    };
    std::vector<Walker> walkers;
    walkers.reserve(descriptors.size());
    for (const Descriptor& descriptor : descriptors) walkers.push_back({detail::BitsOf(descriptor), nodes_[0]});
    while (!walkers.empty()) {
      std::size_t left = 0;
      for (Walker& walker : walkers) {
        walker.node = Nearest(walker.node, walker.bits);
        if (walker.node.children == 0)
          visit(walker.node.word);
        else
          walkers[left++] = walker;
      }
      walkers.resize(left);
    }
  }

 private:
  struct Node {
    std::uint32_t first;  // of its children
    std::uint8_t children;
    std::uint32_t word;  // of a leaf
  };

  // Of its children.
  Node Nearest(const Node& node, const detail::Bits& bits) const {
    std::array<std::uint16_t, 256> distances;
    centres_.DistancesTo(bits, node.first, node.children, distances.data());
    std::uint32_t least = ~std::uint32_t{0};  // a distance, and in its lowest byte whose it is
    for (std::uint32_t i = 0; i < node.children; ++i) least = std::min(least, std::uint32_t{distances[i]} << 8 | i);
    return nodes_[node.first + (least & 0xff)];
  }

  static detail::BitColumns CentresOf(std::span<const unsigned char> bytes) {
    const std::size_t size = bytes.size() - kWords * sizeof(std::uint16_t);
    std::vector<detail::Bits> centres((size + sizeof(Descriptor)) / (1 + sizeof(Descriptor)));
    std::memcpy(&centres[1], &bytes[centres.size()], (centres.size() - 1) * sizeof(Descriptor));
    return detail::BitColumns(centres);
  }

  detail::BitColumns centres_;  // by node
  std::vector<Node> nodes_;
};

// A row of keyframe_words as it is stored.
struct StoredWords {
  std::int64_t row = 0, hash = 0;
};

std::vector<StoredWords> ReadStored(Database& database, std::int64_t map) {
  Statement statement(database,
                      "SELECT keyframe, hash, length(words) FROM keyframe_words WHERE keyframe BETWEEN ?1 AND ?2 "
                      "ORDER BY keyframe",
                      "table keyframe_words");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  std::vector<StoredWords> stored;
  while (statement.Step())
    if (statement.Integer(2) == sizeof(PlaceWords)) stored.push_back({statement.Integer(0), statement.Integer(1)});
  return stored;
}

class Writer {
 public:
  explicit Writer(Database& database)
      : insert_(database, "INSERT OR REPLACE INTO keyframe_words VALUES (?1, ?2, ?3)", "table keyframe_words") {}
  void Write(std::int64_t row, std::int64_t hash, const PlaceWords& words) {
    insert_.Bind(1, row).Bind(2, hash).BindBlob(3, std::as_bytes(std::span(words))).Run();
  }

 private:
  Statement insert_;
};

void RemoveOthers(Database& database, std::span<const StoredWords> stored, std::vector<std::int64_t> rows) {
  std::ranges::sort(rows);
  Statement remove(database, "DELETE FROM keyframe_words WHERE keyframe = ?1", "table keyframe_words");
  for (const StoredWords& each : stored)
    if (!std::ranges::binary_search(rows, each.row)) remove.Bind(1, each.row).Run();
}

void RebuildMap(Database& database, std::int64_t map) {
  Statement statement(database, "SELECT row FROM keyframe WHERE row BETWEEN ?1 AND ?2 ORDER BY row", "table keyframe");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  Writer writer(database);
  while (statement.Step()) {
    const std::int64_t row = statement.Integer(0);
    KeyFrame keyframe;
    std::int64_t hash = 0, links_hash = 0, features_hash = 0;
    try {
      LoadKeyframes(database, std::span(&row, 1), {.links = false}, std::span(&keyframe, 1), std::span(&hash, 1),
                    std::span(&links_hash, 1), std::span(&features_hash, 1));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged) throw;
      continue;
    }
    writer.Write(row, features_hash, PlaceWordsOf(LeftDescriptors(keyframe.features)));
  }
}

}  // namespace

PlaceWords PlaceWordsOf(std::span<const Descriptor> descriptors) {
  static const PlaceTree tree;
  PlaceWords words{};
  tree.ForEachWord(descriptors, [&](std::uint32_t word) { words[word / 64] |= std::uint64_t{1} << (word % 64); });
  return words;
}

std::vector<double> PlaceWordFrequencies() {
  std::array<std::uint16_t, kWords> recorded{};
  std::memcpy(recorded.data(), PlaceTreeBytes().last(sizeof recorded).data(), sizeof recorded);
  std::vector<double> frequencies;
  for (const std::uint16_t each : recorded) frequencies.push_back(each / 65535.0);
  return frequencies;
}

void SavePlaceWords(SaveContext& context, std::int64_t map_row, const Map& map, std::span<const std::int64_t> rows,
                    std::span<const std::int64_t> features_hashes) {
  const std::vector<StoredWords> stored = ReadStored(context.database, map_row);
  RemoveOthers(context.database, stored, {rows.begin(), rows.end()});
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto old = std::ranges::lower_bound(stored, rows[i], {}, &StoredWords::row);
    if (old == stored.end() || old->row != rows[i] || old->hash != features_hashes[i]) changed.push_back(i);
  }
  std::vector<PlaceWords> words(changed.size());
  detail::ParallelFor(changed.size(), 8, context.options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      words[i] = PlaceWordsOf(LeftDescriptors(map.keyframes[changed[i]].features));
  });
  Writer writer(context.database);
  for (std::size_t i = 0; i < changed.size(); ++i)
    writer.Write(rows[changed[i]], features_hashes[changed[i]], words[i]);
}

void RebuildPlaceWords(Database& database) {
  database.Execute("DELETE FROM keyframe_words");
  for (const std::int64_t map : Statement(database, "SELECT row FROM map ORDER BY row", "table map").Integers())
    RebuildMap(database, map);
}

}  // namespace slamdb::sqlite
