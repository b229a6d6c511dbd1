// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/source_layout.h"

#include <algorithm>
#include <set>

#include "slamdb/base/detail/concat.h"

namespace slamdb::layouts {
namespace {

using Tokens = std::span<const CppToken>;

// Whether the second parameter of a free function is of that class: `serialize(Archive& ar, BowVector& v, ...)`.
bool IsFor(const CppFunction& function, std::string_view class_name) {
  const auto comma = std::ranges::find_if(function.parameters, [](const CppToken& token) { return token.Is(","); });
  if (comma == function.parameters.end()) return false;
  Tokens second(comma + 1, function.parameters.end());
  const auto end = std::ranges::find_if(second, [](const CppToken& token) { return token.Is(",") || token.Is("&"); });
  return CppTypes::NameOf(Tokens(second.begin(), end)) == class_name;
}

// Gathers the classes that the root comes to.
class Gatherer {
 public:
  explicit Gatherer(const CppIndex& index) : index_(index) {}

  SourceLayout Run() {
    FindRoot();
    for (const SourceMember& member : layout_.root) Want(member.type);
    while (next_ < wanted_.size()) {
      const std::string name = wanted_[next_++];
      AddClass(name);
    }
    return std::move(layout_);
  }

 private:
  struct Root {
    std::vector<SourceMember> members;
    std::vector<SourceQuestion> questions;
  };

  // ---- The root

  // The longest list of what a function gives to a binary archive and in which an atlas, or else a map, stands.
  void FindRoot() {
    Root best;
    int best_rank = -1;
    for (const CppFunction& function : index_.functions) {
      for (const std::string& archive : ArchivesIn(function)) {
        Root root;
        SerializeBody body(index_, function, root.questions);
        body.Read(archive, /*all_branches=*/true);
        root.members = std::move(body.members);
        const int rank = Rank(root.members);
        if (rank <= best_rank) continue;
        best_rank = rank;
        best = std::move(root);
      }
    }
    const bool found = best_rank > 0;
    if (!found) {
      Ask({}, "no function writes an atlas to an archive: taken to be two strings and Atlas*");
      best.members = {{"vocabulary", "string"}, {"checksum", "string"}, {"atlas", "ptr<Atlas>"}};
    }
    layout_.root = std::move(best.members);
    // A function that makes a text and a binary archive under one name writes the same to both.
    const std::size_t half = layout_.root.size() / 2;
    const auto same = [](const SourceMember& a, const SourceMember& b) { return a.name == b.name && a.type == b.type; };
    if (layout_.root.size() % 2 == 0 && half > 0 &&
        std::equal(layout_.root.begin(), layout_.root.begin() + static_cast<std::ptrdiff_t>(half),
                   layout_.root.begin() + static_cast<std::ptrdiff_t>(half), same))
      layout_.root.resize(half);
    for (SourceQuestion& question : best.questions)
      if (found && IsOfRoot(question)) layout_.questions.push_back(std::move(question));
  }
  static int Rank(const std::vector<SourceMember>& members) {
    const auto has = [&](std::string_view type) {
      return std::ranges::any_of(members, [&](const SourceMember& member) { return member.type == type; });
    };
    return has("ptr<Atlas>") || has("val<Atlas>") ? 2 : has("ptr<Map>") ? 1 : 0;
  }
  bool IsOfRoot(const SourceQuestion&) const {
    return std::ranges::any_of(layout_.root, [](const SourceMember& member) { return member.type == kUnknownType; });
  }
  // The variables of an archive's type.
  static std::set<std::string> ArchivesIn(const CppFunction& function) {
    std::set<std::string> names;
    for (std::size_t i = 0; i + 1 < function.body.size(); ++i)
      if ((function.body[i].Is("binary_oarchive") || function.body[i].Is("text_oarchive")) &&
          function.body[i + 1].is_word())
        names.emplace(function.body[i + 1].text);
    return names;
  }

  void Ask(const CppPlace& place, const std::string& text) {
    SourceQuestion& question = layout_.questions.emplace_back();
    question.place = place;
    question.text = text;
  }

  // ---- Classes

  // The classes that a word of a layout names.
  void Want(std::string_view type) {
    for (const std::string_view kind : {"ptr<", "val<"})
      for (std::size_t at = type.find(kind); at != std::string_view::npos; at = type.find(kind, at + 1)) {
        const std::size_t begin = at + kind.size();
        Want(std::string(type.substr(begin, type.find('>', begin) - begin)), 0);
      }
  }
  void Want(std::string name, int) {
    if (seen_.insert(name).second) wanted_.push_back(std::move(name));
  }

  void AddClass(const std::string& name) {
    SourceClass added;
    added.name = name;
    if (const auto key = index_.export_keys.find(name); key != index_.export_keys.end()) added.export_key = key->second;
    const auto declared = index_.classes.find(name);
    added.abstract = declared != index_.classes.end() && declared->second.abstract;
    if (const auto version = index_.versions.find(name); version != index_.versions.end())
      Ask(version->second, name + " has a class version: what depends on it is not followed");
    const CppFunction* function = FunctionOf(name);
    if (function == nullptr && BowMap(name) != nullptr) {
      Ask({}, name + " is not in these sources: taken to be DBoW2's");
      added.members.push_back({"m", BowMap(name)});
    } else if (function == nullptr) {
      Ask(declared == index_.classes.end() ? CppPlace() : declared->second.place,
          name + " is archived, and no serialize function of it was found");
      added.members.push_back({"(all)", std::string(kUnknownType)});
    } else {
      CppFunction owned = *function;
      owned.owner = name;
      SerializeBody body(index_, owned, layout_.questions);
      body.Read(FirstParameter(function->parameters), false);
      added.members = std::move(body.members);
      added.registers = std::move(body.registers);
    }
    for (const std::string& registered : added.registers) Want(registered, 0);
    for (const SourceMember& member : added.members) Want(member.type);
    layout_.classes.push_back(std::move(added));
  }

  // What DBoW2's classes archive; null for others.
  static const char* BowMap(std::string_view name) {
    if (name == "BowVector") return "map<u32,f64>";
    return name == "FeatureVector" ? "map<u32,vec<u32>>" : nullptr;
  }

  // What archives a class: `save` where loading differs.
  const CppFunction* FunctionOf(const std::string& name) {
    std::vector<const CppFunction*> found;
    for (const char* function : {"save", "serialize"}) {
      for (const CppFunction* member : index_.Find(name, function))
        if (HasArchive(*member)) found.push_back(member);
      for (const CppFunction& free : index_.functions)
        if (free.name == function && free.owner != name && IsFor(free, name)) found.push_back(&free);
      if (!found.empty()) break;
    }
    if (found.empty()) return nullptr;
    const auto differs = std::ranges::find_if(found, [&](const CppFunction* other) {
      return !std::ranges::equal(other->body, found[0]->body, {}, &CppToken::text, &CppToken::text);
    });
    if (differs != found.end())
      Ask((*differs)->place, detail::Concat("another function that archives ", name, " than ",
                                            found[0]->place.ToString(), ", which was taken"));
    return found[0];
  }
  // Other classes have functions `save` and `load` too, of files.
  static bool HasArchive(const CppFunction& function) {
    const std::string archive = FirstParameter(function.parameters);
    return std::ranges::any_of(function.body, [&](const CppToken& token) { return token.Is(archive); }) ||
           function.body.empty();
  }

  const CppIndex& index_;
  SourceLayout layout_;
  std::vector<std::string> wanted_;
  std::size_t next_ = 0;
  std::set<std::string> seen_;
};

}  // namespace

SourceLayout LayoutOfSources(const CppIndex& index) { return Gatherer(index).Run(); }

}  // namespace slamdb::layouts
