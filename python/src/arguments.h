// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/eigen.h>  // in every unit, so that all convert alike
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "python/src/held_atlas.h"
#include "slamdb/base/progress.h"
#include "slamdb/formats/dbow2/vocabulary.h"

namespace slamdb::python {

struct AtlasOrPath {
  std::shared_ptr<const Atlas> atlas;  // null: it is the path
  std::string path;                    // both empty: nothing was given

  bool any() const { return atlas != nullptr || !path.empty(); }
};

// The keyword arguments of a verb. What is None leaves the library's default as it is.
// To be used with the GIL held; what a Progress of it calls is kept alive by it.
class Arguments {
 public:
  explicit Arguments(pybind11::dict values) : values_(std::move(values)) {}

  bool Has(const char* name) { return Find(name).has_value(); }

  // Throws TypeError for what is no such value.
  template <class Value>
  void Take(const char* name, Value& into) {
    const std::optional<pybind11::object> value = Find(name);
    if (!value) return;
    try {
      into = value->cast<Value>();
    } catch (const pybind11::cast_error&) {
      RefuseType(name, *value);
    }
  }
  template <class Value>
  void Take(const char* name, std::optional<Value>& into) {
    if (Has(name)) Take(name, into.emplace());
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

  // A str or os.PathLike; empty: none.
  std::string Path(const char* name);

  // An atlas, or the path of what is to be read.
  AtlasOrPath SourceAt(const char* name);
  std::vector<AtlasOrPath> Sources(const char* name);

  // The value of an atlas.
  std::shared_ptr<const Atlas> AtlasAt(const char* name);

  int threads() { return Get<int>("threads"); }
  slamdb::Progress progress();

  template <class Options>
  void TakeRun(Options& options) {
    options.threads = threads();
    options.progress = progress();
  }

  // Throws RuntimeError when an argument was given that nobody took, which would be without effect.
  void RequireAllTaken() const;

 private:
  std::optional<pybind11::object> Find(const char* name);
  [[noreturn]] static void RefuseType(const char* name, const pybind11::object& value);
  [[noreturn]] void RefuseWord(const char* name, const std::vector<std::string>& words);

  pybind11::dict values_;
  std::set<std::string> taken_;
};

// A str that may hold any bytes of a file's name, as C++ has it.
std::string TextOfPath(const pybind11::object& path);

// The vocabulary of a file, whole; none of an empty path.
std::optional<LoadedVocabulary> VocabularyAt(const std::string& path, int threads);

}  // namespace slamdb::python
