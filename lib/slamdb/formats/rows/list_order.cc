// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/list_order.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/model/detail/packing.h"

namespace slamdb::rows {
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

}  // namespace slamdb::rows
