// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/revision_names.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/rows/stored.h"

namespace slamdb {

bool IsNameOfAtlas(std::string_view name) {
  return detail::ProblemOfName(name).empty() && name.find_first_of("#/") == std::string_view::npos;
}

bool IsNameOfTag(const std::string& name) {
  return IsNameOfAtlas(name) && name.find_first_of("@{}") == std::string::npos && !rows::LooksLikeRevision("@" + name);
}

}  // namespace slamdb

namespace slamdb::rows {
namespace {

using detail::Concat;

std::optional<std::int64_t> NumberOf(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return number;
}

bool IsDate(std::string_view which) { return which.size() > 2 && which.front() == '{' && which.back() == '}'; }

// The last moment of what is in braces: of a day, a minute or a second. Nothing when it is no time.
std::optional<std::string> EndOf(std::string_view which) {
  std::string time(which.substr(1, which.size() - 2));
  if (time.ends_with('Z')) time.pop_back();
  if (time.size() > 10 && time[10] == ' ') time[10] = 'T';
  constexpr std::string_view kLast = "9999-12-31T23:59:59";
  if (time.size() != 10 && time.size() != 16 && time.size() != kLast.size()) return std::nullopt;
  time += std::string(kLast.substr(time.size())) + "Z";
  if (!detail::ParseDateTime(time, {})) return std::nullopt;
  return time;
}

std::string DaysAgo(double days) {
  const auto now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return detail::DateTimeText(std::max(0.0, std::floor(now - days * 86400))).value_or("");
}

// Behind one that stays, those that were restored tell what the next ones were made of: without them that would be the
// one before the gap. They stay, and what they were restored from.
void KeepRestored(const std::vector<KeptRevision>& all, std::vector<std::uint8_t>& stays) {
  for (bool grows = true; grows;) {
    grows = false;
    const auto keep = [&](std::size_t i) { grows |= std::exchange(stays[i], 1) == 0; };
    const auto first = static_cast<std::size_t>(std::ranges::find(stays, 1) - stays.begin());
    for (std::size_t i = first + 1; i < all.size(); ++i) {
      if (all[i].restored_from == 0) continue;
      keep(i);
      const auto source = std::ranges::lower_bound(all, all[i].restored_from, {}, &KeptRevision::number);
      if (source != all.end() && source->number == all[i].restored_from)
        keep(static_cast<std::size_t>(source - all.begin()));
    }
  }
}

}  // namespace

std::optional<SplitName> SplitAtRevision(std::string_view text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string_view::npos) return std::nullopt;
  return SplitName{text.substr(0, at), text.substr(at + 1)};
}

bool LooksLikeRevision(std::string_view name) {
  const std::optional<SplitName> split = SplitAtRevision(name);
  return split && (IsDate(split->which) || NumberOf(split->which));
}

Which ParseWhich(std::string_view which, std::int64_t newest, const std::string& path) {
  if (IsDate(which)) {
    std::optional<std::string> end = EndOf(which);
    if (!end)
      throw Error(
          ErrorKind::kUsage, path, "",
          Concat("'", which, "' is no date: expected {2026-11-20}, {2026-11-20T08:30} or {2026-11-20T08:30:15}, UTC"));
    return {.kind = Which::Kind::kBy, .by = std::move(*end)};
  }
  if (const std::optional<std::int64_t> number = NumberOf(which))
    return {.kind = Which::Kind::kNumber, .number = *number < 0 ? newest + *number : *number};
  return {};
}

std::string Ranges(const std::vector<std::int64_t>& numbers) {
  std::string text;
  for (std::size_t first = 0; first < numbers.size();) {
    std::size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += Concat(text.empty() ? "" : ", ", numbers[first]);
    if (last > first) text += Concat(last == first + 1 ? ", " : " to ", numbers[last]);
    first = last + 1;
  }
  return text;
}

Error NoSuchRevision(const std::string& path, const Named& of, std::string_view which,
                     const std::vector<std::int64_t>& numbers, const std::vector<std::string>& tags,
                     std::string_view why) {
  std::string known = "; it has " + Ranges(numbers);
  for (const std::string& tag : tags) known += (&tag == tags.data() ? ", tagged " : ", ") + tag;
  return Error(ErrorKind::kNotFound, path, "", Concat("no revision '", which, "' of '", of.name, "'", why, known));
}

std::string ListOfNames(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "; it holds " : ", ") + name;
  return list.empty() ? "; the store is empty" : list;
}

Error NoSuchAtlas(const std::string& path, std::string_view name, const std::vector<std::string>& names) {
  return Error(ErrorKind::kNotFound, path, "", Concat("no atlas named '", name, "'", ListOfNames(names)));
}

Error NoSuchTag(const std::string& path, const std::string& atlas, const std::string& tag,
                const std::vector<std::string>& tags) {
  std::string known;
  for (const std::string& each : tags) known += (known.empty() ? "; it has " : ", ") + each;
  return Error(ErrorKind::kNotFound, path, "", Concat("no tag '", tag, "' of '", atlas, "'", known));
}

Error TagIsTaken(const std::string& path, const std::string& atlas, const std::string& tag, std::int64_t revision) {
  return Error(
      ErrorKind::kAlreadyExists, path, "",
      Concat("revision ", revision, " of '", atlas, "' has the tag '", tag, "' already: remove it there first"));
}

Error AtlasIsThere(const std::string& path, const std::string& name) {
  return Error(ErrorKind::kAlreadyExists, path, "",
               Concat("holds an atlas named '", name, "' already; WriteOptions::overwrite replaces it"));
}

void CheckIsNewest(const std::string& path, const std::string& name, std::int64_t newest, std::uint64_t onto) {
  if (static_cast<std::uint64_t>(newest) == onto) return;
  throw Error(ErrorKind::kLocked, path, "",
              Concat("'", name, "' has revision ", newest, " by now, and this was made of ", onto,
                     ": nothing was saved; try again"));
}

void CheckName(const std::string& path, const std::string& name) {
  if (IsNameOfAtlas(name)) return;
  std::string_view problem = detail::ProblemOfName(name);
  if (problem.empty()) problem = "holds `#` or `/`";
  throw Error(ErrorKind::kUsage, path, "",
              Concat("the name of an atlas is 1 to 255 bytes of UTF-8 without `#`, `/`, control characters and others "
                     "that cannot be seen: '",
                     name, "' ", problem));
}

std::int64_t NextNumber(const std::string& path, const std::optional<Recorded>& recorded, std::int64_t newest) {
  if (!recorded) return newest + 1;
  const auto number = static_cast<std::int64_t>(recorded->number);
  if (number <= newest || number > 0x7ffffffe)
    throw Error(ErrorKind::kUsage, path, "",
                detail::Concat("a revision cannot be number ", recorded->number, " behind number ", newest));
  return number;
}

std::vector<std::int64_t> KeptOf(const std::vector<KeptRevision>& all, const GiveUpOptions& options) {
  const std::string since = options.keep_days ? DaysAgo(*options.keep_days) : std::string("9999");
  const std::uint64_t last = std::min<std::uint64_t>(std::max<std::uint64_t>(options.keep.value_or(1), 1), all.size());
  std::vector<std::uint8_t> stays(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    stays[i] = i + last >= all.size() || all[i].at >= since || all[i].is_needed;
  KeepRestored(all, stays);
  std::vector<std::int64_t> kept;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (stays[i]) kept.push_back(all[i].number);
  return kept;
}

}  // namespace slamdb::rows
