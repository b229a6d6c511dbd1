// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/distance_table.h"

#include <bit>
#include <cstring>

namespace slamdb::detail {
namespace {

[[gnu::always_inline]] inline void Distances(const Bits& one, const std::vector<Bits>& others,
                                             std::uint16_t* distances) {
  for (std::size_t i = 0; i < others.size(); ++i) {
    int distance = 0;
    for (std::size_t word = 0; word < one.size(); ++word) distance += std::popcount(one[word] ^ others[i][word]);
    distances[i] = static_cast<std::uint16_t>(distance);
  }
}

void DistancesAnywhere(const Bits& one, const std::vector<Bits>& others, std::uint16_t* distances) {
  Distances(one, others, distances);
}

// Processors without the instruction are older than any robot that runs ORB-SLAM3, but the library may be there.
#if defined(__x86_64__)
[[gnu::target("popcnt")]] void DistancesByPopcount(const Bits& one, const std::vector<Bits>& others,
                                                   std::uint16_t* distances) {
  Distances(one, others, distances);
}
const auto kDistances = __builtin_cpu_supports("popcnt") ? DistancesByPopcount : DistancesAnywhere;
#else
const auto kDistances = DistancesAnywhere;
#endif

}  // namespace

Bits BitsOf(const Descriptor& descriptor) {
  Bits bits;
  std::memcpy(bits.data(), descriptor.data(), sizeof(Bits));
  return bits;
}

DistanceTable::DistanceTable(const std::vector<Bits>& rows, const std::vector<Bits>& columns)
    : columns_(columns.size()), distances_(rows.size() * columns.size()) {
  for (std::size_t row = 0; row < rows.size(); ++row) kDistances(rows[row], columns, &distances_[row * columns_]);
}

}  // namespace slamdb::detail
