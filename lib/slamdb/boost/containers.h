// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/serialization/collection_size_type.hpp>
#include <boost/serialization/extended_type_info_typeid.hpp>
#include <boost/serialization/item_version_type.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/tracking.hpp>
#include <boost/serialization/utility.hpp>
#include <boost/serialization/vector.hpp>
#include <cstddef>
#include <cstring>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/model/keyframe.h"
#include "slamdb/model/map_point.h"

// Columns of the model in place of the containers that ORB-SLAM3 archives. Boost numbers classes by type, so the types
// named here are ORB-SLAM3's own, and `unsigned long` may not become `uint64_t` where that is another type.
namespace slamdb::boost_archive {

static_assert(sizeof(long) == 8, "ORB-SLAM3 archives ids as long, which has to have 8 bytes");

using Words = std::map<unsigned int, double>;
using Nodes = std::map<unsigned int, std::vector<unsigned int>>;
using Weights = std::map<unsigned long, int>;  // covisibility, observations
using GridColumn = std::vector<std::vector<std::size_t>>;
using Grid = std::vector<GridColumn>;
struct BowVector {};         // DBoW2's, a class of its own derived from Words
struct BowFeatureVector {};  // and from Nodes

// What is archived as a `Container`, class information and number in the archive included, without making one.
template <class Container, class Model>
struct View {
  Model& model;
};

[[noreturn]] inline void FailLoading(const std::string& problem) {
  throw Error(ErrorKind::kDamaged, "a Boost archive holds " + problem);
}

template <class Container, class Archive, class Model>
void As(Archive& archive, Model& model) {
  View<Container, Model> view{model};
  archive& view;
}

// A vector of numbers goes through a vector, because Boost archives those in one piece.
template <class Number, class Archive, class Model>
void AsVector(Archive& archive, Model& column) {
  using Value = typename Model::value_type;
  static_assert(sizeof(Value) == sizeof(Number) && std::is_trivially_copyable_v<Value>);
  std::vector<Number> numbers(Archive::is_saving::value ? column.size() : 0);
  if (!numbers.empty()) std::memcpy(numbers.data(), column.data(), numbers.size() * sizeof(Number));
  archive& numbers;
  if constexpr (Archive::is_loading::value) {
    column.resize(numbers.size());
    if (!numbers.empty())
      std::memcpy(static_cast<void*>(column.data()), numbers.data(), numbers.size() * sizeof(Number));
  }
}

// The items of a container: their count, their version, and each by `visit(position)`.
template <class Archive, class Visit>
void Items(Archive& archive, std::size_t size, const Visit& visit) {
  boost::serialization::collection_size_type count(size);
  boost::serialization::item_version_type version(0);
  archive& count& version;
  const std::size_t items = std::as_const(count);
  for (std::size_t i = 0; i < items; ++i) visit(i);
}

// An item of a std::map.
template <class Archive, class Key, class Value>
void Item(Archive& archive, Key& key, Value& value) {
  std::pair<const Key, Value> item(key, std::move(value));
  archive& item;
  key = item.first;
  value = std::move(item.second);
}

template <class Archive>
void serialize(Archive& archive, View<BowVector, BagOfWords>& view, const unsigned int /*version*/) {
  As<Words>(archive, view.model);
}

template <class Archive>
void serialize(Archive& archive, View<Words, BagOfWords>& view, const unsigned int /*version*/) {
  BagOfWords& bag = view.model;
  if constexpr (Archive::is_loading::value) bag = {};
  Items(archive, bag.words.size(), [&](std::size_t i) {
    if constexpr (Archive::is_loading::value) {
      bag.words.push_back(0);
      bag.weights.push_back(0);
    }
    Item(archive, bag.words[i], bag.weights[i]);
  });
}

template <class Archive>
void serialize(Archive& archive, View<BowFeatureVector, FeatureVector>& view, const unsigned int /*version*/) {
  As<Nodes>(archive, view.model);
}

template <class Archive>
void serialize(Archive& archive, View<Nodes, FeatureVector>& view, const unsigned int /*version*/) {
  FeatureVector& vector = view.model;
  if constexpr (Archive::is_loading::value) vector = {};
  std::size_t begin = 0;
  std::vector<unsigned int> features;
  Items(archive, vector.nodes.size(), [&](std::size_t i) {
    features.clear();
    if constexpr (Archive::is_saving::value) {
      features.assign(vector.features.data() + begin, vector.features.data() + begin + vector.sizes[i]);
      begin += vector.sizes[i];
    } else {
      vector.nodes.push_back(0);
    }
    Item(archive, vector.nodes[i], features);
    if constexpr (Archive::is_loading::value) {
      vector.sizes.push_back(static_cast<std::uint32_t>(features.size()));
      vector.features.insert(vector.features.end(), features.begin(), features.end());
    }
  });
}

// The column of a grid that is being archived: `cells` of them, and the cells and keypoints behind which it begins.
struct GridColumnCursor {
  FeatureGrid& grid;
  std::uint32_t cells = 0;
  std::size_t cell = 0, keypoint = 0;
};

template <class Archive>
void serialize(Archive& archive, View<GridColumn, GridColumnCursor>& view, const unsigned int /*version*/) {
  GridColumnCursor& at = view.model;
  std::vector<std::size_t> keypoints;
  std::uint32_t cells = 0;
  Items(archive, at.cells, [&](std::size_t) {
    keypoints.clear();
    if constexpr (Archive::is_saving::value) {
      const std::uint64_t* begin = at.grid.keypoints.data() + at.keypoint;
      keypoints.assign(begin, begin + at.grid.cell_sizes[at.cell++]);
      at.keypoint += keypoints.size();
    }
    archive& keypoints;
    if constexpr (Archive::is_loading::value) {
      at.grid.cell_sizes.push_back(static_cast<std::uint32_t>(keypoints.size()));
      at.grid.keypoints.insert(at.grid.keypoints.end(), keypoints.begin(), keypoints.end());
    }
    ++cells;
  });
  at.cells = cells;
}

template <class Archive>
void serialize(Archive& archive, View<Grid, FeatureGrid>& view, const unsigned int /*version*/) {
  FeatureGrid& grid = view.model;
  if constexpr (Archive::is_loading::value) grid = {};
  GridColumnCursor cursor{grid};
  Items(archive, grid.column_sizes.size(), [&](std::size_t i) {
    cursor.cells = Archive::is_saving::value ? grid.column_sizes[i] : 0;
    As<GridColumn>(archive, cursor);
    if constexpr (Archive::is_loading::value) grid.column_sizes.push_back(cursor.cells);
  });
}

template <class Archive>
void serialize(Archive& archive, View<Weights, Column<Connection>>& view, const unsigned int /*version*/) {
  Column<Connection>& connections = view.model;
  if constexpr (Archive::is_loading::value) connections.clear();
  Items(archive, connections.size(), [&](std::size_t i) {
    if constexpr (Archive::is_loading::value) connections.emplace_back();
    unsigned long keyframe = connections[i].keyframe.value();
    Item(archive, keyframe, connections[i].weight);
    if constexpr (Archive::is_loading::value) connections[i].keyframe = KeyFrameId(keyframe);
  });
}

// The rows of one image that see a point, by keyframe; without the observations that have none.
inline Column<Connection> SideOf(const Column<Observation>& observations, std::int32_t Observation::*side) {
  Column<Connection> rows;
  rows.reserve(observations.size());
  for (const Observation& observation : observations)
    if (observation.*side != Observation::kAbsent) rows.push_back({observation.keyframe, observation.*side});
  return rows;
}

// Pairs the rows of two images. What stands in one of them alone keeps its place.
inline void Pair(const Column<Connection>& left, const Column<Connection>& right, Column<Observation>& observations) {
  observations.clear();
  observations.reserve(left.size());
  auto l = left.begin(), r = right.begin();
  while (l != left.end() || r != right.end()) {
    const bool from_left = l != left.end() && (r == right.end() || l->keyframe <= r->keyframe);
    const bool from_right = r != right.end() && (l == left.end() || r->keyframe <= l->keyframe);
    observations.push_back({from_left ? l->keyframe : r->keyframe, from_left ? l->weight : Observation::kAbsent,
                            from_right ? r->weight : Observation::kAbsent});
    if (from_left) ++l;
    if (from_right) ++r;
  }
}

template <class Archive>
void Observations(Archive& archive, Column<Observation>& observations) {
  Column<Connection> left, right;
  if constexpr (Archive::is_saving::value) {
    left = SideOf(observations, &Observation::left);
    right = SideOf(observations, &Observation::right);
  }
  As<Weights>(archive, left);
  As<Weights>(archive, right);
  if constexpr (Archive::is_loading::value) {
    for (const Column<Connection>* rows : {&left, &right})
      for (const Connection& row : *rows)
        if (row.weight == Observation::kAbsent) FailLoading("a keypoint row of -2147483648");
    Pair(left, right, observations);
  }
}

}  // namespace slamdb::boost_archive

namespace boost::serialization {
template <class Container, class Model>
struct type_info_implementation<slamdb::boost_archive::View<Container, Model>> {
  using type = extended_type_info_typeid<Container>;
};
template <class Container, class Model>
struct tracking_level<slamdb::boost_archive::View<Container, Model>> : mpl::int_<track_never> {
  using type = mpl::int_<track_never>;
};
}  // namespace boost::serialization
