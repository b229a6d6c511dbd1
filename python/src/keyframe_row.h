// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "python/src/map_in_atlas.h"

namespace slamdb::python {

struct FeaturesOfKeyFrame {
  Row<KeyFrame> of;
};

// A column of a keyframe's features as an array over it.
template <class Number, auto Member>
pybind11::array FeatureColumn(const FeaturesOfKeyFrame& features) {
  return ColumnView<Number>(features.of.kept, features.of.entity->features.*Member);
}

}  // namespace slamdb::python
