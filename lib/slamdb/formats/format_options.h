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

// What ReadOptions and WriteOptions (`Self`) have for options that only one format has.
template <class Self>
struct WithFormatOptions {
  FormatOptions formats;

  // `options.of<StoreReadOptions>().lock_timeout = 60`.
  template <class Options>
  Options& of() {
    return formats.of<Options>();
  }
  template <class Options>
  const Options& of() const {
    return formats.of<Options>();
  }

  // The same in one expression: `WriteOptions{.overwrite = true}.With(Orbslam3WriteOptions{.sanitize = true})`.
  template <class Options>
  Self With(Options of_format) const {
    Self options = static_cast<const Self&>(*this);
    options.template of<Options>() = std::move(of_format);
    return options;
  }
};

}  // namespace slamdb
