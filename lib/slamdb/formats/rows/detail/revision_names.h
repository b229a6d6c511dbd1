// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/rows/revisions.h"
#include "slamdb/formats/rows/stored.h"

// What NAME@WHICH means, as far as that can be told without a store (revisions.h).
namespace slamdb::rows {

// What it stands for.
struct Named {
  std::int64_t atlas = 0;  // its row
  std::string name;        // of the atlas
  std::int64_t number = 0, newest = 0;
  bool is_newest() const { return number == newest; }
};

struct SplitName {
  std::string_view name, which;
};
// At the last @; nothing when there is none.
std::optional<SplitName> SplitAtRevision(std::string_view text);

// Whether something that ends like this reads like a revision whatever the store has: a number, a date.
bool LooksLikeRevision(std::string_view name);

// How WHICH tells a revision.
struct Which {
  enum class Kind { kNumber, kBy, kTag };
  Kind kind = Kind::kTag;
  std::int64_t number = 0;  // kNumber
  std::string by;           // kBy: the last moment that counts, UTC, as `saved_at` is written
};
// `newest`: of its atlas, from which negative numbers count. Throws Error (kUsage), with `path`, for a date that is
// none.
Which ParseWhich(std::string_view which, std::int64_t newest, const std::string& path);

// `2, 5 to 9`.
std::string Ranges(const std::vector<std::int64_t>& numbers);

// The errors of all stores. `numbers`: revisions that there are; `tags`: those of the atlas; `names`: of all atlases.
Error NoSuchRevision(const std::string& path, const Named& of, std::string_view which,
                     const std::vector<std::int64_t>& numbers, const std::vector<std::string>& tags,
                     std::string_view why = {});
Error NoSuchAtlas(const std::string& path, std::string_view name, const std::vector<std::string>& names);
Error NoSuchTag(const std::string& path, const std::string& atlas, const std::string& tag,
                const std::vector<std::string>& tags);
Error TagIsTaken(const std::string& path, const std::string& atlas, const std::string& tag, std::int64_t revision);

Error AtlasIsThere(const std::string& path, const std::string& name);

// Throws Error (kLocked) unless the atlas' newest revision is the one that a save goes on from.
void CheckIsNewest(const std::string& path, const std::string& name, std::int64_t newest, std::uint64_t onto);

// `; it holds a, b`, for errors about names.
std::string ListOfNames(const std::vector<std::string>& names);

// Throws Error (kUsage) unless an atlas may be saved under the name: IsNameOfAtlas.
void CheckName(const std::string& path, const std::string& name);
// Throws Error (kUsage) for a name that somebody could mean a revision by. `has`: whether the store has an atlas.
template <class Has>
void CheckIsNoRevision(const std::string& path, const std::string& name, const Has& has) {
  if (has(name)) return;
  const std::string of = name.substr(0, name.rfind('@'));
  if (LooksLikeRevision(name) || (of != name && has(of)))
    throw Error(ErrorKind::kUsage, path, "",
                "'" + name + "' stands for a revision of '" + of +
                    "', which is not saved over: save it without the @, which makes the next one");
}

// The number of the revision that a save makes; `newest`: of the atlas, 0 where there is none. Throws Error (kUsage)
// where it is to have one that is taken, or was.
std::int64_t NextNumber(const std::string& path, const std::optional<Recorded>& recorded, std::int64_t newest);

// Which of an atlas' revisions GiveUp leaves.
struct KeptRevision {
  std::int64_t number = 0;
  std::string at;                  // saved
  bool is_needed = false;          // by a tag, a branch or a merge
  std::int64_t restored_from = 0;  // an earlier one of the same atlas; 0: it was not
};
// The numbers that stay, ascending, as `all` does.
std::vector<std::int64_t> KeptOf(const std::vector<KeptRevision>& all, const GiveUpOptions& options);

}  // namespace slamdb::rows
