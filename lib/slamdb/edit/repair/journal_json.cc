// SPDX-License-Identifier: BSD-3-Clause
// Journals as text. Every scalar keeps its bits: what no JSON number tells apart is written as text.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Json;

constexpr std::string_view kFormatName = "slamdb-journal-";
constexpr std::string_view kFormat = "slamdb-journal-1";
constexpr std::array<const char*, 6> kKinds = {"atlas", "camera", "map", "keyframe", "point", "landmark"};

Error NotAJournal(std::string_view why) {
  return Error(ErrorKind::kDamaged, Concat("is no journal of a repair: ", why));
}

// Numbers that are none are written as their bits, 0x7fc00001, which tells all NaNs apart.
template <class Real, class Bits>
Json RealValue(std::uint64_t bits) {
  const Real value = std::bit_cast<Real>(static_cast<Bits>(bits));
  if (std::isfinite(value)) return Json(static_cast<double>(value));
  return "0x" + detail::Hex(bits).substr(16 - 2 * sizeof(Bits));
}
template <class Real, class Bits>
std::uint64_t RealOf(const Json& value) {
  if (!value.is_string()) return std::bit_cast<Bits>(static_cast<Real>(value.get<double>()));
  const auto& text = value.get_ref<const std::string&>();
  Bits bits = 0;
  const bool is_hex = text.starts_with("0x");
  const auto [end, error] = std::from_chars(text.data() + (is_hex ? 2 : 0), text.data() + text.size(), bits, 16);
  if (!is_hex || error != std::errc() || end != text.data() + text.size())
    throw NotAJournal(Concat("'", text, "' is no number"));
  return bits;
}

Json ScalarValue(char kind, std::uint64_t bits) {
  switch (kind) {
    case 'r':
      return detail::JsonId(bits);
    case 'i':
      return static_cast<std::int32_t>(bits);
    case 'q':
      return static_cast<std::int64_t>(bits);
    case 'f':
      return RealValue<float, std::uint32_t>(bits);
    case 'd':
      return RealValue<double, std::uint64_t>(bits);
    default:
      return detail::JsonNumber(bits);
  }
}

std::uint64_t ScalarOf(char kind, const Json& value) {
  switch (kind) {
    case 'r':
      return value.is_null() ? KeyFrameId::kNone : detail::IntegerOf<std::uint64_t>(value);
    case 'i':
      return static_cast<std::uint32_t>(detail::IntegerOf<std::int32_t>(value));
    case 'q':
      return static_cast<std::uint64_t>(detail::IntegerOf<std::int64_t>(value));
    case 'f':
      return RealOf<float, std::uint32_t>(value);
    case 'd':
      return RealOf<double, std::uint64_t>(value);
    default:
      return detail::IntegerOf<std::uint64_t>(value);
  }
}

// Elements of several scalars are arrays of their own.
Json ValuesOf(const std::string& kinds, const std::vector<std::uint64_t>& bits) {
  Json values = Json::array();
  for (std::size_t i = 0; i < bits.size(); ++i) {
    const std::size_t place = i % kinds.size();
    Json value = ScalarValue(kinds[place], bits[i]);
    if (kinds.size() == 1) {
      values.push_back(std::move(value));
      continue;
    }
    if (place == 0) values.push_back(Json::array());
    values.back().push_back(std::move(value));
  }
  return values;
}

std::vector<std::uint64_t> BitsOf(const std::string& kinds, const Json& values) {
  std::vector<std::uint64_t> bits;
  for (const Json& value : values) {
    if (kinds.size() == 1) {
      bits.push_back(ScalarOf(kinds[0], value));
      continue;
    }
    if (value.size() != kinds.size()) throw NotAJournal(Concat("an element has not the scalars ", kinds));
    for (std::size_t i = 0; i < kinds.size(); ++i) bits.push_back(ScalarOf(kinds[i], value[i]));
  }
  return bits;
}

Json JsonOf(const EntityEdit& edit) {
  Json value = {{"rule", edit.rule}, {"entity", kKinds[static_cast<std::size_t>(edit.kind)]}};
  const bool in_map =
      edit.kind == EntityKind::kKeyFrame || edit.kind == EntityKind::kPoint || edit.kind == EntityKind::kLandmark;
  if (in_map) value["map"] = edit.map;
  if (edit.kind != EntityKind::kAtlas) {
    value["row"] = edit.row;
    value["id"] = ScalarValue('r', edit.id);
  }
  if (edit.removed) value["removed"] = true;
  if (edit.added) value["added"] = true;
  Json& fields = value["fields"] = Json::array();
  for (const FieldEdit& field : edit.fields) {
    if (field.kinds.empty()) throw Error(ErrorKind::kUsage, Concat("the edit of ", field.field, " has no kinds"));
    fields.push_back({{"field", field.field},
                      {"kinds", field.kinds},
                      {"at", field.at},
                      {"before", ValuesOf(field.kinds, field.before)},
                      {"after", ValuesOf(field.kinds, field.after)}});
  }
  return value;
}

EntityEdit EditOf(const Json& value) {
  EntityEdit edit;
  edit.rule = value.at("rule");
  const auto kind = std::ranges::find(kKinds, value.at("entity").get<std::string>());
  if (kind == kKinds.end()) throw NotAJournal(Concat("there are no entities called ", value.at("entity").dump()));
  edit.kind = static_cast<EntityKind>(kind - kKinds.begin());
  if (value.contains("map")) edit.map = detail::IntegerOf<decltype(edit.map)>(value.at("map"));
  if (value.contains("row")) edit.row = detail::IntegerOf<std::uint64_t>(value.at("row"));
  if (value.contains("id")) edit.id = ScalarOf('r', value.at("id"));
  edit.removed = value.value("removed", false);
  edit.added = value.value("added", false);
  for (const Json& field : value.at("fields")) {
    const std::string kinds = field.at("kinds");
    if (kinds.empty()) throw NotAJournal("a field has no kinds");
    edit.fields.push_back({field.at("field"), kinds, detail::IntegerOf<std::uint64_t>(field.at("at")),
                           BitsOf(kinds, field.at("before")), BitsOf(kinds, field.at("after"))});
  }
  return edit;
}

std::uint64_t HashFrom(const Json& value) {
  const std::string text = value;
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (error != std::errc() || end != text.data() + text.size())
    throw NotAJournal(Concat("'", text, "' is no content hash"));
  return hash;
}

void RequireFormat(const Json& json) {
  const std::string format = json.value("format", "");
  if (format == kFormat) return;
  if (format.starts_with(kFormatName))
    throw Error(ErrorKind::kUnsupported,
                Concat("is a journal of a newer version (", format, "), this one reads ", kFormat));
  throw NotAJournal(Concat("expected ", kFormat));
}

ArchiveEncoding EncodingOf(const Json& json) {
  const auto width = [&](const char* name) {
    const auto bytes = detail::IntegerOf<std::uint8_t>(json.at(name));
    if (bytes != 4 && bytes != 8) throw NotAJournal(Concat(name, " is ", bytes, ", expected 4 or 8"));
    return bytes;
  };
  ArchiveEncoding encoding;
  encoding.text = json.at("text");
  encoding.boost_version = detail::IntegerOf<std::uint16_t>(json.at("boost_version"));
  encoding.long_bytes = width("long_bytes");
  encoding.size_bytes = width("size_bytes");
  return encoding;
}

// The last member is a checksum of the text in front of it. Journals of before have none.
constexpr std::string_view kChecksum = ",\"checksum\":\"";

void RequireUnchanged(std::string_view json) {
  const std::size_t at = json.rfind(kChecksum);
  if (at == std::string_view::npos) return;
  const std::string sum = detail::Hex(detail::HashBytes(std::as_bytes(std::span(json.substr(0, at)))));
  if (!json.substr(at + kChecksum.size()).starts_with(sum))
    throw Error(ErrorKind::kDamaged,
                "is damaged, or was changed since it was written: its checksum is that of another text");
}

Journal JournalOf(const Json& json) {
  RequireFormat(json);
  Journal journal{.original = HashFrom(json.at("original")), .repaired = HashFrom(json.at("repaired"))};
  journal.encoding = EncodingOf(json.at("encoding"));
  for (const Json& edit : json.at("edits")) journal.edits.push_back(EditOf(edit));
  return journal;
}

}  // namespace

std::string ToJson(const Journal& journal) {
  const Json head = {{"format", kFormat},
                     {"original", detail::Hex(journal.original)},
                     {"repaired", detail::Hex(journal.repaired)},
                     {"encoding", detail::JsonOf(journal.encoding)}};
  std::string text = detail::Dumped(head);
  text.pop_back();
  text += ",\"edits\":[";
  const char* separator = "\n";
  for (const EntityEdit& edit : journal.edits) text += std::exchange(separator, ",\n") + detail::Dumped(JsonOf(edit));
  text += "\n]";
  const std::string sum = detail::Hex(detail::HashBytes(std::as_bytes(std::span(text))));
  return Concat(text, kChecksum, sum, "\"}\n");
}

Journal ParseJournal(std::string_view json) {
  RequireUnchanged(json);
  try {
    return JournalOf(Json::parse(json));
  } catch (const Json::exception& error) {
    throw NotAJournal(error.what());
  }
}

void WriteJournal(const Journal& journal, const std::string& path, const AtomicFileOptions& options) {
  AtomicFile file(path, options);
  file.Write(ToJson(journal));
  file.Commit();
}

Journal ReadJournal(const std::string& path) { return detail::ParseFile(path, "a journal", ParseJournal, {"journal"}); }

}  // namespace slamdb
