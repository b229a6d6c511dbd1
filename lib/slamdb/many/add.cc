// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/add.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/detail/read_ahead.h"
#include "slamdb/many/detail/store_names.h"
#include "slamdb/model/content.h"
#include "slamdb/model/digest.h"

namespace slamdb {
namespace {

using detail::Concat;

// An input that was read, or not.
struct Loaded {
  AddedAtlas outcome;
  Atlas atlas;
};

// What the store holds by now.
struct Held {
  std::map<std::string, std::uint64_t> hashes;  // by name
  detail::HeldNames names;

  void Add(const std::string& name, std::uint64_t hash) {
    hashes[name] = hash;
    names.Add(name);
  }
};

Held HashesIn(const std::string& store, double lock_timeout) {
  Held held;
  if (Store::IsYetToBeMade(store, lock_timeout)) return held;
  for (const StoredAtlas& atlas : Store::Open(store, lock_timeout).List()) held.Add(atlas.name, atlas.hash);
  return held;
}

void RequireStore(const std::string& store, const AtlasInputs& inputs, const AddOptions& options) {
  if (!HoldsNamedAtlases(store) && !std::filesystem::exists(store))
    throw Error(ErrorKind::kUsage, store, "", "is no name of a store, which ends in .db, .sqlite or .slamdb");
  if (!options.name.empty() && inputs.atlases.size() > 1)
    throw Error(ErrorKind::kUsage, store, "",
                Concat("one name is given for ", inputs.atlases.size(), " atlases; name one of them, or none"));
}

class Adder {
 public:
  Adder(const std::string& store, std::vector<AtlasInput> inputs, const AddOptions& options)
      : inputs_(std::move(inputs)),
        options_(options),
        names_(detail::StoreNamesOf(inputs_, options)),
        held_(HashesIn(store, options.lock_timeout)),
        before_(held_),
        report_{.store = detail::WithoutPassword(store), .dry_run = options.dry_run} {}

  AddReport Run() {
    TellNames();
    try {
      AddAll();
    } catch (...) {
      for (std::size_t i = report_.atlases.size(); i < inputs_.size(); ++i)
        report_.atlases.push_back(
            {.input = inputs_[i].location.ToString(), .name = names_[i].name, .result = AddResult::kNotTried});
      report_.in_store = held_.hashes.size();
      if (options_.on_stopped) options_.on_stopped(report_);
      throw;
    }
    report_.in_store = store_ ? store_->Names().size() : held_.hashes.size();  // others may have added some meanwhile
    return std::move(report_);
  }

 private:
  void AddAll() {
    detail::ReadAhead<Loaded> ahead(inputs_.size(), [this](std::size_t i) { return Read(i); });
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      Report(i, 0);
      Loaded loaded = ahead.Take([&] { Report(i, 0); });
      if (loaded.outcome.failure.empty()) Add(i, loaded);
      if (options_.on_done) options_.on_done(loaded.outcome);
      report_.atlases.push_back(std::move(loaded.outcome));
    }
  }

  void TellNames() const {
    if (!options_.on_names) return;
    std::vector<std::string> names;
    for (const detail::StoreName& name : names_) names.push_back(name.name);
    options_.on_names(names);
  }

  void Report(std::size_t i, double of_this) const {
    if (options_.progress)
      options_.progress(Concat(i + 1, " of ", inputs_.size()),
                        (static_cast<double>(i) + of_this) / static_cast<double>(inputs_.size()));
  }

  // On a thread of its own. What the store held at the beginning is compared by hashes.
  Loaded Read(std::size_t i) const {
    const AtlasInput& input = inputs_[i];
    Loaded loaded{.outcome = {.input = input.location.ToString(), .name = names_[i].name, .failure = input.failure}};
    if (!input.failure.empty()) return loaded;
    AddedAtlas& outcome = loaded.outcome;
    try {
      ReadOptions read{.format = options_.format, .needs = Content::kPoints | Content::kLandmarks};
      read.threads = std::max(1, detail::ThreadCount(options_.threads) - 1);
      read.of<StoreReadOptions>().lock_timeout = options_.lock_timeout;
      read.of<Orbslam3ReadOptions>().layout = options_.layout;
      loaded.atlas = ReadAtlas(input.location, read, &outcome.notices);
      outcome.summary = Summarize(loaded.atlas);
      if (options_.dry_run || before_.hashes.contains(outcome.name) || !before_.names.DerivedOf(names_[i]).empty())
        outcome.hash = HashOf(loaded.atlas, read.threads);
    } catch (const Error& error) {
      outcome.failure = error.what();
    }
    return loaded;
  }

  void Add(std::size_t i, Loaded& loaded) {
    AddedAtlas& outcome = loaded.outcome;
    KeepNameInStore(i, loaded);
    if (const std::string_view lacks = SubstanceOf(loaded.atlas, /*with_bad=*/true).Lacks(); !lacks.empty())
      outcome.notices.Warn(Concat(outcome.input, ": holds no ", lacks));
    const bool taken = held_.hashes.contains(outcome.name);
    if (taken && outcome.hash == 0) outcome.hash = HashOf(loaded.atlas, options_.threads);
    if (taken && held_.hashes[outcome.name] == outcome.hash)
      outcome.result = AddResult::kUnchanged;
    else if (outcome.failure = ProblemOf(outcome, taken); !outcome.failure.empty())
      return;
    else if (options_.dry_run)
      outcome.result = taken ? AddResult::kReplaced : AddResult::kAdded;
    else
      Save(i, loaded);
    if (!outcome.failure.empty()) return;
    held_.Add(outcome.name, outcome.hash);
    mine_.insert(outcome.name);
  }

  // Under which it is held as it is, though it would be called otherwise today: names depend on what else is there.
  void KeepNameInStore(std::size_t i, Loaded& loaded) {
    AddedAtlas& outcome = loaded.outcome;
    const std::vector<std::string> names = held_.names.DerivedOf(names_[i]);
    if (!names.empty() && outcome.hash == 0) outcome.hash = HashOf(loaded.atlas, options_.threads);
    const auto is_it = [&](const std::string& name) { return held_.hashes.at(name) == outcome.hash; };
    const bool as_today = held_.hashes.contains(outcome.name) && is_it(outcome.name);
    const auto same = std::ranges::find_if(names, is_it);
    if (!as_today && same != names.end()) outcome.name = *same;
    if (outcome.name != names_[i].name)
      outcome.notices.Note(Concat(outcome.input, ": is in the store as '", outcome.name, "' and keeps that name"));
    else if (names_[i].with_folder)
      outcome.notices.Note(Concat(outcome.input, ": is named '", outcome.name,
                                  "', with its folder, as others would have the same name without"));
  }

  // Why it cannot be saved under its name; empty: it can.
  std::string ProblemOf(const AddedAtlas& outcome, bool taken) const {
    if (!IsNameOfAtlas(outcome.name))
      return Concat(outcome.input, ": an atlas cannot be named '", outcome.name,
                    "'; AddOptions::name gives another name");
    if (mine_.contains(outcome.name))
      return Concat(outcome.input, ": another input was saved as '", outcome.name,
                    "' just now; add it by itself, with AddOptions::name");
    if (taken && !options_.overwrite)
      return Concat(
          outcome.input, ": ", report_.store, " holds another atlas named '", outcome.name,
          "'; WriteOptions::overwrite saves this one as its next revision, AddOptions::name under another name");
    return {};
  }

  void Save(std::size_t i, Loaded& loaded) {
    AddedAtlas& outcome = loaded.outcome;
    if (!store_)
      store_.emplace(Store::OpenForWriting(
          report_.store,
          {.sync = options_.sync, .lock_timeout = options_.lock_timeout, .progress = options_.progress}));
    try {
      const SaveReport saved = store_->Save(outcome.name, loaded.atlas,
                                            {.provenance = Concat(options_.provenance, outcome.input),
                                             .overwrite = options_.overwrite,
                                             .keep_equal = true,
                                             .verify = true,
                                             .threads = options_.threads,
                                             .progress = [&](std::string_view, double part) { Report(i, part); }});
      outcome.hash = saved.hash;
      outcome.result = saved.unchanged  ? AddResult::kUnchanged  // another program saved it meanwhile
                       : saved.replaced ? AddResult::kReplaced
                                        : AddResult::kAdded;
    } catch (const Error& error) {
      outcome.failure = error.what();
      if (error.kind() == ErrorKind::kAlreadyExists || error.kind() == ErrorKind::kUsage) return;
      report_.atlases.push_back(std::move(outcome));  // nor could others be saved
      throw;
    }
  }

  const std::vector<AtlasInput> inputs_;
  const AddOptions& options_;
  const std::vector<detail::StoreName> names_;
  Held held_;
  const Held before_;           // as the store held it at the beginning
  std::set<std::string> mine_;  // names of this run
  std::optional<Store> store_;  // opened when there is something to save
  AddReport report_;
};

}  // namespace

std::uint64_t AddReport::Count(AddResult result) const {
  return static_cast<std::uint64_t>(std::ranges::count(atlases, result, &AddedAtlas::result));
}

AddReport AddToStore(const std::string& store, const AtlasInputs& inputs, const AddOptions& options) {
  RequireStore(store, inputs, options);
  std::vector<AtlasInput> others = inputs.atlases;
  std::erase_if(others, [&](const AtlasInput& input) {
    if (!detail::IsSameFile(input.location.path, std::nullopt, store, std::nullopt)) return false;
    if (input.below.empty() && options.name.empty())
      throw Error(ErrorKind::kUsage, store, "",
                  Concat("is an input, too, as ", input.location.path,
                         ": leave that out; AddOptions::name gives a single atlas of it another name"));
    return !input.below.empty();
  });
  return Adder(store, std::move(others), options).Run();
}

}  // namespace slamdb
