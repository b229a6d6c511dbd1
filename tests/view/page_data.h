// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/view/page.h"

// What a page says, read as schema/view.md has it and without the code that wrote it.
namespace slamdb::testing {

struct KeypointOfPage {
  double x, y;
  std::int64_t point;
};

struct CovisibilityOfPage {
  std::int64_t first, second;
  std::uint64_t weight;
  friend bool operator==(const CovisibilityOfPage&, const CovisibilityOfPage&) = default;
};

class PageData {
 public:
  explicit PageData(const std::string& html);

  nlohmann::json header;
  std::map<std::string, std::string> columns;
  std::vector<std::string> order;  // names of blocks as they stand

  bool Has(const std::string& name) const { return columns.contains(name); }
  std::size_t points() const { return Bytes("points/error").size(); }
  std::size_t keyframes() const { return Bytes("keyframes/flags").size(); }

  // Of each row of points; `steps` are of its block, and 0 where the position stands by itself.
  std::vector<Eigen::Vector3d> Positions(std::vector<Eigen::Vector3d>* steps = nullptr) const;
  std::vector<std::uint64_t> PointIds() const { return Differences("points/id"); }
  std::vector<std::vector<std::int64_t>> Seen() const;
  std::vector<std::int64_t> References() const;
  std::vector<double> Errors() const;  // NaN: unknown
  std::vector<std::uint8_t> Hidden() const { return OneByte("points/hidden"); }

  std::vector<std::uint64_t> KeyFrameIds() const { return Differences("keyframes/id"); }
  std::vector<double> Times() const;
  std::vector<std::array<float, 7>> Poses() const;
  std::vector<std::int64_t> Parents() const;
  std::vector<CovisibilityOfPage> Covisibility() const;
  std::vector<std::pair<std::int64_t, std::int64_t>> Pairs(const std::string& name) const;
  std::vector<std::vector<KeypointOfPage>> Keypoints() const;

  std::vector<std::uint8_t> OneByte(const std::string& name) const;
  std::vector<std::uint64_t> Differences(const std::string& name) const;  // zigzag, to the one before
  std::vector<std::uint64_t> Varints(const std::string& name) const;

 private:
  std::string_view Bytes(const std::string& name) const;
};

// A page of one atlas, or of several.
ViewPage PageOf(const Atlas& atlas, const ViewOptions& options = {});
PageData DataOf(const Atlas& atlas, const ViewOptions& options = {});
PageData DataOf(const std::vector<const Atlas*>& atlases, const ViewOptions& options = {});

}  // namespace slamdb::testing
