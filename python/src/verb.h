// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/words.h"
#include "python/src/arguments.h"
#include "python/src/errors.h"
#include "python/src/files.h"
#include "python/src/unlocked.h"
#include "slamdb/base/notices.h"
#include "slamdb/checks/check.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/results.h"

// How a verb of the library becomes a function of the module.
// It is defined by what makes its work out of the keyword arguments, with the GIL held; the work is done without it,
// and gives the report as JSON. Work takes what the options are of by value: nothing of Python.
namespace slamdb::python {

// A report in the words of the command, whose --json it is.
inline pybind11::str Report(const std::string& json) { return TextOf(cli::ReportInCommandWords(json)); }

// FUNCTION(atlas, {name: value}) -> (report, notices), for verbs that change the atlas. `prepare(given)` gives
// `work(atlas, notices)`, of which the result takes the place of the atlas; one that is empty is refused.
template <class Prepare>
void DefineChange(pybind11::module_& module, const char* name, const Prepare& prepare) {
  module.def(name, [prepare](HeldAtlas& atlas, const pybind11::dict& values) {
    Arguments given(values);
    const auto work = prepare(given);
    given.RequireAllTaken();
    Notices notices;
    const std::string report = atlas.Apply([&](Atlas& changed) {
      const Format& format = FormatById("orbslam3");
      InputSubstance before;
      before.Add(changed, &format);
      std::string json = work(changed, notices);
      RefuseEmptyResult(changed, before, "", format, /*dry_run=*/false, notices);
      return json;
    });
    return pybind11::make_tuple(Report(report), ListOf(notices));
  });
}

// FUNCTION({name: value}) -> (report, notices), for verbs that change nothing. `prepare(given)` gives `work(notices)`.
template <class Prepare>
void DefineReport(pybind11::module_& module, const char* name, const Prepare& prepare) {
  module.def(name, [prepare](const pybind11::dict& values) {
    Arguments given(values);
    const auto work = prepare(given);
    given.RequireAllTaken();
    Notices notices;
    const std::string report = WithoutGil([&] { return work(notices); });
    return pybind11::make_tuple(Report(report), ListOf(notices));
  });
}

// FUNCTION({name: value}) -> (atlas, report, notices), for verbs that make one. `prepare(given)` gives
// `work(atlas, notices)`, to which the atlas comes empty.
template <class Prepare>
void DefineMaker(pybind11::module_& module, const char* name, const Prepare& prepare) {
  module.def(name, [prepare](const pybind11::dict& values) {
    Arguments given(values);
    const auto work = prepare(given);
    given.RequireAllTaken();
    Notices notices;
    Atlas made;
    const std::string report = WithoutGil([&] { return work(made, notices); });
    return pybind11::make_tuple(std::make_shared<HeldAtlas>(std::move(made)), Report(report), ListOf(notices));
  });
}

// ignore, note, warn, error, strict, max_findings, gates, threads, progress.
CheckOptions CheckOptionsOf(Arguments& given);

// Holds the words of the atlas against the vocabulary of the file, and warns of what was computed anew; does nothing
// where no file is named.
void HoldWords(const std::string& vocabulary, int threads, Atlas& atlas, Notices& notices);

}  // namespace slamdb::python
