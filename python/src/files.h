// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>  // before Eigen itself, of which it silences warnings that mean nothing

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/formats/format.h"

namespace slamdb::python {

// What reading and writing had to say: kind (loss, warning, note) and text.
using NoticeList = std::vector<std::pair<std::string, std::string>>;
NoticeList ListOf(const Notices& notices);

// What of an atlas is read. None: no bound.
struct Part {
  std::optional<std::uint64_t> map;
  std::optional<std::pair<std::uint64_t, std::uint64_t>> keyframes;
  std::optional<std::pair<double, double>> time;
  std::optional<std::pair<Eigen::Vector3f, Eigen::Vector3f>> box;
};
Selection SelectionOf(const Part& part);

}  // namespace slamdb::python
