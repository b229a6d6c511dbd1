// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/identity.h"

#include "slamdb/base/detail/recognize.h"
#include "slamdb/formats/sqlite/detail/big_endian.h"
#include "slamdb/formats/sqlite/detail/migrations.h"

namespace slamdb::sqlite {
namespace {

// Databases that people are likely to mix up with a store, known by their tables.
struct Known {
  std::string_view tables[2];
  std::string_view owner;
};
constexpr Known kKnown[] = {
    {{"two_view_geometries", "keypoints"}, "a COLMAP database"}, {{"Node", "Link"}, "an RTAB-Map database"},
    {{"keyframes", "landmarks"}, "a stella_vslam map"},          {{"topics", "messages"}, "a ROS 2 bag"},
    {{"gpkg_contents", "gpkg_spatial_ref_sys"}, "a GeoPackage"},
};

std::string OwnerOf(Database& database) {
  for (const Known& known : kKnown) {
    if (database.HasTable(known.tables[0]) && database.HasTable(known.tables[1])) return std::string(known.owner);
  }
  return database.Integer("SELECT count(*) FROM sqlite_schema") == 0 ? "an empty database"
                                                                     : "the SQLite database of another program";
}

// Which tables are plain ones; asked more than once, as reading a statement takes longer than running it.
class PlainTables {
 public:
  explicit PlainTables(Database& database)
      : select_(database,
                "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = ?1 AND (rootpage > 0 OR sql LIKE "
                "'CREATE VIRTUAL TABLE map_point_box USING rtree%') AND NOT EXISTS "
                "(SELECT 1 FROM pragma_table_xinfo(?1) WHERE hidden > 1)") {}

  bool Have(std::string_view table) {
    const bool has = select_.BindText(1, table).Step();
    select_.Reset();
    return has;
  }

 private:
  Statement select_;
};

// A damaged or hostile file may lack a table, or have something else of its name.
void CheckTables(Database& database, int version, Derived derived) {
  struct Table {
    const char* name;
    int since;       // the version of the schema that brought it
    bool is_needed;  // by who reads the newest revision of an atlas
  };
  constexpr Table kTables[] = {
      {"atlas", 1, true},
      {"camera", 1, true},
      {"map", 1, true},
      {"map_origin", 1, true},
      {"repeated_entry", 1, true},
      {"keyframe", 1, true},
      {"keyframe_features", 1, true},
      {"keyframe_link", 1, true},
      {"map_point", 1, true},
      {"map_point_box", 1, false},
      {"observation", 1, true},
      {"history", 1, true},
      {"writer", 1, true},
      {"landmark", kFirstVersionWithLandmarks, true},
      {"keyframe_words", kFirstVersionWithPlaces, false},
      {"carried", kFirstVersionWithCarried, false},
      {"picture", kFirstVersionWithRevisions, true},
      {"past", kFirstVersionWithRevisions, false},
      {"revision", kFirstVersionWithRevisions, false},
      {"tag", kFirstVersionWithRevisions, false},
  };
  PlainTables plain(database);
  for (const Table& table : kTables) {
    if (version < table.since || (derived == Derived::kNotNeeded && !table.is_needed)) continue;
    if (!plain.Have(table.name))
      throw Error(ErrorKind::kDamaged, database.path(), std::string("table ") + table.name,
                  "missing: the store is damaged");
  }
}

}  // namespace

bool HasPlainTable(Database& database, std::string_view table) { return PlainTables(database).Have(table); }

Header HeaderOf(std::string_view head) {
  Header header;
  header.is_sqlite = head.size() >= 100 && detail::IsSqlite(head);
  if (header.is_sqlite) {
    header.version = static_cast<std::int32_t>(BigEndian32(&head[60]));
    header.application_id = static_cast<std::int32_t>(BigEndian32(&head[68]));
  }
  return header;
}

void CheckIsStore(Database& database, int newest, Older older, Derived derived) {
  const std::int64_t application = database.Integer("PRAGMA application_id");
  if (application != kApplicationId) {
    std::string problem = "not a slamdb store: this is " + OwnerOf(database);
    if (application != 0) problem += " (application id " + std::to_string(application) + ")";
    throw Error(ErrorKind::kUnsupported, database.path(), "", problem);
  }
  const int version = VersionOf(database);
  const std::string is = "store version " + std::to_string(version);
  if (version < 1) throw Error(ErrorKind::kDamaged, database.path(), "", is + " does not exist: the store is damaged");
  if (version > newest) {
    throw Error(ErrorKind::kUnsupported, database.path(), "",
                is + ", newest known to this program is " + std::to_string(newest) +
                    ": use the slamdb that wrote it, or a newer one");
  }
  if (version < newest && older == Older::kRefuse) {
    throw Error(ErrorKind::kUnsupported, database.path(), "",
                is + ", this program needs " + std::to_string(newest) + ": migrate it first");
  }
  CheckTables(database, version, derived);
}

}  // namespace slamdb::sqlite
