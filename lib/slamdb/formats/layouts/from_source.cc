// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/from_source.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/formats/layouts/detail/source_layout.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using layouts::SourceClass;
using layouts::SourceLayout;
using layouts::SourceMember;

constexpr std::size_t kMostFiles = 20'000;
constexpr std::uint64_t kMostBytes = std::uint64_t{256} << 20U;

// ---- Names

// Which members of `names` stand for those of `own`, in order: a longest common subsequence. Row of `own`, or -1.
std::vector<std::ptrdiff_t> Aligned(const std::vector<SourceMember>& members, const std::vector<LayoutMember>& own) {
  const std::size_t columns = own.size() + 1;
  std::vector<std::uint32_t> longest((members.size() + 1) * columns, 0);
  for (std::size_t i = members.size(); i-- > 0;)
    for (std::size_t j = own.size(); j-- > 0;)
      longest[i * columns + j] = members[i].name == own[j].name
                                     ? longest[(i + 1) * columns + j + 1] + 1
                                     : std::max(longest[(i + 1) * columns + j], longest[i * columns + j + 1]);
  std::vector<std::ptrdiff_t> rows(members.size(), -1);
  for (std::size_t i = 0, j = 0; i < members.size() && j < own.size();) {
    if (members[i].name == own[j].name) {
      rows[i++] = static_cast<std::ptrdiff_t>(j++);
    } else if (longest[(i + 1) * columns + j] >= longest[i * columns + j + 1]) {
      ++i;
    } else {
      ++j;
    }
  }
  return rows;
}

// A name that stands there twice belongs to the member at ORB-SLAM3's place; the other is archived again.
std::vector<LayoutMember> Named(const SourceClass& source, const LayoutClass* own) {
  const std::vector<std::ptrdiff_t> rows =
      own == nullptr ? std::vector<std::ptrdiff_t>(source.members.size(), -1) : Aligned(source.members, own->members);
  std::map<std::string, int> uses;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] >= 0) uses[source.members[i].name] = 1;
  std::vector<LayoutMember> members;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const SourceMember& member = source.members[i];
    std::string name = member.name;
    if (rows[i] < 0) {
      const int use = uses[name]++;
      if (use > 0) name += use == 1 ? ".again" : detail::Concat(".again", use);
    }
    members.push_back({std::move(name), member.type});
  }
  return members;
}

// ---- Classes as ORB-SLAM3 has them

// Numbers that have the same bytes where long and size_t have 8.
LayoutType OfLongs(LayoutType type) {
  using Number = LayoutType::Number;
  if (type.number == Number::kSize || type.number == Number::kULongLong) type.number = Number::kU64;
  if (type.number == Number::kLong) type.number = Number::kI64;
  for (LayoutType& element : type.elements) element = OfLongs(std::move(element));
  return type;
}

// Its members as a flat list of what stands in the file: six f32 are an arr<f32,6>.
std::string Wire(const std::vector<LayoutMember>& members) {
  std::string wire;
  for (const LayoutMember& member : members) {
    if (member.type == layouts::kUnknownType) return "";
    const LayoutType type = OfLongs(ParseLayoutType(member.type));
    const bool array = type.kind == LayoutType::Kind::kArray && type.elements.front().kind == LayoutType::Kind::kNumber;
    const std::string one = array ? ToString(type.elements.front()) : ToString(type);
    for (std::uint32_t i = 0; i < (array ? type.count : 1); ++i) wire += one + " ";
  }
  return wire;
}

LayoutClass ToLayoutClass(const SourceClass& source, const LayoutClass* own) {
  LayoutClass of{.name = source.name, .members = Named(source, own)};
  of.registers = source.registers;
  of.abstract = source.abstract;
  of.exported = source.export_key;
  if (own != nullptr && Wire(of.members) == Wire(own->members) && !Wire(of.members).empty()) of.members = own->members;
  return of;
}

std::string OfLongs(const std::string& type) {
  return type == layouts::kUnknownType ? type : ToString(OfLongs(ParseLayoutType(type)));
}
Layout OfLongs(Layout layout) {
  for (std::string& type : layout.root) type = OfLongs(type);
  for (LayoutClass& of : layout.classes)
    for (LayoutMember& member : of.members) member.type = OfLongs(member.type);
  return layout;
}

std::string KnownAs(const Layout& layout) {
  const Layout of_longs = OfLongs(layout);
  for (const Layout& known : KnownLayouts())
    if (SameBytes(OfLongs(known), of_longs)) return known.id;
  return {};
}

void AddClasses(const LayoutType& type, std::set<std::string>& classes) {
  if (!type.name.empty()) classes.insert(type.name);
  for (const LayoutType& element : type.elements) AddClasses(element, classes);
}

std::vector<std::string> MissingIn(const Layout& layout) {
  std::set<std::string> classes{"Atlas", "KeyFrame", "Map", "MapPoint"};
  const auto add = [&](const std::string& type) {
    if (type != layouts::kUnknownType) AddClasses(ParseLayoutType(type), classes);
  };
  std::ranges::for_each(layout.root, add);
  for (const LayoutClass& of : layout.classes)
    for (const LayoutMember& member : of.members) add(member.type);
  std::vector<std::string> missing;
  if (layout.root.empty()) missing.emplace_back("what is saved: no function makes a Boost archive");
  for (const std::string& name : classes)
    if (layout.Find(name) == nullptr) missing.push_back(detail::Concat("the members of class ", name));
  return missing;
}

DerivedLayout ToDerived(SourceLayout source) {
  DerivedLayout derived;
  const Layout& own = KnownLayouts().front();
  for (const SourceMember& member : source.root) derived.layout.root.push_back(member.type);
  for (const SourceClass& of : source.classes) derived.layout.classes.push_back(ToLayoutClass(of, own.Find(of.name)));
  derived.missing = MissingIn(derived.layout);
  derived.known = KnownAs(derived.layout);
  for (layouts::SourceQuestion& question : source.questions)
    derived.questions.push_back({question.place.file, question.place.line, std::move(question.text)});
  return derived;
}

// ---- Files

bool IsSource(const fs::path& path) {
  static constexpr std::array<std::string_view, 7> kSuffixes = {".h", ".hh", ".hpp", ".hxx", ".cc", ".cpp", ".cxx"};
  return std::ranges::find(kSuffixes, path.extension().string()) != kSuffixes.end();
}

std::vector<std::string> SourcesIn(const std::string& folder) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (status.type() == fs::file_type::not_found) throw Error(ErrorKind::kNotFound, folder, "", "no such folder");
  if (status.type() != fs::file_type::directory)
    throw Error(ErrorKind::kUsage, folder, "", "expected a folder of sources");
  std::vector<std::string> files;
  constexpr auto kOptions = fs::directory_options::skip_permission_denied;
  fs::recursive_directory_iterator entry(folder, kOptions, error);
  if (error) throw SystemError(folder, "cannot be read");
  for (; entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    const bool hidden = entry->path().filename().string().starts_with(".");
    if (entry->is_directory(error) && hidden) entry.disable_recursion_pending();
    if (entry->is_symlink(error) || !entry->is_regular_file(error) || !IsSource(entry->path())) continue;
    files.push_back(entry->path().lexically_relative(folder).string());
    if (files.size() > kMostFiles)
      throw Error(ErrorKind::kOutOfResources, folder, "", detail::Concat("more than ", kMostFiles, " source files"));
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

DerivedLayout DeriveLayout(std::span<const SourceText> sources) {
  layouts::CppIndex index;
  for (const SourceText& source : sources) index.Add(source.file, source.text);
  DerivedLayout derived = ToDerived(LayoutOfSources(index));
  derived.files = sources.size();
  return derived;
}

DerivedLayout DeriveLayoutOfFolder(const std::string& folder) {
  const std::vector<std::string> files = SourcesIn(folder);
  if (files.empty())
    throw Error(ErrorKind::kNotPossible, folder, "", "holds no C++ sources (.h, .hh, .hpp, .hxx, .cc, .cpp, .cxx)");
  layouts::CppIndex index;
  std::uint64_t bytes = 0;
  for (const std::string& file : files) {
    const WholeFile whole(Source{(fs::path(folder) / file).string()});
    bytes += whole.bytes().size();
    if (bytes > kMostBytes) throw Error(ErrorKind::kOutOfResources, folder, "", "more than 256 MB of sources");
    index.Add(file, std::string(whole.text()));
  }
  DerivedLayout derived = ToDerived(LayoutOfSources(index));
  derived.files = files.size();
  return derived;
}

}  // namespace slamdb
