// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <any>
#include <list>
#include <utility>

namespace slamdb {

// The options of single formats, each a struct of its own that its format declares (formats/orbslam3/options.h, ...).
// Holds at most one struct of each type; one that was not asked for has its defaults.
class FormatOptions {
 public:
  // The struct of that type, to be changed.
  // Stays where it is while others are asked for.
  template <class Options>
  Options& of() {
    for (std::any& item : items_)
      if (auto* found = std::any_cast<Options>(&item)) return *found;
    return items_.emplace_back().template emplace<Options>();
  }
  template <class Options>
  const Options& of() const {
    for (const std::any& item : items_)
      if (const auto* found = std::any_cast<Options>(&item)) return *found;
    static const Options defaults{};
    return defaults;
  }

 private:
  std::list<std::any> items_;
};

}  // namespace slamdb
