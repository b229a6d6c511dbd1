// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/list.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "cli/batch.h"
#include "cli/byte_size.h"
#include "cli/commands/commands.h"
#include "cli/many.h"
#include "cli/options.h"
#include "cli/ranges.h"
#include "cli/report/layout.h"
#include "cli/report/list_text.h"
#include "cli/terminal.h"
#include "cli/words.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/layout_text.h"

namespace slamdb::cli {
namespace {

using detail::ParseNumber;

struct ListVerbOptions {
  ManyOptions many;
  std::string time, near, keyframes;
  AtlasQuery stored;
  std::vector<std::string> sort, columns;
  bool check = false, json = false;
  double wait = kUsualWait;
};

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

std::string CheckBall(const std::string& text) {
  return ParseBall(text) ? std::string() : "expected a place and perhaps a radius as X,Y,Z,R, found '" + text + "'";
}

std::string KnownWords() {
  std::string known;
  for (const ListKey key : ListKeys()) known.append(known.empty() ? "" : ", ").append(NameOf(key));
  return known;
}

std::string CheckWord(const std::string& word) {
  try {
    (void)SortKeyOf(word);
    return {};
  } catch (const Error& error) {
    return error.problem();
  }
}

MapQuery::Times TimesOf(const std::string& range) {
  const auto [begin, end] = ParseTimeRange(range).value().In({});
  return {begin, end};
}

MapQuery QueryOf(const ListVerbOptions& options) {
  MapQuery query;
  if (!options.time.empty()) query.times = TimesOf(options.time);
  if (!options.keyframes.empty()) query.keyframes = ParseIdRange(options.keyframes);
  if (!options.near.empty()) query.near = ParseBall(options.near);
  return query;
}

std::vector<SortKey> SortKeysOf(const std::vector<std::string>& words) {
  std::vector<SortKey> keys;
  for (const std::string& word : words) keys.push_back(SortKeyOf(word));
  return keys;
}

std::string TextOf(const std::vector<ListedAtlas>& atlases, const ListVerbOptions& options) {
  if (atlases.empty() && !options.stored.everything()) return "no atlas is like that\n";
  if (atlases.empty()) return QueryOf(options).everything() ? "no atlases\n" : "no atlas covers that\n";
  std::vector<ListKey> columns;
  for (const std::string& word : options.columns) columns.push_back(SortKeyOf(word).key);
  return columns.empty() ? ListText(atlases, UsualColumns(atlases), TerminalColumns(STDOUT_FILENO))
                         : ListText(atlases, columns);
}

ExitCode RunList(const ListVerbOptions& options, Console& console) {
  ManyOptions many = options.many;
  if (many.inputs.paths.empty()) many.inputs.paths.emplace_back(".");
  const AtlasInputs inputs = FindInputs(many, console, options.wait);
  ListOptions list{.query = QueryOf(options), .stored = options.stored, .lock_timeout = options.wait};
  list.format = many.inputs.from.format;
  list.layout = LayoutNamed(many.inputs.from.layout);
  if (options.check) list.check.emplace();
  list.threads = console.threads();
  list.progress = console.MakeProgress();
  std::vector<ListedAtlas> atlases = ListAtlases(inputs, list);
  const bool one = atlases.size() == 1;
  SortAtlases(atlases, SortKeysOf(options.sort));
  if (options.json)
    WriteJson(atlases, many.inputs.paths.size() == 1 ? many.inputs.paths[0] : "",
              [&](std::string_view piece) { console.PrintData(ReportInCommandWords(piece)); });
  else if (!one || atlases[0].failure.empty())
    console.Print(TextOf(atlases, options));
  const auto unreadable = static_cast<std::uint64_t>(
      std::ranges::count_if(atlases, [](const ListedAtlas& atlas) { return !atlas.failure.empty(); }));
  if (one && unreadable > 0)
    console.Fail(InCommandWords(atlases[0].failure));
  else
    FailUnreadable(unreadable, atlases.size(), console);
  return std::ranges::all_of(atlases, &ListedAtlas::ok) ? ExitCode::kDone : ExitCode::kFailed;
}

void BindQuery(CLI::App& verb, ListVerbOptions& options) {
  constexpr const char* kGroup = "What covers a place or a time; several at once must be met by one map";
  AddClockRange(verb, options.time, "Maps that were made at this time, or in part in this span")->group(kGroup);
  verb.add_option("--near", options.near,
                  "Maps with a point, or a landmark, at most R from this place in their world; R is 1 if left out")
      ->type_name("X,Y,Z[,R]")
      ->check(CheckBall)
      ->group(kGroup);
  AddIdRange(verb, options.keyframes, "Maps that have a keyframe of these ids")->group(kGroup);
}

std::string NumberWords() {
  std::string words;
  for (const ListKey key : ListKeys())
    if (NumberOf(key)) words.append(words.empty() ? "" : ", ").append(NameOf(key));
  return words;
}

// `keyframes=100:`, `size=:20MB`.
std::optional<AtlasQuery::Range> ParseWhere(std::string_view text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const auto key = std::ranges::find(ListKeys(), text.substr(0, equals), NameOf);
  const auto number = key == ListKeys().end() ? std::nullopt : NumberOf(*key);
  if (equals == text.size() || !number) return std::nullopt;
  const auto range = ParseNumberRange(text.substr(equals + 1), [&](std::string_view end) -> std::optional<double> {
    if (number != AtlasQuery::Number::kBytes) return ParseNumber<double>(end);
    const auto bytes = ParseByteSize(end);
    return bytes ? std::optional(static_cast<double>(*bytes)) : std::nullopt;
  });
  if (!range) return std::nullopt;
  return AtlasQuery::Range{*number, range->low, range->high};
}

std::string CheckWhere(const std::string& text) {
  if (ParseWhere(text)) return {};
  return "expected one of " + NumberWords() + " and a number or a range, as keyframes=100: or length=:20.5, found '" +
         text + "'";
}

void BindStoredQuery(CLI::App& verb, AtlasQuery& query) {
  constexpr const char* kGroup = "What a store tells of atlases, of which none is read";
  verb.add_option_function<std::vector<std::string>>(
          "--where",
          [&query](const std::vector<std::string>& wheres) {
            for (const std::string& where : wheres) query.ranges.push_back(ParseWhere(where).value());
          },
          "Where these are so many: " + NumberWords() + "; both ends included, one may be left out; of files too")
      ->type_name("NUMBER=LOW:HIGH,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CheckWhere)
      ->group(kGroup);
  verb.add_option("--who", query.who,
                  "With a revision that this robot, or person, saved: a user, a host or USER@HOST; * and ? stand for "
                  "other letters here and in the next two")
      ->type_name("NAME")
      ->group(kGroup);
  verb.add_option("--provenance", query.provenance, "With a revision that was made of this, as `slamdb log` tells it")
      ->type_name("TEXT")
      ->group(kGroup);
  verb.add_option("--tag", query.tag, "With a revision of this tag; one revision must meet all three")
      ->type_name("TAG")
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
  verb.add_option("--columns", options->columns, "Show these columns: any of " + KnownWords())
      ->type_name("COLUMN,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CheckWord);
  BindQuery(verb, *options);
  BindStoredQuery(verb, options->stored);
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

LENGTH is that of the trajectory, in metres, or in units of maps without scale, `mixed` where an atlas has both; SPAN the time between the first and the
last keyframe of each map, summed, DATE the first's, where times count from 1970. SIZE is that of the file, or about what
an atlas takes in its store. Atlases of a store are named STORE.db#NAME on the command line.)",
    .failed = "An input could not be read, or --check found errors.",
    .examples = kExamples,
    .add = AddList,
};

}  // namespace slamdb::cli
