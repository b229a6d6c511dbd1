// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <string>

#include "slamdb/model/features.h"

namespace slamdb::python {

// What is given of a keyframe's features: slamdb.FeatureArrays, Features of another keyframe, or a mapping of the same
// names. Throws Error (kUsage) that begins with `name`.
Features GivenFeatures(pybind11::handle object, const std::string& name);

// (N, 32) uint8; of None none.
Column<Descriptor> GivenDescriptors(pybind11::handle object, const std::string& name);

}  // namespace slamdb::python
