// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/sync.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/detail/chains.h"

namespace slamdb {
namespace {

using detail::Concat;

constexpr std::size_t kPage = 1000;  // atlases that are compared at once

// One of the two stores, opened when it is needed.
class Side {
 public:
  Side(const std::string& path, const SyncOptions& options) : path_(path), options_(options) {
    if (!HoldsNamedAtlases(path) && !std::filesystem::exists(path))
      throw Error(ErrorKind::kUsage, path, "", "is no name of a store, which ends in .db, .sqlite or .slamdb");
  }

  bool is_server() const { return detail::IsServer(path_); }
  bool is_missing() { return !writes_ && !store_ && Store::IsYetToBeMade(path_, options_.lock_timeout); }
  void Close() {
    store_.reset();
    writes_ = false;
  }

  std::vector<RevisionChain> Chains(const ChainQuery& query) {
    if (is_missing()) return {};
    std::vector<RevisionChain> chains = ToRead().Chains(query);
    // What a damaged log does not know cannot be compared.
    for (RevisionChain& chain : chains) std::erase_if(chain.links, [](const auto& link) { return link.hash == 0; });
    return chains;
  }
  RevisionChain Chain(const std::string& name, bool given_up) {
    std::vector<RevisionChain> found = Chains({.names = {name}, .given_up = given_up});
    return found.empty() ? RevisionChain{.name = name} : std::move(found.front());
  }
  Store& ToRead() {
    if (!store_) store_.emplace(Store::Open(path_, options_.lock_timeout));
    return *store_;
  }
  Store& ToWrite() {
    if (!writes_) {
      store_.reset();
      store_.emplace(Store::OpenForWriting(
          path_, {.sync = options_.sync, .lock_timeout = options_.lock_timeout, .progress = options_.progress}));
      writes_ = true;
    }
    return *store_;
  }

 private:
  std::string path_;
  const SyncOptions& options_;
  std::optional<Store> store_;
  bool writes_ = false;
};

// The host of `user@host`, as part of a name.
std::string HostOf(const std::string& who) {
  std::string host = who.substr(who.find('@') + 1);
  std::ranges::replace_if(
      host, [](char c) { return c == '#' || c == '/' || c == '@'; }, '-');
  return host.empty() ? "another" : host;
}

// Whether what happened to one atlas happens to others, too.
bool EndsAll(const Error& error) {
  return IsWorthRetrying(error) || error.kind() == ErrorKind::kOutOfResources ||
         error.kind() == ErrorKind::kPermission || error.kind() == ErrorKind::kInternal;
}

class Syncer {
 public:
  Syncer(const std::string& first, const std::string& second, const SyncOptions& options)
      : options_(options),
        first_(first, options),
        second_(second, options),
        names_(options.names.begin(), options.names.end()),
        report_{.first = detail::WithoutPassword(first), .second = detail::WithoutPassword(second)} {
    if (detail::IsSameFile(first, std::nullopt, second, std::nullopt))
      throw Error(ErrorKind::kUsage, second, "", "is the store that it is to be compared with; name another one");
  }

  SyncReport Run() {
    try {
      while (!GoOn()) {
      }
    } catch (const std::exception& error) {
      Stop(error.what());
      throw;
    } catch (...) {
      Stop("interrupted");
      throw;
    }
    return std::move(report_);
  }

 private:
  // True when all is done; false: once more from where it stopped.
  bool GoOn() {
    try {
      RequireStores();
      while (DoPage()) {
      }
      return true;
    } catch (const Error& error) {
      if (!IsWorthRetrying(error)) throw;
      if (tries_ >= options_.retries)
        throw Error(error.kind(), error.path(), error.place(),
                    Concat(error.problem(), "; what was copied stays, and the next run goes on from there"));
      Pause(error);
      first_.Close();
      second_.Close();
      return false;
    }
  }
  // Tells what was done; of the atlas that it stopped in, too.
  void Stop(const std::string& why) {
    if (!current_.revisions.empty()) {
      current_.result = SyncResult::kFailed;
      current_.failure = why;
      report_.atlases.push_back(std::move(current_));
    }
    if (options_.on_stopped) options_.on_stopped(report_);
  }
  void RequireStores() {
    const bool lacks_first = first_.is_missing();
    if (lacks_first && (options_.one_way || second_.is_missing()))
      throw Error(ErrorKind::kNotFound, report_.first, "", "there is no store");
  }
  void Pause(const Error& error) {
    using Clock = std::chrono::steady_clock;
    const double seconds = std::min(60.0, std::exp2(tries_++));
    if (options_.on_retry) options_.on_retry(error, seconds);
    for (const auto start = Clock::now(); std::chrono::duration<double>(Clock::now() - start).count() < seconds;) {
      Tell("waiting", 0);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  void Tell(std::string_view stage, double fraction) const {
    if (options_.progress) options_.progress(stage, fraction);
  }

  // Compares the next page of names, and copies what is missing. False: there was none.
  bool DoPage() {
    ChainQuery query{.after = done_, .count = kPage};
    if (!options_.names.empty()) {
      for (auto name = names_.upper_bound(done_); name != names_.end() && query.names.size() < kPage; ++name)
        query.names.push_back(*name);
      if (query.names.empty()) return false;
    }
    Tell("comparing", 0);
    std::vector<RevisionChain> first = first_.Chains(query), second = second_.Chains(query);
    std::set<std::string> names(query.names.begin(), query.names.end());
    for (const auto* chains : {&first, &second})
      for (const RevisionChain& chain : *chains) names.insert(chain.name);
    // Behind the last name of a full page either store may have more.
    if (query.names.empty())
      for (const auto* chains : {&first, &second})
        if (chains->size() == kPage) names.erase(names.upper_bound(chains->back().name), names.end());
    if (names.empty()) return false;
    AddGivenUp(names, first, second);
    std::size_t done = 0;
    for (const std::string& name : names) {
      Tell(name, static_cast<double>(done++) / static_cast<double>(names.size()));
      if (!branches_.contains(name)) SyncOne(name, detail::TakeChain(first, name), detail::TakeChain(second, name));
      done_ = name;
    }
    return true;
  }
  // Asks again for those where it may make a difference, with what was given up. In one question: a file goes through
  // all of its log for it.
  void AddGivenUp(const std::set<std::string>& names, std::vector<RevisionChain>& first,
                  std::vector<RevisionChain>& second) {
    ChainQuery query{.count = kPage, .given_up = true};
    for (const RevisionChain& chain : first) {
      const RevisionChain* const other = detail::FindChain(second, chain.name);
      if (other != nullptr && names.contains(chain.name) && detail::DependsOnGivenUp(chain, *other))
        query.names.push_back(chain.name);
    }
    if (query.names.empty()) return;
    for (RevisionChain& chain : first_.Chains(query)) *detail::FindChain(first, chain.name) = std::move(chain);
    for (RevisionChain& chain : second_.Chains(query)) *detail::FindChain(second, chain.name) = std::move(chain);
  }
  void Finish() {
    SyncedAtlas atlas = std::exchange(current_, {});
    if (atlas.result == SyncResult::kSame) ++report_.same;
    if (atlas.result == SyncResult::kSame && atlas.conflicts.empty() && atlas.alone.empty()) return;
    if (options_.on_done) options_.on_done(atlas);
    report_.atlases.push_back(std::move(atlas));
  }

  void SyncOne(const std::string& name, RevisionChain first, RevisionChain second) {
    constexpr int kAttempts = 5;                           // when others save the same atlas again and again meanwhile
    if (current_.name != name) current_ = {.name = name};  // else it stopped in the middle of this one
    for (int attempt = 1;; ++attempt) {
      try {
        Bring(current_, first, second);
        break;
      } catch (const Error& error) {
        const bool is_locked = error.kind() == ErrorKind::kLocked;
        const bool is_taken = error.kind() == ErrorKind::kAlreadyExists;  // the name of a branch, by another just now
        if ((is_locked || is_taken) && attempt < kAttempts && (HasChanged(name, first, second) || is_taken)) continue;
        if (EndsAll(error) && !(is_locked && IsOfOneAtlas(error))) throw;
        waits_no_more_ = waits_no_more_ || is_locked;
        current_.result = SyncResult::kFailed;
        current_.failure = error.what();
        break;
      }
    }
    Finish();
  }
  // A server that answers locks atlases one by one, and may have partitions on others that do not answer.
  bool IsOfOneAtlas(const Error& error) const {
    return detail::IsServer(error.path()) && (waits_no_more_ || tries_ >= options_.retries);
  }
  // Reads the chains anew. Throws what it throws: the connection may be lost.
  bool HasChanged(const std::string& name, RevisionChain& first, RevisionChain& second) {
    const auto newest = [](const RevisionChain& chain) { return chain.links.empty() ? 0 : chain.links.back().number; };
    const std::pair before(newest(first), newest(second));
    first = first_.Chain(name, true);
    second = second_.Chain(name, true);
    return before != std::pair(newest(first), newest(second));
  }

  void Bring(SyncedAtlas& atlas, RevisionChain& first, RevisionChain& second) {
    if (first.links.empty() && second.links.empty())
      throw Error(ErrorKind::kNotFound,
                  Concat("neither ", report_.first, " nor ", report_.second, " has an atlas named '", atlas.name, "'"));
    const detail::Compared compared = detail::Compare(first, second);
    using enum detail::Compared::State;
    switch (compared.state) {
      case kSame:
        break;
      case kSecondBehind:
        Copy(first_, second_, first, compared.missing, second, atlas);
        break;
      case kFirstBehind:
        if (options_.one_way) {
          atlas.result = SyncResult::kAhead;
        } else {
          atlas.to_first = true;
          Copy(second_, first_, second, compared.missing, first, atlas);
        }
        break;
      case kDiverged:
        atlas.result = SyncResult::kDiverged;
        if (options_.branch_diverged) Branch(atlas, first, second, compared.missing);
        break;
    }
    BringTags(atlas, first, second);
    TellAlone(atlas, first, second);
  }
  // What diverged, or is ahead where it is not to be copied, is told of as such.
  void TellAlone(SyncedAtlas& atlas, const RevisionChain& first, const RevisionChain& second) const {
    atlas.alone.clear();  // of an attempt before
    if (atlas.result != SyncResult::kSame && atlas.result != SyncResult::kCopied) return;
    const auto tell = [&](const RevisionChain& chain, const RevisionChain& other, bool in_first) {
      SyncedAtlas::Alone alone{.in_first = in_first};
      for (const RevisionChain::Link& link : detail::LinksAlone(chain, other)) alone.revisions.push_back(link.number);
      for (const RevisionChain::Tag& tag : chain.tags)
        if (!Has(other, tag) && std::ranges::binary_search(alone.revisions, tag.number)) alone.tags.push_back(tag.name);
      if (!alone.revisions.empty()) atlas.alone.push_back(std::move(alone));
    };
    tell(first, second, true);
    if (!options_.one_way) tell(second, first, false);
  }

  // Copies the links of `source` from `missing` on; `target` comes to have them.
  void Copy(Side& from, Side& to, const RevisionChain& source, std::size_t missing, RevisionChain& target,
            SyncedAtlas& atlas) {
    Atlas base;
    for (std::size_t i = missing; i < source.links.size(); ++i) {
      const RevisionChain::Link& link = source.links[i];
      RevisionChain::Link copy = link;
      if (!target.links.empty()) copy.number = std::max(link.number, target.links.back().number + 1);
      if (!options_.dry_run) {
        if (i == missing && from.is_server() && !target.links.empty())
          base = to.ToRead().LoadOnto({target.name, target.links.back().number}, {}, {.threads = options_.threads});
        const double part = static_cast<double>(i - missing), all = static_cast<double>(source.links.size() - missing);
        const std::string stage = Concat(source.name, ", revision ", link.number);
        CopyOne(from, to, {source.name, link.number}, target, copy.number, base,
                [&](double of_this) { Tell(stage, (part + of_this) / all); });
      }
      target.links.push_back(copy);
      atlas.revisions.push_back(link.number);
      atlas.result = SyncResult::kCopied;
    }
  }
  // `base`: what `from` has of it need not be sent; becomes the revision.
  template <class Report>
  void CopyOne(Side& from, Side& to, const RevisionName& revision, const RevisionChain& target, std::uint64_t number,
               Atlas& base, const Report& report) {
    report(0);
    const HistoryEntry entry = from.ToRead().LogOf(revision);
    Atlas atlas = from.ToRead().LoadOnto(
        revision, base,
        {.threads = options_.threads, .progress = [&](std::string_view, double part) { report(part / 2); }});
    base = Atlas();
    SaveOptions save{.provenance = entry.provenance,
                     .overwrite = !target.links.empty(),
                     .from = entry.from,
                     .recorded = Recorded{number, entry.at, entry.who, entry.tool},
                     .threads = options_.threads,
                     .progress = [&](std::string_view, double part) { report(0.5 + part / 2); }};
    if (!target.links.empty()) save.onto = target.links.back().number;
    if (begins_as_) save.from = std::exchange(begins_as_, std::nullopt);
    to.ToWrite().Save(target.name, atlas, save);
    base = std::move(atlas);
    tries_ = 0;
  }

  // What the second has under the name that a line of the first goes to: NAME-of-HOST, or, where other atlases are
  // called that in either store, as those of another robot of that host name, the first of NAME-of-HOST-2, -3, ... that
  // is free or has some of the line.
  RevisionChain BranchFor(const RevisionChain& line) {
    const HistoryEntry newest = first_.ToRead().LogOf({line.name, line.links.back().number});
    const std::string name = Concat(line.name, "-of-", HostOf(newest.who));
    const auto of_line = [&line](Side& side, const std::string& numbered) -> std::optional<RevisionChain> {
      RevisionChain chain = side.Chain(numbered, false);
      if (detail::DependsOnGivenUp(line, chain)) chain = side.Chain(numbered, true);
      if (detail::Compare(line, chain).state == detail::Compared::State::kDiverged) return std::nullopt;
      return chain;
    };
    for (int count = 1;; ++count) {
      const std::string numbered = count == 1 ? name : Concat(name, "-", count);
      std::optional<RevisionChain> branch = of_line(second_, numbered);
      if (branch && of_line(first_, numbered)) return *std::move(branch);
    }
  }
  // What the first made of the last revision that both have goes to the second under another name, beginning with that.
  void Branch(SyncedAtlas& atlas, const RevisionChain& first, const RevisionChain& second, std::size_t missing) {
    RevisionChain line = first;
    if (missing > 0)
      line.links.erase(line.links.begin(), line.links.begin() + static_cast<std::ptrdiff_t>(missing) - 1);
    RevisionChain branch = BranchFor(line);
    atlas.branch = branch.name;
    const detail::Compared compared = detail::Compare(line, branch);
    begins_as_.reset();
    if (branch.links.empty() && missing > 0) {
      const RevisionChain::Link& base = line.links.front();
      begins_as_ = RevisionName{second.name, detail::NumberOf(second, base), base.hash};
    }
    if (compared.state == detail::Compared::State::kSecondBehind)
      Copy(first_, second_, line, compared.missing, branch, atlas);
    for (const RevisionChain::Tag& tag : first.tags)
      if (!Has(branch, tag) && detail::NumberOf(second, {tag.number, detail::HashOf(first, tag.number)}) == 0)
        BringTag(atlas, tag, line, branch, second_);
    if (!atlas.revisions.empty()) branches_.insert(atlas.branch);
    atlas.result = SyncResult::kBranched;
  }

  static bool Has(const RevisionChain& chain, const RevisionChain::Tag& tag) {
    return std::ranges::find(chain.tags, tag.name, &RevisionChain::Tag::name) != chain.tags.end();
  }
  void BringTags(SyncedAtlas& atlas, const RevisionChain& first, const RevisionChain& second) {
    for (const RevisionChain::Tag& tag : first.tags) {
      const auto other = std::ranges::find(second.tags, tag.name, &RevisionChain::Tag::name);
      if (other == second.tags.end())
        BringTag(atlas, tag, first, second, second_);
      else if (detail::HashOf(first, tag.number) != detail::HashOf(second, other->number))
        atlas.conflicts.push_back({tag.name, tag.number, other->number});
    }
    if (options_.one_way) return;
    for (const RevisionChain::Tag& tag : second.tags)
      if (!Has(first, tag)) BringTag(atlas, tag, second, first, first_);
  }
  // Where the other store has no such revision any more, the tag stays where it is.
  void BringTag(SyncedAtlas& atlas, const RevisionChain::Tag& tag, const RevisionChain& source,
                const RevisionChain& target, Side& to) {
    const auto link = std::ranges::find(source.links, tag.number, &RevisionChain::Link::number);
    const std::uint64_t number = link == source.links.end() ? 0 : detail::NumberOf(target, *link);
    if (number == 0) return;
    const RevisionName revision{target.name, number};
    if (!options_.dry_run) {
      if (to.ToWrite().FindRevision(revision.ToString()).atlas != target.name)
        throw Error(ErrorKind::kNotPossible, to.ToRead().path(), "",
                    Concat("an atlas is called '", revision.ToString(), "', which hides the revision that the tag '",
                           tag.name, "' is for"));
      to.ToWrite().Tag(revision.ToString(), tag.name);
      tries_ = 0;
    }
    atlas.tags.push_back({tag.name, &to == &first_});
    if (atlas.result == SyncResult::kSame) atlas.result = SyncResult::kCopied;
  }

  const SyncOptions& options_;
  Side first_, second_;
  const std::set<std::string> names_;
  std::set<std::string> branches_;         // names in the second that diverged revisions were copied to just now
  SyncedAtlas current_;                    // while it is at work on one
  std::string done_;                       // the last name that is done
  int tries_ = 0;                          // since something was copied
  bool waits_no_more_ = false;             // for single atlases: one was waited for in vain
  std::optional<RevisionName> begins_as_;  // what the next revision that is copied is branched off
  SyncReport report_;
};

}  // namespace

std::uint64_t SyncReport::Count(SyncResult result) const {
  if (result == SyncResult::kSame) return same;
  return static_cast<std::uint64_t>(std::ranges::count(atlases, result, &SyncedAtlas::result));
}

std::uint64_t SyncReport::Conflicts() const {
  std::uint64_t count = 0;
  for (const SyncedAtlas& atlas : atlases) count += atlas.conflicts.size();
  return count;
}

SyncReport SyncStores(const std::string& first, const std::string& second, const SyncOptions& options) {
  return Syncer(first, second, options).Run();
}

}  // namespace slamdb
