// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/bit_columns.h"

#include <bit>
#include <cstring>

namespace slamdb::detail {
namespace {

using Columns = std::array<const std::uint64_t*, 4>;

[[gnu::always_inline]] inline void Distances(const Bits& one, const Columns& others, std::size_t count,
                                             std::uint16_t* distances) {
  const std::uint64_t *first = others[0], *second = others[1], *third = others[2], *fourth = others[3];
  for (std::size_t i = 0; i < count; ++i)
    distances[i] = static_cast<std::uint16_t>(std::popcount(one[0] ^ first[i]) + std::popcount(one[1] ^ second[i]) +
                                              std::popcount(one[2] ^ third[i]) + std::popcount(one[3] ^ fourth[i]));
}

void DistancesAnywhere(const Bits& one, const Columns& others, std::size_t count, std::uint16_t* distances) {
  Distances(one, others, count, distances);
}

// Processors without the first instruction are older than any robot that runs ORB-SLAM3, but the library may be there;
// the second one counts eight words at a time.
#if defined(__x86_64__)
[[gnu::target("popcnt")]] void DistancesByPopcount(const Bits& one, const Columns& others, std::size_t count,
                                                   std::uint16_t* distances) {
  Distances(one, others, count, distances);
}
[[gnu::target("avx512f,avx512bw,avx512vl,avx512vpopcntdq,popcnt")]] void DistancesByVector(const Bits& one,
                                                                                           const Columns& others,
                                                                                           std::size_t count,
                                                                                           std::uint16_t* distances) {
  Distances(one, others, count, distances);
}
const auto kDistances = __builtin_cpu_supports("avx512vpopcntdq") && __builtin_cpu_supports("avx512bw") &&
                                __builtin_cpu_supports("avx512vl")
                            ? DistancesByVector
                        : __builtin_cpu_supports("popcnt") ? DistancesByPopcount
                                                           : DistancesAnywhere;
#else
const auto kDistances = DistancesAnywhere;
#endif

}  // namespace

Bits BitsOf(const Descriptor& descriptor) {
  Bits bits;
  std::memcpy(bits.data(), descriptor.data(), sizeof(Bits));
  return bits;
}

BitColumns::BitColumns(std::span<const Bits> descriptors) {
  for (std::size_t word = 0; word < words_.size(); ++word)
    for (const Bits& bits : descriptors) words_[word].push_back(bits[word]);
}

void BitColumns::DistancesTo(const Bits& one, std::size_t first, std::size_t count, std::uint16_t* distances) const {
  Columns words{};
  for (std::size_t word = 0; word < words.size(); ++word) words[word] = words_[word].data() + first;
  kDistances(one, words, count, distances);
}

}  // namespace slamdb::detail
