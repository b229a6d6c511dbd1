// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/list_order.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"

namespace slamdb::sqlite {

ListOrder OrderOf(Database& database, std::int64_t map, std::string_view list) {
  if (VersionOf(database) < kFirstVersionWithRevisions) return {};
  Statement select(database, detail::Concat("SELECT ", list, "_order FROM map WHERE row = ?1"), "table map");
  if (!select.Bind(1, map).Step() || select.IsNull(0)) return {};
  try {
    return ListOrder(select.Blob(0));
  } catch (const Error& error) {
    throw Error(error.kind(), database.path(), detail::Concat("table map, row ", map),
                error.problem() + ": the store is damaged");
  }
}

namespace {

// Where rows of a list have their number: those of its own table first.
struct Numbered {
  const char *list, *table, *update;
};
constexpr Numbered kNumbered[] = {
    {"keyframe", "keyframe", "UPDATE keyframe SET row = ?2 WHERE row = ?1"},
    {"keyframe", "keyframe_features", "UPDATE keyframe_features SET keyframe = ?2 WHERE keyframe = ?1"},
    {"keyframe", "keyframe_link", "UPDATE keyframe_link SET keyframe = ?2 WHERE keyframe = ?1"},
    {"keyframe", "keyframe_words", "UPDATE keyframe_words SET keyframe = ?2 WHERE keyframe = ?1"},
    {"keyframe", "carried", "UPDATE carried SET row = ?2 WHERE kind = 3 AND row = ?1"},
    {"point", "map_point", "UPDATE map_point SET row = ?2 WHERE row = ?1"},
    {"point", "observation", "UPDATE observation SET point = ?2 WHERE point = ?1"},
    {"point", "map_point_box", "UPDATE map_point_box SET row = ?2 WHERE row = ?1"},
    {"point", "carried", "UPDATE carried SET row = ?2 WHERE kind = 4 AND row = ?1"},
    {"landmark", "landmark", "UPDATE landmark SET row = ?2 WHERE row = ?1"},
};

void MakeAscend(Database& database, std::int64_t map, const char* list, std::string_view table) {
  const std::vector<std::int64_t> rows = RowsInOrder(database, map, list, table);
  if (std::ranges::is_sorted(rows)) return;
  const std::int64_t first = *std::ranges::max_element(rows) + 1;
  if (first + static_cast<std::int64_t>(rows.size()) - 1 > LastRowOfMap(map))
    throw Error(ErrorKind::kNotPossible, database.path(), detail::Concat("table map, row ", map),
                "has no more rows to bring its lists into order");
  for (const Numbered& numbered : kNumbered) {
    if (numbered.list != std::string_view(list)) continue;
    Statement update(database, numbered.update, detail::Concat("table ", numbered.table));
    for (std::size_t i = 0; i < rows.size(); ++i)
      update.Bind(1, rows[i]).Bind(2, first + static_cast<std::int64_t>(i)).Run();
  }
}

}  // namespace

std::vector<std::int64_t> RowsInOrder(Database& database, std::int64_t map, std::string_view list,
                                      std::string_view table) {
  const std::vector<std::int64_t> rows = RowsOfList(database, table, map);
  std::vector<std::int64_t> in_order = rows;
  OrderOf(database, map, list).Sort(rows, in_order);
  return in_order;
}

void MakeListsAscend(Database& database) {
  for (const std::int64_t map : Statement(database, "SELECT row FROM map ORDER BY row", "table map").Integers()) {
    MakeAscend(database, map, "keyframe", "keyframe");
    MakeAscend(database, map, "point", "map_point");
    MakeAscend(database, map, "landmark", "landmark");
  }
}

}  // namespace slamdb::sqlite
