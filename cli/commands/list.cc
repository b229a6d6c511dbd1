// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/many.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/report/list_text.h"
#include "cli/words.h"
#include "slamdb/base/detail/date_times.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::cli {
namespace {

using detail::ParseNumber;

struct ListVerbOptions {
  ManyOptions many;
  std::string time, near, keyframes;
  std::vector<std::string> sort, columns;
  bool check = false, json = false;
  double wait = kUsualWait;
};

// Seconds, a date with a time of day, or a day, which is all of its seconds: `2026-01-31T12:00:00Z`, `2026-01-31`.
std::optional<MapQuery::Times> ParseMoment(const std::string& text) {
  constexpr double kDay = 86400, kJustBefore = 1e-6;
  if (const auto seconds = ParseNumber<double>(text)) return MapQuery::Times{*seconds, *seconds};
  const auto moment = [](const std::string& date) {
    const auto parsed = detail::ParseDateTime(date, {});
    return parsed ? ParseNumber<double>(parsed->seconds) : std::nullopt;
  };
  if (const auto seconds = moment(text)) return MapQuery::Times{*seconds, *seconds};
  const auto midnight = moment(text + "T00:00:00Z");
  return midnight ? std::optional(MapQuery::Times{*midnight, *midnight + kDay - kJustBefore}) : std::nullopt;
}

// `T`, `A:B`, `A:` or `:B`. Times of day have colons too: the one that leaves a moment on both sides is meant.
std::optional<MapQuery::Times> ParseTimes(const std::string& text) {
  constexpr double kForEver = std::numeric_limits<double>::infinity();
  const auto open = [&](const std::string& end) {
    return end.empty() ? std::optional(MapQuery::Times{-kForEver, kForEver}) : ParseMoment(end);
  };
  if (auto moment = ParseMoment(text)) return moment;
  for (std::size_t colon = text.find(':'); colon != std::string::npos; colon = text.find(':', colon + 1)) {
    const auto from = open(text.substr(0, colon)), to = open(text.substr(colon + 1));
    if (text != ":" && from && to && from->begin <= to->end) return MapQuery::Times{from->begin, to->end};
  }
  return std::nullopt;
}

// `N`, `N..M`, `N..`, `..M`, and with one colon as other verbs have it.
std::optional<MapQuery::Ids> ParseIds(const std::string& text) {
  MapQuery::Ids ids{0, std::numeric_limits<std::uint64_t>::max()};
  if (const auto one = ParseNumber<std::uint64_t>(text)) return MapQuery::Ids{*one, *one};
  const std::string separator = text.find("..") != std::string::npos ? ".." : ":";
  const std::size_t at = text.find(separator);
  if (at == std::string::npos || text == separator) return std::nullopt;
  const std::string first = text.substr(0, at), last = text.substr(at + separator.size());
  const auto from = first.empty() ? ids.first : ParseNumber<std::uint64_t>(first);
  const auto to = last.empty() ? ids.last : ParseNumber<std::uint64_t>(last);
  if (!from || !to || *from > *to) return std::nullopt;
  return MapQuery::Ids{*from, *to};
}

// `X,Y,Z` or `X,Y,Z,R`.
std::optional<MapQuery::Ball> ParseBall(const std::string& text) {
  constexpr double kUsualRadius = 1;
  std::vector<double> numbers;
  for (const std::string_view part : detail::Split(text, ',')) {
    const auto number = ParseNumber<double>(part);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
  }
  if (numbers.size() == 3) numbers.push_back(kUsualRadius);
  if (numbers.size() != 4 || numbers[3] < 0) return std::nullopt;
  return MapQuery::Ball{{numbers[0], numbers[1], numbers[2]}, numbers[3]};
}

std::string CheckTimes(const std::string& text) {
  if (ParseTimes(text)) return {};
  return "expected a time, or two as BEGIN:END, in seconds or as dates (2026-01-31, 2026-01-31T12:00:00Z), found '" +
         text + "'";
}

std::string CheckIds(const std::string& text) {
  return ParseIds(text) ? std::string() : "expected keyframe ids as N, N..M or N.., found '" + text + "'";
}

std::string CheckBall(const std::string& text) {
  return ParseBall(text) ? std::string() : "expected a place and perhaps a radius as X,Y,Z,R, found '" + text + "'";
}

std::string WithoutSign(const std::string& word) { return word.starts_with('-') ? word.substr(1) : word; }

std::string CheckWord(const std::string& word) {
  const std::vector<std::string> words = ListKeyWords();
  if (std::ranges::count(words, WithoutSign(word)) > 0) return {};
  std::string known;
  for (const std::string& one : words) known += (known.empty() ? "" : ", ") + one;
  return "'" + word + "' is none of " + known;
}

MapQuery QueryOf(const ListVerbOptions& options) {
  MapQuery query;
  if (!options.time.empty()) query.times = ParseTimes(options.time);
  if (!options.keyframes.empty()) query.keyframes = ParseIds(options.keyframes);
  if (!options.near.empty()) query.near = ParseBall(options.near);
  return query;
}

std::vector<SortKey> SortKeysOf(const std::vector<std::string>& words) {
  std::vector<SortKey> keys;
  for (const std::string& word : words) keys.push_back({ListKeyOf(WithoutSign(word)), word.starts_with('-')});
  return keys;
}

std::string TextOf(const std::vector<ListedAtlas>& atlases, const ListVerbOptions& options) {
  if (atlases.empty()) return QueryOf(options).everything() ? "no atlases\n" : "no atlas covers that\n";
  std::vector<ListKey> columns;
  for (const std::string& word : options.columns) columns.push_back(ListKeyOf(WithoutSign(word)));
  return ListText(atlases, columns.empty() ? UsualColumns(atlases) : columns);
}

ExitCode RunList(const ListVerbOptions& options, Console& console) {
  ManyOptions many = options.many;
  if (many.inputs.paths.empty()) many.inputs.paths.emplace_back(".");
  const AtlasInputs inputs = FindInputs(many, console, options.wait);
  ListOptions list{.query = QueryOf(options), .format = many.inputs.from, .lock_timeout = options.wait};
  if (options.check) list.check.emplace();
  list.threads = console.threads();
  list.progress = console.MakeProgress();
  std::vector<ListedAtlas> atlases = ListAtlases(inputs, list);
  SortAtlases(atlases, SortKeysOf(options.sort));
  if (options.json)
    console.PrintData(InCommandWords(ToJson(atlases, many.inputs.paths.size() == 1 ? many.inputs.paths[0] : "")));
  else if (atlases.size() != 1 || atlases[0].failure.empty())
    console.Print(TextOf(atlases, options));
  const auto unreadable = static_cast<std::uint64_t>(
      std::ranges::count_if(atlases, [](const ListedAtlas& atlas) { return !atlas.failure.empty(); }));
  if (unreadable > 0 && atlases.size() == 1) console.Fail(InCommandWords(atlases[0].failure));
  if (unreadable > 0 && atlases.size() > 1)
    console.Fail(Grouped(unreadable) + " of " + Grouped(atlases.size()) + " could not be read");
  return std::ranges::all_of(atlases, &ListedAtlas::ok) ? ExitCode::kDone : ExitCode::kFailed;
}

void BindQuery(CLI::App& verb, ListVerbOptions& options) {
  constexpr const char* kGroup = "What covers a place or a time; several at once must be met by one map";
  verb.add_option("--time", options.time,
                  "Maps that were made at this time, or in this span: seconds, or dates (2026-01-31, "
                  "2026-01-31T12:00:00Z)")
      ->type_name("T[:T]")
      ->check(CheckTimes)
      ->group(kGroup);
  verb.add_option("--near", options.near,
                  "Maps with a point, or a landmark, at most R from this place in their world; R is 1 if left out")
      ->type_name("X,Y,Z[,R]")
      ->check(CheckBall)
      ->group(kGroup);
  verb.add_option("--keyframes", options.keyframes, "Maps that have a keyframe of these ids")
      ->type_name("N[..M]")
      ->check(CheckIds)
      ->group(kGroup);
}

Run AddList(CLI::App& verb) {
  const auto options = std::make_shared<ListVerbOptions>();
  AddMany(verb, options->many)->required(false);
  verb.add_flag("--check", options->check,
                "Hold them against the rules of `slamdb check`, for a column with the verdict");
  verb.add_option("--sort", options->sort, "Sort by these columns, by the first of them first; - before one: downwards")
      ->type_name("[-]COLUMN,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CheckWord);
  verb.add_option("--columns", options->columns,
                  "Show these columns: any of name, input, maps, sensor, keyframes, "
                  "points, observations, landmarks, length, span, date, size, format, "
                  "revision, saved, verdict")
      ->type_name("COLUMN,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CheckWord);
  BindQuery(verb, *options);
  AddWait(verb, options->wait);
  AddJson(verb, options->json);
  return [options](Console& console) { return RunList(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb list maps", "What is in a folder; several folders, files and stores may be named."},
    {"slamdb list lab.db --sort -points", "What is in a store, the largest first."},
    {"slamdb list maps lab.db --check --columns input,size,verdict", "What is sound."},
    {"slamdb list lab.db --near 0,0,2,0.5", "Which maps cover a place."},
    {"slamdb list lab.db --json | jq -r '.atlases[].name'", "The names, for a script."},
};

}  // namespace

const Command kList = {
    .name = "list",
    .summary = "list many atlases: of folders, files and stores",
    .group = Group::kLook,
    .description =
        R"(Shows in a line each what is in the atlases of folders, files and stores; without a name, of this folder. Of a folder these
are its files with the suffix of atlases (.osa, .db, .mrpt, ...), in natural order. What cannot be read is a line like
others, with the reason.

LENGTH is that of the trajectory, in metres, or in units of maps without scale; SPAN the time between the first and the
last keyframe of each map, summed, DATE the first's, where times count from 1970. SIZE is that of the file, or about what
an atlas takes in its store. Atlases of a store are named STORE.db#NAME on the command line.)",
    .failed = "An input could not be read, or --check found errors.",
    .examples = kExamples,
    .add = AddList,
};

}  // namespace slamdb::cli
