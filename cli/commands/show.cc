// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "cli/report/entity_text.h"
#include "cli/report/layout.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/ndjson/json.h"

namespace slamdb::cli {
namespace {

using nlohmann::ordered_json;

struct ShowOptions {
  std::string input;
  InputFormat from;
  std::vector<std::string> entities;
  bool json = false, all = false;
};

// What `kf/77` names.
struct Name {
  std::string kind;  // atlas, camera, map, kf, mp, landmark
  std::uint64_t id = 0;
};

std::optional<Name> ParseName(const std::string& text) {
  if (text == "atlas") return Name{.kind = text};
  const auto parts = detail::Split(text, '/');
  const auto id = detail::ParseNumber<std::uint64_t>(parts.back());
  bool known = false;
  for (const char* kind : {"camera", "map", "kf", "mp", "landmark"}) known = known || parts.front() == kind;
  if (!known || parts.size() != 2 || !id) return std::nullopt;
  return Name{.kind = std::string(parts.front()), .id = *id};
}

std::string CheckName(const std::string& text) {
  if (ParseName(text)) return {};
  return "expected atlas, camera/ID, map/ID, kf/ID, mp/ID or landmark/ID, found '" + text + "'";
}

// An entity as JSON, and what its fields say together, for people.
struct Found {
  std::string json, summary;
};

template <class List, class Summary>
void CollectFrom(const List& list, std::uint64_t id, std::vector<Found>& found, const Summary& summary) {
  for (const auto& entity : list)
    if (entity.id.value() == id) found.push_back({ToJson(entity), summary(entity)});
}

// Everything in the atlas that has the name: more than one when ids are not unique, as in damaged files.
std::vector<Found> FindAll(const Atlas& atlas, const Name& name) {
  std::vector<Found> found;
  const auto nothing = [](const auto&) { return std::string(); };
  if (name.kind == "atlas") found.push_back({ToJson(atlas), {}});
  if (name.kind == "camera") CollectFrom(atlas.cameras, name.id, found, nothing);
  if (name.kind == "map") CollectFrom(atlas.maps, name.id, found, nothing);
  for (const Map& map : atlas.maps) {
    if (name.kind == "kf")
      CollectFrom(map.keyframes, name.id, found, [&](const KeyFrame& keyframe) { return WhereIs(keyframe, map); });
    if (name.kind == "mp") CollectFrom(map.points, name.id, found, nothing);
    if (name.kind == "landmark") CollectFrom(map.landmarks, name.id, found, nothing);
  }
  return found;
}

// ---- text for people: one line for each field, members of an object indented under its name

constexpr std::size_t kShownValues = 12;  // of a long list, unless --all

bool IsPlainList(const ordered_json& value) {
  for (const ordered_json& element : value)
    if (element.is_structured()) return false;
  return true;
}

std::string PlainText(const ordered_json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

std::string ListText(const ordered_json& list, bool all) {
  const std::size_t shown = all ? list.size() : std::min(list.size(), kShownValues);
  std::string text;
  for (std::size_t i = 0; i < shown; ++i)
    text += (i == 0 ? "" : " ") + (list[i].is_structured() ? list[i].dump() : PlainText(list[i]));
  if (shown < list.size()) text += " ... " + Counted(list.size(), "value") + " in all";
  return list.empty() ? "(empty)" : text;
}

void AppendField(std::string& out, const std::string& name, const ordered_json& value, std::size_t indent, bool all);

void AppendFields(std::string& out, const ordered_json& object, std::size_t indent, bool all) {
  for (const auto& [name, value] : object.items()) AppendField(out, name, value, indent, all);
}

void AppendField(std::string& out, const std::string& name, const ordered_json& value, std::size_t indent, bool all) {
  const std::string margin(indent, ' ');
  if (value.is_object()) {
    out += margin + name + "\n";
    AppendFields(out, value, indent + 2, all);
  } else if (value.is_array() && !IsPlainList(value)) {
    out += margin + name + "  (" + Counted(value.size(), "entry", "entries") + ")\n";
    const std::size_t shown = all ? value.size() : std::min(value.size(), kShownValues);
    for (std::size_t i = 0; i < shown; ++i)
      out += margin + "  " + (value[i].is_array() ? ListText(value[i], true) : value[i].dump()) + "\n";
    if (shown < value.size()) out += margin + "  ...\n";
  } else {
    const std::size_t column = std::max(kNameColumns, indent + name.size() + 2);
    std::string text =
        value.is_array() ? Wrapped(ListText(value, all), column) : std::string(column, ' ') + PlainText(value) + "\n";
    text.replace(0, indent + name.size(), margin + name);
    out += text;
  }
}

std::string EntityText(const Found& found, bool all) {
  ordered_json entity = ordered_json::parse(found.json);
  const std::string folded = all ? std::string() : Fold(entity);
  std::string text = found.summary;
  AppendFields(text, entity, 0, all);
  return text + folded;
}

// One keyframe alone, but for people, who are told how the map stands that it is in (WhereIs).
ReadOptions ReadOptionsFor(const std::vector<Name>& names, const ShowOptions& options, Console& console) {
  ReadOptions read = MakeReadOptions(console, options.from);
  if (names.size() != 1 || names.front().kind != "kf" || !options.json) return read;
  read.selection.first_keyframe = read.selection.last_keyframe = names.front().id;
  return read;
}

ExitCode RunShow(const ShowOptions& options, Console& console) {
  std::vector<Name> names;
  for (const std::string& entity : options.entities) names.push_back(*ParseName(entity));
  Notices notices;
  const Atlas atlas = ReadAtlas(options.input, ReadOptionsFor(names, options, console), &notices);
  console.Report(notices);
  ExitCode code = ExitCode::kDone;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::vector<Found> found = FindAll(atlas, names[i]);
    if (found.empty()) {
      console.Fail(options.input + ": has no " + options.entities[i]);
      code = ExitCode::kFailed;
    }
    for (const Found& entity : found) {
      if (!options.json && (names.size() > 1 || found.size() > 1)) console.Print(options.entities[i] + "\n");
      if (options.json)
        console.PrintData(entity.json + "\n");
      else
        console.Print(EntityText(entity, options.all));
    }
  }
  return code;
}

Run AddShow(CLI::App& verb) {
  const auto options = std::make_shared<ShowOptions>();
  verb.add_option("FILE", options->input, AtlasAt("The atlas"))->type_name("FILE")->required();
  verb.add_option(
          "ENTITY", options->entities,
          "What to show: atlas, camera/ID, map/ID, kf/ID (a keyframe), mp/ID (a map point) or landmark/ID (of MRPT)")
      ->required()
      ->check(CheckName);
  AddFrom(verb, options->from);
  verb.add_flag("--all", options->all, "Show long lists whole, and fields that do not apply");
  AddJson(verb, options->json);
  return [options](Console& console) { return RunShow(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb show lab.osa kf/77", "A keyframe with all its fields."},
    {"slamdb show lab.osa mp/4312 --json | jq .observations", "Who sees a map point."},
    {"slamdb show lab.db#a camera/0 map/1", "A camera and a map of an atlas in a store."},
};

}  // namespace

const Command kShow = {
    .name = "show",
    .summary = "show a keyframe, point, landmark, map or camera with all its fields",
    .group = Group::kLook,
    .description =
        R"(Shows single entities with every field that the file holds, by the names of schema/ndjson.md. The text for people begins
with where the camera is, shortens long lists and folds what does not apply (the IMU of a map without one, a second camera
that is not there, empty lists); --all and --json do not. Where several entities have the id, as in damaged files, all of them are shown.)",
    .failed = "The file could not be read, or it has no such entity.",
    .examples = kExamples,
    .add = AddShow,
};

}  // namespace slamdb::cli
