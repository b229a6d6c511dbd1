// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/osa_mutator.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>

#include "slamdb/base/error.h"
#include "slamdb/edit/repair/detail/field_bits.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/fields.h"

namespace slamdb::fuzz {
namespace {

// An element of zeros.
template <class Element>
Element Zero() {
  Element element{};
  field_bits::ForEachScalar(element, [](auto& scalar) { field_bits::FromBits(0, scalar); });
  return element;
}

template <class List>
void CutTo(std::size_t size, List& list) {
  if (list.size() > size) list.erase(list.begin() + static_cast<std::ptrdiff_t>(size), list.end());
}

// Lists in lists stand as sizes and elements, which must go together: what is too much goes.
template <class Elements>
void Settle(Column<std::uint32_t>& sizes, Elements& elements) {
  std::size_t left = elements.size();
  for (std::uint32_t& size : sizes) {
    size = static_cast<std::uint32_t>(std::min<std::size_t>(size, left));
    left -= size;
  }
  CutTo(elements.size() - left, elements);
}

void Settle(Features& features) {
  BagOfWords& bag = features.bag_of_words;
  CutTo(bag.weights.size(), bag.words);
  CutTo(bag.words.size(), bag.weights);
  FeatureVector& vector = features.feature_vector;
  CutTo(vector.sizes.size(), vector.nodes);
  CutTo(vector.nodes.size(), vector.sizes);
  Settle(vector.sizes, vector.features);
  for (FeatureGrid* grid : {&features.grid, &features.right_grid}) {
    Settle(grid->column_sizes, grid->cell_sizes);
    Settle(grid->cell_sizes, grid->keypoints);
  }
}

class Mutator {
 private:
  std::uint64_t Below(std::uint64_t bound) { return random_() % bound; }
  template <class List>
  auto& Any(List& list) {
    return list[Below(list.size())];
  }

 public:
  Mutator(Atlas& atlas, std::uint64_t seed) : atlas_(atlas), random_(seed) {}

  void MutateOnce() {
    switch (Below(8)) {
      case 0:
        return ChangeField(atlas_);
      case 1:
        return Below(2) ? ChangeList(atlas_.cameras) : ChangeAny(atlas_.cameras);
      case 2:
        return Below(4) ? ChangeAny(atlas_.maps) : ChangeList(atlas_.maps);
      case 3:
        return atlas_.maps.empty() ? void() : ChangeEntities(Any(atlas_.maps));
      case 4:
      case 5:
        return atlas_.maps.empty() ? void() : ChangeAny(Any(atlas_.maps).keyframes);
      default:
        return atlas_.maps.empty() ? void() : ChangeAny(Any(atlas_.maps).points);
    }
  }

 private:
  template <class List>
  void ChangeAny(List& list) {
    if (!list.empty()) ChangeField(Any(list));
  }
  void ChangeEntities(Map& map) { Below(2) ? ChangeList(map.keyframes) : ChangeList(map.points); }

  template <class List>
  void ChangeList(List& list) {
    if (list.empty()) return;
    const std::size_t row = Below(list.size());
    switch (Below(4)) {
      case 0:
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(row));
        return;
      case 1: {
        auto twin = list[row];
        list.push_back(std::move(twin));
        return;
      }
      case 2:
        std::swap(list[row], Any(list));
        return;
      default:
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(row), list.end());
    }
  }

  template <class Entity>
  void ChangeField(Entity& entity) {
    std::uint64_t fields = 0;
    ForEachField(&entity, [&](std::string_view, auto...) { ++fields; });
    std::uint64_t left = Below(fields);
    ForEachField(&entity, [&](std::string_view, auto... members) {
      if (left-- == 0) Change(Member(entity, members...));
    });
  }

  template <class Field>
  void Change(Field& field) {
    if constexpr (field_bits::kIsRecord<Field>) {
    } else if constexpr (field_bits::kIsSequence<Field>) {
      if (field.empty())
        field.push_back(Zero<typename Field::value_type>());
      else if (Below(3) == 0)
        ChangeList(field);
      else
        ChangeScalar(Any(field));
    } else if constexpr (field_bits::kIsMatrix<Field>) {
      if (field.size() > 0) ChangeScalar(field.data()[Below(static_cast<std::uint64_t>(field.size()))]);
    } else {
      ChangeScalar(field);
    }
  }

  template <class Element>
  void ChangeScalar(Element& element) {
    std::uint64_t scalars = 0;
    field_bits::ForEachScalar(element, [&](const auto&) { ++scalars; });
    std::uint64_t left = Below(scalars);
    field_bits::ForEachScalar(element, [&](auto& scalar) {
      if (left-- == 0) Set(scalar);
    });
  }

  template <class Scalar>
  void Set(Scalar& scalar) {
    if constexpr (std::is_same_v<Scalar, bool>) {
      scalar = !scalar;
    } else if constexpr (std::is_floating_point_v<Scalar>) {
      using Limits = std::numeric_limits<Scalar>;
      const Scalar values[] = {
          0,  -scalar, scalar * 2, Limits::quiet_NaN(), Limits::infinity(), Limits::max(), Limits::denorm_min(),
          -1, 1e9f,    scalar + 1};
      scalar = values[Below(std::size(values))];
    } else if constexpr (!std::is_enum_v<Scalar>) {
      const std::uint64_t bits = field_bits::ToBits(scalar);
      const std::uint64_t values[] = {0,
                                      1,
                                      bits + 1,
                                      bits - 1,
                                      bits ^ (std::uint64_t{1} << Below(64)),
                                      ~std::uint64_t{0},
                                      std::uint64_t{1} << 31,
                                      std::uint64_t{1} << 63,
                                      (std::uint64_t{1} << 62) - 1,
                                      Below(8),
                                      Below(8)};
      field_bits::FromBits(values[Below(std::size(values))], scalar);
    }
  }

  Atlas& atlas_;
  std::mt19937_64 random_;
};

}  // namespace

std::optional<Atlas> AtlasOf(Bytes bytes) {
  try {
    Notices notices;
    ReadOptions options;
    options.threads = 1;
    return ReadOrbslam3({bytes, "fuzz"}, options, notices);
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<std::string> Encoded(const Atlas& atlas) {
  try {
    return EncodeOrbslam3(atlas);
  } catch (const Error&) {
    return std::nullopt;
  }
}

void Mutate(Atlas& atlas, std::uint64_t seed) {
  Mutator mutator(atlas, seed);
  for (std::uint64_t left = 1 + seed % 4; left > 0; --left) mutator.MutateOnce();
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) Settle(keyframe.features);
}

Atlas VariationOf(const Atlas& atlas, std::uint64_t seed) {
  Atlas changed = atlas;
  Mutate(changed, seed);
  const std::optional<std::string> encoded = Encoded(changed);
  std::optional<Atlas> decoded = encoded ? AtlasOf(std::as_bytes(std::span(*encoded))) : std::nullopt;
  return decoded ? *std::move(decoded) : atlas;
}

}  // namespace slamdb::fuzz
