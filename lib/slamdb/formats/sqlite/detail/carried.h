// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/detail/packing.h"

// The table `carried`: what entities have of a fork's file. Most atlases have no row in it.
namespace slamdb::sqlite {

enum class CarriedKind : std::int64_t { kAtlas, kCamera, kMap, kKeyframe, kPoint };

// The `row` of a camera.
inline std::int64_t CarriedCameraRow(std::int64_t atlas, std::size_t position) {
  return atlas << 32 | static_cast<std::int64_t>(position);
}

class CarriedWriter {
 public:
  CarriedWriter(Database& database, CarriedKind kind);
  // Writes a row that is not there.
  void Write(std::int64_t row, const Boxed<Carried>& carried);
  void Remove(std::int64_t row);

 private:
  Statement insert_, remove_;
  std::int64_t kind_;
  detail::ByteWriter bytes_;
};

// Deletes the rows from `first` to `last`, both included.
void DeleteCarried(Database& database, CarriedKind kind, std::int64_t first, std::int64_t last);

// Reads rows in ascending order, in step with the table that they belong to. A store of an older version has none.
class CarriedReader {
 public:
  CarriedReader(Database& database, CarriedKind kind);
  void Start(std::int64_t first, std::int64_t last);
  // Of that row, which is behind those read before. Throws Error where the bytes are damaged.
  void Read(std::int64_t row, Boxed<Carried>& carried);

 private:
  Database& database_;
  std::optional<Statement> select_;
  std::int64_t kind_;
  bool has_row_ = false;
};

// Of one row.
Boxed<Carried> LoadCarried(Database& database, CarriedKind kind, std::int64_t row);

}  // namespace slamdb::sqlite
