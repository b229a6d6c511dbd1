// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>  // in every unit, so that all convert alike
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cli/limits.h"
#include "python/src/held_atlas.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/progress.h"
#include "slamdb/formats/dbow2/vocabulary.h"

namespace slamdb::python {

struct AtlasOrPath {
  std::shared_ptr<const Atlas> atlas;  // null: it is the path
  std::string path;                    // both empty: nothing was given

  bool any() const { return atlas != nullptr || !path.empty(); }
};

// A file that a verb writes beside its report: whole or not at all.
struct OutputFile {
  std::string path;  // empty: none
  AtomicFileOptions options;

  bool any() const { return !path.empty(); }
  // Does nothing where no file is named.
  void Write(std::string_view bytes) const;
};

// The keyword arguments of a verb. What is None leaves the library's default as it is.
// To be used with the GIL held; what a Progress of it calls is kept alive by it.
class Arguments {
 public:
  explicit Arguments(pybind11::dict values) : values_(std::move(values)) {}

  bool Has(const char* name) { return Find(name).has_value(); }

  // Throws TypeError for what is no such value, Error (kUsage) for a number that it cannot be.
  template <class Value>
  void Take(const char* name, Value& into) {
    const std::optional<pybind11::object> value = Find(name);
    if (!value) return;
    try {
      into = value->cast<Value>();
    } catch (const pybind11::cast_error&) {
      RefuseType(name, *value, WhatIs<Value>());
    }
  }
  template <class Value>
  void Take(const char* name, std::optional<Value>& into) {
    if (Has(name)) Take(name, into.emplace());
  }
  // A number within limits. Throws Error (kUsage) for another one.
  template <class Value>
  void Take(const char* name, Value& into, const cli::Limits& limits) {
    std::optional<double> number;
    Take(name, number);
    if (number && !limits.Hold(*number)) RefuseNumber(name, limits);
    Take(name, into);
  }
  template <class Value>
  Value Get(const char* name, Value otherwise = {}) {
    Take(name, otherwise);
    return otherwise;
  }

  // One of the words. Throws Error (kUsage), with all of them.
  template <class Value, class Into>
  void TakeWord(const char* name, const std::map<std::string, Value>& words, Into& into) {
    if (!Has(name)) return;
    const auto found = words.find(Get<std::string>(name));
    if (found != words.end()) {
      into = found->second;
      return;
    }
    std::vector<std::string> all;
    for (const auto& [word, value] : words) all.push_back(word);
    RefuseWord(name, all);
  }

  // An id, or several.
  template <class Id>
  void TakeIds(const char* name, std::vector<Id>& into) {
    for (const std::uint64_t id : Numbers(name)) into.emplace_back(id);
  }
  std::vector<std::uint64_t> Numbers(const char* name);

  // A str or os.PathLike, of what is read; empty: none.
  std::string Path(const char* name);
  std::vector<std::string> Paths(const char* name);

  // The same of what is written, over what is there where `overwrite` says so.
  OutputFile Output(const char* name);
  // The same of an atlas, which may replace one; a file, or STORE.db#NAME.
  std::string OutputAtlas(const char* name);

  // An atlas, or the path of what is to be read.
  AtlasOrPath SourceAt(const char* name);
  std::vector<AtlasOrPath> Sources(const char* name);

  // The value of an atlas.
  std::shared_ptr<const Atlas> AtlasAt(const char* name);

  int threads() {
    int threads = 0;
    Take("threads", threads, cli::kThreads);
    return threads;
  }
  slamdb::Progress progress();

  template <class Options>
  void TakeRun(Options& options) {
    options.threads = threads();
    options.progress = progress();
  }

  // Throws Error (kUsage) when one of the arguments was given, neither None nor False: it is `why`.
  void RefuseIdle(std::initializer_list<const char*> names, const std::string& why);

  // Throws RuntimeError when an argument was given that nobody took, which would be without effect; Error when an
  // output is an input or another output, or a file an atlas.
  void RequireAllTaken() const;

 private:
  template <class Value>
  static constexpr std::string_view WhatIs() {
    if constexpr (std::is_same_v<Value, bool>) return "True or False";
    if constexpr (std::is_unsigned_v<Value>) return "a whole number from 0";
    if constexpr (std::is_integral_v<Value>) return "a whole number";
    if constexpr (std::is_floating_point_v<Value>) return "a number";
    if constexpr (std::is_same_v<Value, std::string>) return "a text";
    return {};
  }

  std::optional<pybind11::object> Find(const char* name);
  void GuardOutputs() const;
  // `expected`: what the argument takes; empty: said by its documentation alone.
  [[noreturn]] static void RefuseType(const char* name, const pybind11::object& value, std::string_view expected);
  [[noreturn]] void RefuseNumber(const char* name, const cli::Limits& limits);
  [[noreturn]] void RefuseWord(const char* name, const std::vector<std::string>& words);

  pybind11::dict values_;
  std::set<std::string> taken_;
  std::vector<std::string> inputs_, outputs_, output_atlases_;
};

// A str that may hold any bytes of a file's name, as C++ has it.
std::string TextOfPath(const pybind11::object& path);

// The vocabulary of a file, whole; none of an empty path.
std::optional<LoadedVocabulary> VocabularyAt(const std::string& path, int threads);

}  // namespace slamdb::python
