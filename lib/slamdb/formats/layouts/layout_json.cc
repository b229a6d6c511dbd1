// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/layout_json.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>

#include "slamdb/formats/layouts/detail/member_forms.h"

namespace slamdb {
namespace detail {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20, kMostClasses = 128, kMostMembers = 1024, kLongestName = 128;
constexpr std::uint64_t kHeaderBytes = 40;

// Looks at one value of the JSON; what is wrong is an error with its place.
class Reader {
 public:
  Reader(const Json& value, const std::string& path, std::string place)
      : value_(value), path_(path), place_(std::move(place)) {}

  [[noreturn]] void Fail(const std::string& problem) const { throw Error(ErrorKind::kDamaged, path_, place_, problem); }
  Reader At(const std::string& key) const {
    return {value_.at(key), path_, place_.empty() ? key : Concat(place_, ".", key)};
  }
  Reader At(std::size_t i) const { return {value_.at(i), path_, Concat(place_, "[", i, "]")}; }
  const Json& value() const { return value_; }
  const std::string& path() const { return path_; }
  bool Has(const char* key) const { return value_.contains(key); }

  void ExpectObject(std::initializer_list<std::string_view> keys) const {
    if (!value_.is_object()) Fail("expected an object");
    for (const auto& [key, value] : value_.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) Fail(Concat("no member is called '", key, "'"));
  }
  std::size_t ArraySize(std::size_t most) const {
    if (!value_.is_array()) Fail("expected an array");
    if (value_.size() > most) Fail(Concat(value_.size(), " elements, at most ", most));
    return value_.size();
  }
  std::string Text(std::size_t longest = kLongestName) const {
    if (!value_.is_string()) Fail("expected a text");
    const auto& text = value_.get_ref<const std::string&>();
    if (text.size() > longest) Fail(Concat("a text of ", text.size(), " bytes, at most ", longest));
    return text;
  }
  std::string Name() const {
    std::string name = Text();
    const auto fits = [](char c) { return c > ' ' && c < 0x7f && c != '"' && c != '<' && c != '>' && c != ','; };
    if (name.empty() || !std::all_of(name.begin(), name.end(), fits)) Fail(Concat("'", name, "' is no name"));
    return name;
  }
  bool Bool() const {
    if (!value_.is_boolean()) Fail("expected true or false");
    return value_.get<bool>();
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < ArraySize(kMostMembers); ++i) names.push_back(At(i).Name());
    return names;
  }
  std::string Type() const {
    const std::string text = Text(256);
    try {
      return ToString(ParseLayoutType(text));
    } catch (const Error& error) {
      Fail(error.problem());
    }
  }
  // `own`: the class of that name in v1.0; may be null.
  std::vector<LayoutMember> Members(const LayoutClass* own) const {
    std::vector<LayoutMember> members;
    for (std::size_t i = 0; i < ArraySize(kMostMembers); ++i) {
      const Reader member = At(i);
      if (member.ArraySize(2) != 2) member.Fail("expected a name and a type");
      members.push_back({member.At(0).Name(), member.At(1).Type()});
      if (own != nullptr) member.ExpectForm(members.back(), *own);
    }
    return members;
  }
  // A misspelt form must not be taken for a member that ORB-SLAM3 does not have.
  void ExpectForm(const LayoutMember& member, const LayoutClass& own) const {
    const auto found = std::ranges::find(own.members, layouts::NameOf(member.name), &LayoutMember::name);
    if (found == own.members.end()) return;
    const std::string problem = layouts::FormProblem(member, ParseLayoutType(found->type));
    if (!problem.empty()) Fail(problem);
  }

 private:
  const Json& value_;
  const std::string& path_;
  std::string place_;
};

// v1.0 itself is read without one in front of it.
const LayoutClass* OwnClass(std::span<const Layout> bases, const std::string& name) {
  return bases.empty() ? nullptr : bases.front().Find(name);
}

LayoutClass ReadClass(const Reader& json, const std::string& name, std::span<const Layout> bases) {
  json.ExpectObject({"fields", "registers", "abstract", "export"});
  LayoutClass of{.name = name};
  if (!json.Has("fields")) json.Fail("it has no 'fields'");
  of.members = json.At("fields").Members(OwnClass(bases, name));
  if (json.Has("registers")) of.registers = json.At("registers").Names();
  if (json.Has("abstract")) of.abstract = json.At("abstract").Bool();
  if (json.Has("export")) of.exported = json.At("export").Name();
  return of;
}

void ReadClasses(const Reader& json, Layout& layout, std::span<const Layout> bases) {
  if (!json.value().is_object()) json.Fail("expected an object");
  for (const auto& [name, value] : json.value().items()) {
    LayoutClass of = ReadClass(json.At(name), name, bases);
    if (LayoutClass* known = layout.Find(name))
      *known = std::move(of);
    else
      layout.classes.push_back(std::move(of));
  }
  if (layout.classes.size() > kMostClasses) json.Fail(Concat("more than ", kMostClasses, " classes"));
}

// Types of the root, as an array or in one text.
std::vector<std::string> ReadRoot(const Reader& json) {
  std::vector<std::string> types;
  if (json.value().is_array()) {
    for (std::size_t i = 0; i < json.ArraySize(16); ++i) types.push_back(json.At(i).Type());
    return types;
  }
  std::string text = json.Text(1024);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const Json one = text.substr(begin, end - begin);
    if (end > begin) types.push_back(Reader(one, json.path(), "root").Type());
    begin = end + 1;
  }
  return types;
}

using Position = std::vector<LayoutMember>::iterator;

Position FindMember(LayoutClass& of, const std::string& name, const Reader& json) {
  const auto found = std::ranges::find(of.members, name, &LayoutMember::name);
  if (found == of.members.end()) json.Fail(Concat(of.name, " has no member '", name, "'"));
  return found;
}

// {"class": C, "after": M, "add": [...]}: "after" "" is in front of all. Or {"class": C, "replace": [M, ...], "add":
// [...]}.
void ApplyChange(const Reader& json, Layout& layout, std::span<const Layout> bases) {
  json.ExpectObject({"class", "after", "replace", "add", "registers"});
  if (!json.Has("class")) json.Fail("it has no 'class'");
  LayoutClass* of = layout.Find(json.At("class").Name());
  if (of == nullptr) json.At("class").Fail("the base has no such class");
  if (json.Has("registers")) of->registers = json.At("registers").Names();
  if (json.Has("after") && json.Has("replace")) json.Fail("either 'after' or 'replace'");
  Position at = of->members.end();
  if (json.Has("after")) {
    const std::string name = json.At("after").Text();
    at = name.empty() ? of->members.begin() : FindMember(*of, name, json.At("after")) + 1;
  } else if (json.Has("replace")) {
    const Reader names = json.At("replace");
    for (const std::string& name : names.Names()) at = of->members.erase(FindMember(*of, name, names));
  }
  if (!json.Has("add")) return;
  const std::vector<LayoutMember> members = json.At("add").Members(OwnClass(bases, of->name));
  of->members.insert(at, members.begin(), members.end());
  if (of->members.size() > kMostMembers) json.Fail(Concat("more than ", kMostMembers, " members"));
}

void CheckType(const LayoutType& type, const Layout& layout, const std::string& path, const std::string& place) {
  if (!type.name.empty() && layout.Find(type.name) == nullptr)
    throw Error(ErrorKind::kDamaged, path, place, Concat("no class is called ", type.name));
  for (const LayoutType& element : type.elements) CheckType(element, layout, path, place);
}

// How much classes hold by value, all in all: members of members, and how deep. One that holds itself has no end.
class Extents {
 public:
  Extents(const Layout& layout, const std::string& path) : layout_(layout), path_(path) {}

  void Check(const LayoutClass& of) { (void)ExtentOf(of); }

 private:
  struct Extent {
    std::uint64_t members = 0;
    int depth = 0;
    bool known = false;
  };

  const Extent& ExtentOf(const LayoutClass& of) {
    const auto [found, is_new] = extents_.try_emplace(of.name);
    Extent& extent = found->second;
    if (!is_new && !extent.known) Fail(of, "holds itself by value");
    if (extent.known) return extent;
    for (const LayoutMember& member : of.members) Add(ParseLayoutType(member.type), extent);
    constexpr std::uint64_t kMostInEachOther = std::uint64_t{1} << 16;
    constexpr int kDeepest = 8;
    if (extent.depth > kDeepest) Fail(of, Concat("classes in classes, more than ", kDeepest, " deep"));
    if (extent.members > kMostInEachOther) Fail(of, Concat("more than ", kMostInEachOther, " members in each other"));
    extent.known = true;
    return extent;
  }
  void Add(const LayoutType& type, Extent& extent) {
    ++extent.members;
    for (const LayoutType& element : type.elements) Add(element, extent);
    if (type.kind != LayoutType::Kind::kValue && type.kind != LayoutType::Kind::kRaw) return;
    const Extent& held = ExtentOf(*layout_.Find(type.name));
    extent.members += held.members;
    extent.depth = std::max(extent.depth, held.depth + 1);
  }
  [[noreturn]] void Fail(const LayoutClass& of, const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, path_, Concat("classes.", of.name), problem);
  }

  const Layout& layout_;
  const std::string& path_;
  std::map<std::string, Extent> extents_;
};

void Check(const Layout& layout, const std::string& path) {
  if (layout.root.empty()) throw Error(ErrorKind::kDamaged, path, "root", "nothing is saved");
  for (const std::string& type : layout.root) CheckType(ParseLayoutType(type), layout, path, "root");
  for (const LayoutClass& of : layout.classes) {
    for (const LayoutMember& member : of.members)
      CheckType(ParseLayoutType(member.type), layout, path, Concat("classes.", of.name, ", ", member.name));
    for (const std::string& name : of.registers)
      if (layout.Find(name) == nullptr)
        throw Error(ErrorKind::kDamaged, path, Concat("classes.", of.name, ".registers"),
                    Concat("no class is called ", name));
  }
  Extents extents(layout, path);
  for (const LayoutClass& of : layout.classes) extents.Check(of);
}

Json Parsed(std::string_view text, const std::string& path) {
  if (text.size() > kMostBytes)
    throw Error(ErrorKind::kDamaged, path, "", Concat("a layout of ", text.size(), " bytes, at most ", kMostBytes));
  // Of two members of one name the parser would keep one without a word.
  std::vector<std::set<std::string>> names;
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    if (event == Json::parse_event_t::key && !names.back().insert(value.get<std::string>()).second && twice.empty())
      twice = value.get<std::string>();
    return true;
  };
  try {
    Json json = Json::parse(text, watch);
    if (!twice.empty())
      throw Error(ErrorKind::kDamaged, path, "", Concat("the member '", twice, "' stands there twice"));
    return json;
  } catch (const Json::exception& error) {
    std::string_view problem = error.what();
    if (problem.starts_with("["))
      problem.remove_prefix(std::min(problem.find("] ") + 2, problem.size()));  // its number
    throw Error(ErrorKind::kDamaged, path, "", Concat("no JSON: ", problem));
  }
}

}  // namespace

Layout ParseLayoutOver(std::string_view text, const std::string& path, std::span<const Layout> bases) {
  const Json parsed = Parsed(text, path);
  const Reader json(parsed, path, "");
  json.ExpectObject({"id", "title", "who", "base", "header", "root", "classes", "changes"});
  Layout layout;
  if (json.Has("base")) {
    const auto base = std::ranges::find(bases, json.At("base").Name(), &Layout::id);
    if (base == bases.end()) json.At("base").Fail("no layout is known by that id");
    layout = *base;
    layout.id = layout.title = layout.who = "";
  } else if (!json.Has("root") || !json.Has("classes")) {
    json.Fail("expected 'root' and 'classes', or a 'base'");
  }
  if (json.Has("id")) layout.id = json.At("id").Name();
  if (json.Has("title")) layout.title = json.At("title").Text(1024);
  if (json.Has("who")) layout.who = json.At("who").Text(1024);
  if (json.Has("header")) {
    const Json& header = json.At("header").value();
    if (header != kHeaderBytes && header != 0) json.At("header").Fail("expected 40, or 0 for none");
    layout.header = header == kHeaderBytes;
  }
  if (json.Has("root")) layout.root = ReadRoot(json.At("root"));
  if (json.Has("classes")) ReadClasses(json.At("classes"), layout, bases);
  if (json.Has("changes"))
    for (std::size_t i = 0; i < json.At("changes").ArraySize(kMostMembers); ++i)
      ApplyChange(json.At("changes").At(i), layout, bases);
  UseOwnNames(layout);
  Check(layout, path);
  return layout;
}

Json JsonOf(const Layout& layout) {
  Json json;
  if (!layout.id.empty()) json["id"] = layout.id;
  if (!layout.title.empty()) json["title"] = layout.title;
  if (!layout.who.empty()) json["who"] = layout.who;
  json["header"] = layout.header ? kHeaderBytes : 0;
  json["root"] = layout.root;
  Json& classes = json["classes"] = Json::object();
  for (const LayoutClass& of : layout.classes) {
    Json& written = classes[of.name];
    if (of.abstract) written["abstract"] = true;
    if (!of.exported.empty()) written["export"] = of.exported;
    if (!of.registers.empty()) written["registers"] = of.registers;
    Json& fields = written["fields"] = Json::array();
    for (const LayoutMember& member : of.members) fields.push_back({member.name, member.type});
  }
  return json;
}

}  // namespace detail

std::string ToJson(const Layout& layout) { return detail::Dumped(detail::JsonOf(layout)); }

}  // namespace slamdb
