// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/model.h"

// Ids of COLMAP, which models count from 1 on each for itself, and of atlases, which have each id once.
namespace slamdb::colmap {

template <class Row>
std::unordered_map<std::uint64_t, std::uint32_t> RowsById(const std::vector<Row>& rows) {
  std::unordered_map<std::uint64_t, std::uint32_t> by_id;
  by_id.reserve(rows.size());
  for (std::uint32_t row = 0; row < rows.size(); ++row) by_id.emplace(rows[row].id, row);
  return by_id;
}

// How ids of COLMAP become ours: ids there begin with 1, unless one is 0.
class Ids {
 public:
  template <class Row>
  explicit Ids(const std::vector<Row>& rows) {
    for (const Row& row : rows) below_ = row.id == 0 ? 0 : below_;
  }
  std::uint64_t Of(std::uint64_t id) const { return id - below_ + above_; }
  void MoveUp(std::uint64_t by) { above_ = by; }

 private:
  std::uint64_t below_ = 1, above_ = 0;
};

// COLMAP counts ids of each model from 1 on, and an atlas has each id once.
class UsedIds {
 public:
  // How far up the ids of a list have to move so that none of them is there already.
  std::uint64_t Enter(const std::vector<std::uint64_t>& ids, const std::string& path, std::uint64_t& moved) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 62U;
    const bool taken = std::ranges::any_of(ids, [&](std::uint64_t id) { return used_.contains(id); });
    const std::uint64_t above = taken ? next_ : 0;
    moved += taken ? 1 : 0;
    if (taken && (above > kMost || std::ranges::any_of(ids, [](std::uint64_t id) { return id > kMost; })))
      throw Error(ErrorKind::kUnsupported, path, "",
                  "has ids that another model has too, and they are too large to be moved apart; read it alone");
    for (const std::uint64_t id : ids) {
      used_.insert(id + above);
      next_ = std::max(next_, id + above + 1);
    }
    return above;
  }

 private:
  std::unordered_set<std::uint64_t> used_;
  std::uint64_t next_ = 0;
};

// Models of one reconstruction list the same cameras.
class UsedCameras {
 public:
  std::uint64_t Enter(const std::vector<Camera>& cameras, const Ids& ids) {
    const bool clash = std::ranges::any_of(cameras, [&](const Camera& camera) {
      const auto used = used_.find(ids.Of(camera.id));
      return used != used_.end() && used->second != camera;
    });
    const std::uint64_t above = clash ? next_ : 0;
    for (const Camera& camera : cameras) {
      used_.emplace(ids.Of(camera.id) + above, camera);
      next_ = std::max(next_, ids.Of(camera.id) + above + 1);
    }
    return above;
  }

 private:
  std::unordered_map<std::uint64_t, Camera> used_;
  std::uint64_t next_ = 0;
};

}  // namespace slamdb::colmap
