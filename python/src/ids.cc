// SPDX-License-Identifier: BSD-3-Clause
#include "cli/choices.h"
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/edit/ids/origin.h"
#include "slamdb/edit/ids/renumber.h"

// Verbs that change ids. slamdb/ids.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

struct Renumbering {
  RenumberOptions options;
  std::string apply, undo, of;  // files, and an input of theirs
  OutputFile id_map;

  IdMap Do(Atlas& atlas, Notices& notices) const {
    if (apply.empty() && undo.empty()) return Renumber(atlas, options);
    const IdMap table = ReadIdMap(apply.empty() ? undo : apply, of, &notices);
    const IdMap ids = apply.empty() ? Inverse(table) : table;
    ApplyIdMap(atlas, ids, options.threads);
    return ids;
  }
};

void DefineRenumber(py::module_& module) {
  DefineChange(module, "renumber", [](Arguments& given) {
    Renumbering renumbering;
    RenumberOptions& options = renumbering.options;
    if (given.Has("kinds")) options.kinds = IdKindsByName(given.Get<std::vector<std::string>>("kinds"));
    given.Take("start", options.start);
    given.Take("offset", options.offset);
    given.TakeWord("order", cli::kIdOrders, options.order);
    given.TakeRun(options);
    renumbering.apply = given.Path("apply");
    renumbering.undo = given.Path("undo");
    given.Take("of", renumbering.of);
    renumbering.id_map = given.Output("id_map");
    if (!renumbering.apply.empty() || !renumbering.undo.empty())
      given.RefuseIdle({"start", "offset", "order"}, "goes with neither apply= nor undo=");
    if (!renumbering.apply.empty()) given.RefuseIdle({"undo"}, "excludes apply=");
    if (given.Has("offset")) given.RefuseIdle({"start", "order"}, "excludes offset=");
    return [renumbering](Atlas& atlas, Notices& notices) {
      const IdMap ids = renumbering.Do(atlas, notices);
      if (renumbering.id_map.any()) WriteIdMaps({&ids, 1}, renumbering.id_map.path, renumbering.id_map.options);
      return ToJson(SummaryOf(ids));
    };
  });
}

void DefineReassignOrigin(py::module_& module) {
  DefineChange(module, "reassign_origin", [](Arguments& given) {
    OriginOptions options;
    given.Take("from_map", options.from_map);
    given.Take("set", options.set);
    for (const auto& [from, to] : given.Get<std::map<std::uint32_t, std::uint32_t>>("map"))
      options.replace.emplace_back(from, to);
    given.Take("shift", options.shift);
    given.Take("compact", options.compact);
    if (!options.from_map && !options.set && options.replace.empty() && options.shift == 0 && !options.compact)
      throw Error(ErrorKind::kUsage, "nothing to do: give from_map=, set=, map=, shift= or compact=");
    return [options](Atlas& atlas, Notices&) { return ToJson(ReassignOrigins(atlas, options)); };
  });
}

}  // namespace

void DefineIds(py::module_& module) {
  DefineRenumber(module);
  DefineReassignOrigin(module);
}

}  // namespace slamdb::python
