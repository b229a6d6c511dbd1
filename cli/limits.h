// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>

// Which numbers options take: for the command, and for keyword arguments in Python. None takes NaN.
namespace slamdb::cli {

struct Limits {
  double low = -std::numeric_limits<double>::max(), high = std::numeric_limits<double>::max();
  bool above_low = false;  // the lowest is none of them

  bool Hold(double number) const {
    return (above_low ? number > low : number >= low) && number <= high;  // NaN is not
  }
  // `a number from 0 to 256`
  std::string Text() const;
};

inline constexpr Limits kFinite;
inline constexpr Limits kNonNegative{.low = 0};
inline constexpr Limits kPositive{.low = 0, .above_low = true};
inline constexpr Limits kShare{.low = 0, .high = 1};
inline constexpr Limits kThreads{.low = 0, .high = 1024};
inline constexpr Limits kMemory{.low = 0, .high = 1e15};     // bytes
inline constexpr Limits kAtlasMade{.low = 1, .high = 1e15};  // bytes
inline constexpr Limits kBitsOfDescriptor{.low = 0, .high = 256};
inline constexpr Limits kLocateFeatures{.low = 100, .high = 100'000};
inline constexpr Limits kLayoutChoice{.low = 1, .high = 1000};
inline constexpr Limits kMapsMade{.low = 1, .high = 10'000};
inline constexpr Limits kRevisionsKept{.low = 1, .high = 1e15};
inline constexpr Limits kRetries{.low = 0, .high = 1e6};
inline constexpr Limits kPartitions{.low = 1, .high = 1024};
inline constexpr Limits kPartition{.low = 0, .high = 1023};
inline constexpr Limits kPixelSigma{.low = 1e-3, .high = 1e3};
inline constexpr Limits kPlotWidth{.low = 320, .high = 4000};
inline constexpr Limits kPlotScale{.low = 1, .high = 4};

}  // namespace slamdb::cli
