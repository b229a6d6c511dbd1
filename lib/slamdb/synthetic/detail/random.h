// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <initializer_list>

namespace slamdb::synthetic {

// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014). The distributions of the standard library differ between its
// implementations, so these are our own: the same numbers on every machine.
class Random {
 public:
  // An own stream for every key, so that work on many threads draws the same numbers in any order.
  explicit Random(std::initializer_list<std::uint64_t> key) {
    for (const std::uint64_t part : key) state_ = Mixed(state_ ^ Mixed(part + kStep));
  }

  std::uint64_t Bits() { return Mixed(state_ += kStep); }

  // In [0, 1).
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  // In [0, end); `end` is small beside 2^64, so that the bias does not matter.
  std::uint64_t Below(std::uint64_t end) { return Bits() % end; }

  bool Chance(double probability) { return Uniform() < probability; }

  // Mean 0 and standard deviation 1: the sum of twelve uniform numbers, never beyond 6.
  double Normal() {
    std::uint64_t sum = 0;
    for (int draw = 0; draw < 3; ++draw) {
      const std::uint64_t bits = Bits();
      sum += (bits & 0xFFFF) + (bits >> 16 & 0xFFFF) + (bits >> 32 & 0xFFFF) + (bits >> 48);
    }
    return static_cast<double>(sum) * 0x1p-16 - 6 + 12 * 0x1p-17;
  }

 private:
  static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15;

  static std::uint64_t Mixed(std::uint64_t value) {
    value = (value ^ value >> 30) * 0xBF58476D1CE4E5B9;
    value = (value ^ value >> 27) * 0x94D049BB133111EB;
    return value ^ value >> 31;
  }

  std::uint64_t state_ = 0;
};

// What a stream is for: the first part of its key after seed and map.
enum Stream : std::uint64_t { kPlace, kLook, kView, kWordWeight, kBias, kPrivate, kStrip, kScale, kWord };

}  // namespace slamdb::synthetic
