// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/list_order.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/plan.h"
#include "slamdb/model/detail/packing.h"

namespace slamdb::sqlite {
namespace {

constexpr std::uint8_t kLayout = 1;

std::uint32_t PlaceOfRow(std::int64_t row) { return static_cast<std::uint32_t>(row & 0xffffffff); }

}  // namespace

ListOrder::ListOrder(Bytes blob) {
  detail::ByteReader in(blob);
  if (in.Get<std::uint8_t>() != kLayout) throw Error(ErrorKind::kDamaged, "an order of an unknown layout");
  std::size_t position = 0;
  while (in.left() > 0) {
    Run run{in.Get<std::uint32_t>(), in.Get<std::uint32_t>(), position};
    position += run.count;
    runs_.push_back(run);
  }
  if (runs_.empty()) throw Error(ErrorKind::kDamaged, "an order of no rows");
  std::ranges::sort(runs_, {}, &Run::place);
}

ListOrder ListOrder::Of(Database& database, std::int64_t map, std::string_view list) {
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

std::string ListOrder::Encode(std::span<const std::int64_t> rows) {
  if (std::ranges::is_sorted(rows)) return {};
  detail::ByteWriter out;
  out.Put(kLayout);
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t end = first + 1;
    while (end < rows.size() && rows[end] == rows[end - 1] + 1) ++end;
    out.Put(PlaceOfRow(rows[first]));
    out.Put(static_cast<std::uint32_t>(end - first));
    first = end;
  }
  return out.Take();
}

std::vector<std::size_t> ListOrder::Sorted(std::span<const std::int64_t> rows) const {
  std::vector<std::pair<std::size_t, std::size_t>> by_position;  // and index in `rows`
  by_position.reserve(rows.size());
  auto run = runs_.begin();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::uint32_t place = PlaceOfRow(rows[i]);
    while (run != runs_.end() && place - std::min(place, run->place) >= run->count) ++run;
    if (run == runs_.end() || place < run->place)
      throw Error(ErrorKind::kDamaged, detail::Concat("row ", rows[i], " has no place in the order of its list"));
    by_position.emplace_back(run->position + (place - run->place), i);
  }
  std::ranges::sort(by_position);
  std::vector<std::size_t> sorted;
  sorted.reserve(rows.size());
  for (const auto& [position, index] : by_position) sorted.push_back(index);
  return sorted;
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
  ListOrder::Of(database, map, list).Sort(rows, in_order);
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
