// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/json.h"

#include "slamdb/formats/ndjson/detail/members.h"

namespace slamdb {
namespace {

// The end of the JSON string that begins at `begin`.
std::size_t EndOfString(std::string_view json, std::size_t begin) {
  std::size_t end = begin + 1;
  while (json[end] != '"') end += json[end] == '\\' ? 2 : 1;
  return end + 1;
}

// True when the array or object that begins at `begin` is to stay on one line: it has no other one inside, and is an
// array or empty.
bool StaysOnOneLine(std::string_view json, std::size_t begin) {
  for (std::size_t at = begin + 1; at < json.size();) {
    const char c = json[at];
    if (c == ']' || c == '}') return json[begin] == '[' || at == begin + 1;
    if (c == '[' || c == '{') return false;
    at = c == '"' ? EndOfString(json, at) : at + 1;
  }
  return true;
}

// Breaks JSON that stands on one line into lines. `json` is well-formed: we made it.
class Indenter {
 public:
  Indenter(std::string_view json, int indent) : json_(json), indent_(static_cast<std::size_t>(indent)) {}

  std::string Run() {
    while (at_ < json_.size()) Step();
    return std::move(out_);
  }

 private:
  void Step() {
    const char c = json_[at_];
    if (c == '"') return Copy(EndOfString(json_, at_));
    if ((c == '[' || c == '{') && StaysOnOneLine(json_, at_)) return CopyFlat();
    ++at_;
    if (c == ']' || c == '}') BreakLine(--depth_);
    out_ += c;
    if (c == '[' || c == '{') BreakLine(++depth_);
    if (c == ',') BreakLine(depth_);
    if (c == ':') out_ += ' ';
  }
  void Copy(std::size_t end) {
    out_ += json_.substr(at_, end - at_);
    at_ = end;
  }
  void CopyFlat() {
    while (true) {
      const char c = json_[at_];
      Copy(c == '"' ? EndOfString(json_, at_) : at_ + 1);
      if (c == ',') out_ += ' ';
      if (c == ']' || c == '}') return;
    }
  }
  void BreakLine(std::size_t depth) {
    out_ += '\n';
    out_.append(depth * indent_, ' ');
  }

  std::string_view json_;
  std::string out_;
  std::size_t indent_, at_ = 0, depth_ = 0;
};

template <class Entity>
std::string Render(const Entity& entity, int indent) {
  std::string json;
  AppendJson(json, entity);
  return indent < 0 ? json : Indenter(json, indent).Run();
}

}  // namespace

std::string ToJson(const KeyFrame& keyframe, int indent) { return Render(keyframe, indent); }
std::string ToJson(const MapPoint& point, int indent) { return Render(point, indent); }
std::string ToJson(const Camera& camera, int indent) { return Render(camera, indent); }
std::string ToJson(const Landmark& landmark, int indent) { return Render(landmark, indent); }
std::string ToJson(const Map& map, int indent) { return Render(map, indent); }
std::string ToJson(const Atlas& atlas, int indent) { return Render(atlas, indent); }

void AppendJson(std::string& out, const MapPoint& point, std::optional<MapId> map) {
  detail::JsonAppender json(out);
  json.BeginObject();
  json.Field("type", "map_point");
  if (map) json.Field("map", *map);
  fields::ForEachArchivedPointField(
      [&](std::string_view name, auto member) { detail::AppendMember(json, name, point.*member); });
  const MapPoint nothing;
  fields::ForEachTrackingField([&](std::string_view name, auto member) {
    if (point.*member != nothing.*member) json.Field(name, point.*member);  // left out: not recorded
  });
  detail::AppendMember(json, "carried", point.carried);
  json.EndObject();
}

void AppendJson(std::string& out, const Landmark& landmark, std::optional<MapId> map) {
  detail::JsonAppender json(out);
  json.BeginObject();
  json.Field("type", "landmark");
  if (map) json.Field("map", *map);
  ForEachField(&landmark,
               [&](std::string_view name, auto member) { detail::AppendMember(json, name, landmark.*member); });
  json.EndObject();
}

void AppendJson(std::string& out, const Camera& camera) {
  detail::JsonAppender json(out);
  json.BeginObject();
  json.Field("type", "camera");
  ForEachField(&camera, [&](std::string_view name, auto member) { detail::AppendMember(json, name, camera.*member); });
  json.EndObject();
}

void AppendJson(std::string& out, const Map& map) {
  detail::JsonAppender json(out);
  json.BeginObject();
  json.Field("type", "map");
  ForEachField(&map, [&](std::string_view name, auto member) {
    detail::AppendMember(json, name, map.*member);
    if (name != "big_change_index") return;
    json.Field("keyframe_count", map.keyframes.size());
    json.Field("point_count", map.points.size());
  });
  json.EndObject();
}

void AppendJson(std::string& out, const Atlas& atlas) {
  detail::JsonAppender json(out);
  json.BeginObject();
  json.Field("type", "atlas");
  {
    detail::DottedMembers members(json);
    const auto append = [&](std::string_view name, auto... path) { members.Append(name, Member(atlas, path...)); };
    fields::ForEachVocabularyField(append);
    members.Enter("maps");
    json.Array("maps", atlas.maps, [](const Map& map) { return map.id; });
    append("repeated_maps", &Atlas::repeated_maps);
    json.Array("cameras", atlas.cameras, [](const Camera& camera) { return camera.id; });
    append("repeated_cameras", &Atlas::repeated_cameras);
    fields::ForEachCounterField(append);
    fields::ForEachEncodingField(append);
    if (!atlas.layout.empty()) append("layout", &Atlas::layout);
    append("carried", &Atlas::carried);
  }
  json.EndObject();
}

}  // namespace slamdb
