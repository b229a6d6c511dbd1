// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "slamdb/formats/sqlite/detail/database.h"
#include "slamdb/model/detail/packing.h"

// The table `past`: what the rows of an atlas were before a save changed them. The tables of the schema hold its newest
// revision; revision r is what they hold with all that was changed since put back: of each part that `past` knows, what
// it was before the first save behind r that changed it.
namespace slamdb::sqlite {

// What is kept as one: the rows of a table that belong to one entity. The numbers are those of past.part.
enum class Part : std::int64_t {
  kAtlas,     // the rows of this atlas' row in `atlas`
  kCameras,   // of `camera`; its `row` is that of the atlas
  kRepeated,  // of `repeated_entry`, likewise
  kMap,       // of `map`
  kOrigins,   // of `map_origin`; its `row` is that of the map
  kKeyframe,
  kFeatures,  // of `keyframe_features`; its `row` is that of the keyframe
  kLinks,
  kPoint,
  kObservations,
  kLandmark,
  kCarriedByAtlas,  // of `carried`
  kCarriedByCameras,
  kCarriedByMap,
  kCarriedByKeyframe,
  kCarriedByPoint,
};
inline constexpr std::size_t kParts = 16;

// The table of a part, and which of its rows are those of the entity ?1.
struct PartRows {
  std::string_view table, where;
};
const PartRows& RowsOf(Part part);

// Packs parts as they are now. One statement for each kind of part, prepared when first needed.
class PartReader {
 public:
  explicit PartReader(Database& database) : database_(database) {}
  // Valid until the next call. Empty: it has no rows.
  Bytes Read(Part part, std::int64_t row);

 private:
  Database& database_;
  std::array<std::optional<Statement>, kParts> selects_;
  detail::ByteWriter packed_;
};

// Keeps what a save is about to change.
class PastWriter {
 public:
  // `revision` is the one that is being made. A new atlas, whose row is 0, has no past: nothing is kept then.
  // `carries`: what is saved has something in the table `carried`.
  PastWriter(Database& database, std::int64_t atlas, std::int64_t revision, bool carries);

  // Before rows of that part change. What was kept in this revision already stays.
  void Keep(Part part, std::int64_t row);
  // All that belongs to a map.
  void KeepMap(std::int64_t map);
  bool keeps() const { return atlas_ != 0; }

 private:
  Database& database_;
  std::int64_t atlas_, revision_;
  bool has_carried_;
  PartReader reader_;
  Statement insert_;
};

// An earlier revision: what has to be known of it beside the tables.
struct PastRows {
  Database rows;  // all that was changed since as it was, with all parts of each keyframe and point that is in it, and
                  // all of the atlas that is neither keyframe nor point
  std::vector<std::int64_t> keyframes, points;  // rows of the tables that are not in this revision as they are there;
                                                // ascending
};

// Puts revision `revision` of an atlas together, which is not its newest.
//
// Throws Error (kDamaged) where what is kept makes no sense.
PastRows ReadPast(Database& database, std::int64_t atlas, std::int64_t revision);

// Fills the R*Tree of `rows`, which is needed where points are looked for by place.
void IndexBoxes(Database& rows);

}  // namespace slamdb::sqlite
