// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/inputs.h"

#include <fnmatch.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/detail/recognize.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/detail/natural.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using detail::Concat;

// Suffixes that nothing but atlases has: a file of that name that holds none is broken, which its user wants to know.
constexpr std::array<std::string_view, 7> kOfAtlasesAlone = {".osa",     ".osa.txt",  ".slamdb",     ".mrpt",
                                                             ".mrpt.gz", ".mrpt.txt", ".mrpt.txt.gz"};

constexpr std::string_view kNotInLog =
    "table history has lost what it was when it was saved, and so whether it still is that: the store is damaged";

bool HoldsAtlases(const Format& format) {
  return format.read != nullptr && HasAny(format.reads, Content::kObservations | Content::kLandmarks);
}

bool EndsWith(std::string_view name, std::string_view suffix) {
  const auto lower = [](char letter) { return static_cast<char>(std::tolower(static_cast<unsigned char>(letter))); };
  return name.size() > suffix.size() && std::ranges::equal(name.substr(name.size() - suffix.size()), suffix, {}, lower);
}

const Format* FormatByContent(const std::string& path) {
  try {
    const Probe probe = Probe::Of(path);
    for (const Format& format : Formats())
      if (HoldsAtlases(format) && format.is_folder == probe.is_directory && format.sniff != nullptr &&
          format.sniff(probe))
        return &format;
  } catch (const Error&) {  // nothing that can be read
  }
  return nullptr;
}

// The format of a file in a folder when that is an atlas, or was meant to be one.
const Format* FormatInFolder(const std::string& path, std::string_view name) {
  const Format* by_suffix = detail::FormatBySuffix(name, HoldsAtlases);
  if (by_suffix == nullptr && name.find('.') != std::string_view::npos) return nullptr;
  if (std::ranges::any_of(kOfAtlasesAlone, [&](std::string_view suffix) { return EndsWith(name, suffix); }))
    return by_suffix;
  return FormatByContent(path);
}

class Finder {
 public:
  Finder(const FindAtlasesOptions& options, AtlasInputs& found) : options_(options), found_(found) {}

  void Find(const std::string& name) {
    const Location location(name);
    if (!location.is_server() && IsFolderOfAtlases(name)) return FindInFolder(name);
    const bool stands_for_many = location.name.empty() || IsPattern(location.name) || IsToBeUnfolded(location);
    if (HoldsNamedAtlases(location.path) && stands_for_many) return FindInStore(location, "");
    found_.atlases.push_back({.location = location});
  }

 private:
  struct File {
    std::string below;  // its path from the folder on that was named
    bool is_store = false;
  };

  static bool IsFolderOfAtlases(const std::string& name) {
    std::error_code failed;
    return name != "-" && fs::is_directory(name, failed) && FormatByContent(name) == nullptr;
  }

  static bool IsPattern(const std::string& name) { return name.find_first_of("*?[") != std::string::npos; }

  // A name without a revision, where all of them are wanted.
  bool IsToBeUnfolded(const Location& location) const {
    return options_.revisions && location.name.find('@') == std::string::npos;
  }

  void Fail(Location location, const std::string& below, std::string failure) {
    found_.atlases.push_back(
        {.location = std::move(location), .below = below, .failure = detail::WithoutPasswords(std::move(failure))});
  }

  // Those of a store, all or as the location's name has it.
  void FindInStore(const Location& store, const std::string& below) {
    std::optional<Store> opened;
    std::vector<std::string> names;
    try {
      opened = Store::Open(store.path, options_.lock_timeout);
      names = opened->Names();
    } catch (const Error& error) {
      return Fail(store, below, error.what());
    }
    if (names.empty()) return found_.empty_stores.push_back(detail::WithoutPassword(store.path));
    const bool all = store.name.empty();
    if (!all && !std::ranges::count(names, store.name))
      std::erase_if(names,
                    [&](const std::string& name) { return ::fnmatch(store.name.c_str(), name.c_str(), 0) != 0; });
    else if (!all)
      names = {store.name};
    if (names.empty()) return Fail(store, below, store.path + ": no atlas is named like '" + store.name + "'");
    // A store tells them by their letters, which mostly is their order already.
    if (!std::ranges::is_sorted(names, detail::NaturalLess)) std::ranges::sort(names, detail::NaturalLess);
    if (options_.revisions) try {
        return FindRevisions(*opened, names, below);
      } catch (const Error& error) {
        return Fail(store, below, error.what());
      }
    for (const std::string& name : names)
      found_.atlases.push_back({.location = Location(store.path, name), .below = below});
  }

  void FindRevisions(Store& store, const std::vector<std::string>& names, const std::string& below) {
    const ChainQuery all;
    const std::vector<std::string> stored = store.Names();
    const std::set<std::string_view> all_names(stored.begin(), stored.end());
    for (std::size_t first = 0; first < names.size(); first += all.count) {
      const std::size_t end = std::min(names.size(), first + all.count);
      std::map<std::string, RevisionChain> chains;
      for (RevisionChain& chain : store.Chains({.names = {names.begin() + first, names.begin() + end}}))
        chains.emplace(chain.name, std::move(chain));
      for (std::size_t i = first; i < end; ++i) AddRevisions(store.path(), chains[names[i]], all_names, below);
    }
  }

  // Each that there is, and the tags of those that there should be.
  void AddRevisions(const std::string& path, const RevisionChain& chain, const std::set<std::string_view>& all_names,
                    const std::string& below) {
    for (const RevisionChain::Link& link : chain.links) {
      AtlasInput& input = found_.atlases.emplace_back();
      input = {.location = Location(path, Concat(chain.name, "@", link.number)), .below = below, .hash = link.hash};
      const std::string_view why = all_names.contains(input.location.name)
                                       ? "an atlas is called so, which hides the revision"
                                   : link.hash == 0 ? kNotInLog
                                                    : "";
      if (!why.empty()) input.failure = Concat(input.location.ToString(), ": ", why);
    }
    for (const RevisionChain::Tag& tag : chain.tags) {
      if (std::ranges::find(chain.links, tag.number, &RevisionChain::Link::number) != chain.links.end()) continue;
      const Location location(path, Concat(chain.name, "@", tag.name));
      Fail(location, below,
           Concat(location.ToString(), ": tag '", tag.name, "' is of revision ", tag.number,
                  ", which is gone: the store is damaged"));
    }
  }

  void FindInFolder(const std::string& folder) {
    const std::size_t before = found_.atlases.size(), empty_before = found_.empty_stores.size();
    std::vector<File> files;
    entered_.clear();
    others_ = folders_ = 0;
    Walk(folder, "", files);
    std::ranges::sort(files, detail::NaturalLess, &File::below);
    for (const auto& [below, is_store] : files) {
      const std::string path = (fs::path(folder) / below).string();
      if (is_store)
        FindInStore(Location(path, ""), below);
      else
        found_.atlases.push_back({.location = Location(path, ""), .below = below});
    }
    if (found_.atlases.size() == before && found_.empty_stores.size() == empty_before)
      Fail(Location(folder, ""), "", WhyEmpty(folder));
  }

  std::string WhyEmpty(const std::string& folder) const {
    const auto known = detail::RecognizeOther(Probe::Of(folder));
    if (known && known->kind == ErrorKind::kUnsupported) return Concat(folder, ": ", known->sentence);
    std::string besides;
    if (others_ > 0) besides = Concat("; of its ", detail::Counted(others_, "file"), " none is an atlas");
    if (folders_ > 0)
      besides +=
          Concat("; ", detail::Counted(folders_, "folder"), " in it, into which FindAtlasesOptions::recursive looks");
    return Concat(folder, ": no atlas in this folder", besides);
  }

  // False for a folder that was entered before, by this path or another.
  bool Enter(const std::string& folder) {
    struct stat status {};
    return ::stat(folder.c_str(), &status) != 0 || entered_.emplace(status.st_dev, status.st_ino).second;
  }

  void Walk(const std::string& top, const std::string& below, std::vector<File>& files) {
    const std::string folder = below.empty() ? top : (fs::path(top) / below).string();
    if (!Enter(folder)) return;
    std::error_code failed;
    std::vector<std::string> inner;
    for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
      const std::string name = entry->path().filename().string();
      CountEntry(top);
      const std::string path = below.empty() ? name : below + "/" + name;
      if (name.starts_with('.'))
        ++found_.skipped.hidden;
      else if (std::error_code ignored; entry->is_directory(ignored))
        inner.push_back(path);
      else if (!entry->is_regular_file(ignored))
        ++found_.skipped.special;
      else if (const Format* format = FormatInFolder(entry->path().string(), name))
        files.push_back({path, format->named});
      else
        ++found_.skipped.others, ++others_;
    }
    if (failed) return Fail(Location(folder, ""), below, folder + ": cannot be read: " + failed.message());
    if (!options_.recursive) {
      found_.skipped.folders += inner.size();
      folders_ += inner.size();
      return;
    }
    for (const std::string& path : inner) Walk(top, path, files);
  }

  void CountEntry(const std::string& top) {
    if (++entries_ > options_.most)
      throw Error(ErrorKind::kOutOfResources, top, "",
                  Concat("holds more than ", detail::Thousands(options_.most), " files; name a smaller folder"));
    constexpr std::uint64_t kPerReport = 256;
    if (options_.progress && entries_ % kPerReport == 0) options_.progress("looking for atlases", 0);
  }

  const FindAtlasesOptions& options_;
  AtlasInputs& found_;
  std::set<std::pair<dev_t, ino_t>> entered_;
  std::uint64_t entries_ = 0;
  std::uint64_t others_ = 0, folders_ = 0;  // of the folder that was named last
};

}  // namespace

AtlasInputs FindAtlases(std::span<const std::string> named, const FindAtlasesOptions& options) {
  AtlasInputs found;
  Finder finder(options, found);
  for (const std::string& name : named) finder.Find(name);
  return found;
}

}  // namespace slamdb
