// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/inference.h"

namespace slamdb::layouts {
namespace {

using detail::Concat;

constexpr std::size_t kSamples = 6, kMostRounds = 8, kJudged = 100, kMostOptions = 24;
constexpr double kMostUnfit = 0.02;  // of records: those that bring a class for the first time
constexpr double kAlike = 25;        // more speaks against what is not worth a look at the whole file
constexpr std::string_view kUnknown = "unknown";

// The classes that a class holds, itself first.
void AddHeld(const Layout& layout, const std::string& name, std::vector<std::string>& held) {
  if (std::ranges::find(held, name) != held.end()) return;
  held.push_back(name);
  const LayoutClass* of = layout.Find(name);
  if (of == nullptr) return;
  for (const LayoutMember& member : of->members) {
    std::vector<LayoutType> types{ParseLayoutType(member.type)};
    while (!types.empty()) {
      const LayoutType type = std::move(types.back());
      types.pop_back();
      if (type.kind == LayoutType::Kind::kValue || type.kind == LayoutType::Kind::kRaw)
        AddHeld(layout, type.name, held);
      types.insert(types.end(), type.elements.begin(), type.elements.end());
    }
  }
}

void TakeClass(const Layout& from, const std::string& name, Layout& to) {
  std::vector<std::string> held;
  AddHeld(from, name, held);
  for (const std::string& one : held) {
    if (LayoutClass* known = to.Find(one))
      *known = *from.Find(one);
    else
      to.classes.push_back(*from.Find(one));
  }
}

// Looks at the records of one class.
class ClassSearch {
 public:
  ClassSearch(const ArchiveBytes& archive, std::string_view class_name, std::span<const MemberPlace> records)
      : archive_(archive), class_name_(class_name), records_(records) {}

  std::optional<ClassOption> Known(const Layout& layout) const {
    const Layout* best = nullptr;
    double least = kMostPenalty;
    for (const Layout& known : KnownLayouts()) {
      const Wire wire(known, archive_.encoding);
      if (wire.RowOf(class_name_) < 0 || Unfit(wire, 1)) continue;
      const double penalty = Penalty(known, wire);
      if (penalty >= least) continue;
      least = penalty;
      best = &known;
    }
    if (best == nullptr) return std::nullopt;
    ClassOption option{layout, {}};
    if (best != &KnownLayouts().front())
      option.findings.differences.push_back(Concat(class_name_, ": as in ", best->id));
    TakeClass(*best, std::string(class_name_), option.layout);
    return option;
  }

  std::vector<ClassOption> Changed(const Layout& layout, bool thorough) const {
    Wire wire(layout, archive_.encoding);
    RecordSearch search(wire, archive_.file, archive_.encoding, StepsOf(layout, wire, class_name_));
    std::vector<MemberPlace> samples = Samples();
    for (std::size_t round = 0; round < kMostRounds; ++round) {
      const std::vector<RecordSolution> solutions =
          Likeliest(round == 0 ? RunWithoutOutlier(search, samples, thorough) : search.Run(samples, thorough),
                    search.steps(), layout);
      std::vector<ClassOption> options;
      for (std::size_t i = 0; i < solutions.size() && options.size() < kMostOptions; ++i) {
        ClassOption option{layout, {}};
        Apply(solutions[i], search.steps(), option.layout, option.findings);
        const Wire result(option.layout, archive_.encoding);
        if (i == 0 && Unfit(result, 1)) {
          samples.push_back(*Unfit(result, 0));
          break;
        }
        options.push_back(std::move(option));
      }
      if (solutions.empty() || !options.empty()) return options;
    }
    return {};
  }

 private:
  // A record that brings a class for the first time is like no other: where nothing explains all samples, without one.
  static std::vector<RecordSolution> RunWithoutOutlier(RecordSearch& search, std::vector<MemberPlace>& samples,
                                                       bool thorough) {
    std::vector<RecordSolution> solutions = search.Run(samples, thorough);
    for (std::size_t left_out = 0; solutions.empty() && left_out < samples.size() && samples.size() > 2; ++left_out) {
      std::vector<MemberPlace> others = samples;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
      solutions = search.Run(others, thorough, RecordSearch::kMostNodes / 4);
      if (!solutions.empty()) samples = std::move(others);
    }
    return solutions;
  }

  // Those against which least speaks in all records.
  std::vector<RecordSolution> Likeliest(std::vector<RecordSolution> solutions, const std::vector<SearchStep>& steps,
                                        const Layout& layout) const {
    if (solutions.size() < 2) return solutions;
    std::vector<double> penalties;
    for (const RecordSolution& solution : solutions) {
      Layout changed = layout;
      Findings found;
      Apply(solution, steps, changed, found);
      penalties.push_back(Penalty(changed, Wire(changed, archive_.encoding)));
    }
    const double most = *std::ranges::min_element(penalties) + kAlike;
    std::vector<std::size_t> order(solutions.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return penalties[i]; });
    std::vector<RecordSolution> likeliest;
    for (const std::size_t i : order)
      if (penalties[i] <= most) likeliest.push_back(std::move(solutions[i]));
    return likeliest;
  }

  // A record that the layout does not read from end to end; none while they are few, where `some` may be.
  std::optional<MemberPlace> Unfit(const Wire& wire, int some) const {
    const WarmWalk walk(wire, archive_.file, archive_.encoding);
    const WireClass& of = wire.classes[static_cast<std::size_t>(wire.RowOf(class_name_))];
    const double most = some == 0 ? 0 : MostUnfit();
    std::size_t unfit = 0;
    for (const MemberPlace& record : records_)
      if (walk.BehindMembers(of, record.begin, 0) != record.end && static_cast<double>(++unfit) > most) return record;
    return std::nullopt;
  }

  // A list brings its classes with the first record in which it is not empty.
  double MostUnfit() const {
    const auto count = static_cast<double>(records_.size());
    return std::max(kMostUnfit * count, std::min(3.0, count / 3));
  }

  // What speaks against the members, by record.
  double Penalty(const Layout& layout, const Wire& wire) const {
    const WarmWalk walk(wire, archive_.file, archive_.encoding);
    std::vector<MemberPlace> at = Spread(records_, kJudged);
    std::erase_if(at, [&](const MemberPlace& record) {
      return walk.BehindMembers(wire.classes[static_cast<std::size_t>(wire.RowOf(class_name_))], record.begin, 0) !=
             record.end;
    });
    std::vector<RecordFacts> facts(at.size());
    double penalty = 0;
    for (const SearchStep& step : StepsOf(layout, wire, class_name_)) {
      std::vector<MemberPlace> places;
      for (MemberPlace& record : at) {
        const std::uint64_t behind = walk.Behind(step.type, record.begin);
        places.push_back({record.begin, behind});
        record.begin = behind;
      }
      penalty += step.check.Penalty(archive_.file, places, facts);
    }
    return penalty;
  }

  static std::vector<MemberPlace> Spread(std::span<const MemberPlace> records, std::size_t most) {
    std::vector<MemberPlace> spread;
    const std::size_t count = std::min(most, records.size());
    for (std::size_t i = 0; i < count; ++i) spread.push_back(records[i * records.size() / count]);
    return spread;
  }
  // Spread over the file behind the first third, which may bring classes, and the longest one there, in which every
  // list has something.
  std::vector<MemberPlace> Samples() const {
    const std::span<const MemberPlace> later = records_.subspan(records_.size() / 3);
    std::vector<MemberPlace> samples = Spread(later, kSamples);
    const auto longest =
        std::ranges::max_element(records_, {}, [](const MemberPlace& record) { return record.end - record.begin; });
    const auto same = [&](const MemberPlace& sample) { return sample.begin == longest->begin; };
    if (std::ranges::none_of(samples, same)) samples.push_back(*longest);
    return samples;
  }

  // ---- Changes

  // The class that a step's neighbour belongs to: new members between two classes are of the outer one.
  std::string OwnerOf(const std::vector<SearchStep>& steps, std::uint32_t step) const {
    if (step == 0 || step == steps.size() || steps[step - 1].of_class != steps[step].of_class)
      return std::string(class_name_);
    return steps[step].of_class;
  }

  static std::size_t RowOf(const LayoutClass& of, const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(of.members, name, &LayoutMember::name) - of.members.begin());
  }
  // The member that holds a class by value.
  static std::size_t RowOfValue(const LayoutClass& of, const std::string& held) {
    return static_cast<std::size_t>(std::ranges::find(of.members, Concat("val<", held, ">"), &LayoutMember::type) -
                                    of.members.begin());
  }

  // Where a member of the class stands that comes in front of a step.
  static std::size_t RowInFront(const LayoutClass& of, const std::vector<SearchStep>& steps, std::uint32_t step) {
    if (step == steps.size()) return of.members.size();
    return steps[step].of_class == of.name ? RowOf(of, steps[step].name) : RowOfValue(of, steps[step].of_class);
  }

  void Apply(const RecordSolution& solution, const std::vector<SearchStep>& steps, Layout& layout,
             Findings& found) const {
    const int before = Unknowns(layout);
    int unknown = before;
    for (const RecordEdit& edit : solution.edits) {
      if (IsOfMember(edit)) continue;
      const bool removes = edit.kind == RecordEdit::Kind::kRemove || edit.kind == RecordEdit::Kind::kRemoveClass;
      const std::string owner =
          edit.kind == RecordEdit::Kind::kRemove ? steps[edit.step].of_class : OwnerOf(steps, edit.step);
      LayoutClass& of = *layout.Find(owner);
      const auto at = of.members.begin() + static_cast<std::ptrdiff_t>(RowInFront(of, steps, edit.step));
      if (removes)
        of.members.erase(at);
      else
        of.members.insert(at, {Concat(kUnknown, ++unknown), edit.type});
    }
    for (const RecordEdit& edit : solution.edits) {  // by their names, which others go by, too
      if (!IsOfMember(edit)) continue;
      LayoutClass& of = *layout.Find(steps[edit.step].of_class);
      const auto at = of.members.begin() + static_cast<std::ptrdiff_t>(RowOf(of, steps[edit.step].name));
      if (edit.kind == RecordEdit::Kind::kForm)
        *at = {edit.name, edit.type};
      else
        std::iter_swap(at, at + 1);
    }
    for (const std::uint32_t step : solution.doubtful) {
      LayoutMember& member =
          layout.Find(steps[step].of_class)->members[RowOf(*layout.Find(steps[step].of_class), steps[step].name)];
      found.doubts.push_back(
          Concat(steps[step].of_class, ": the values of ", member.name, " are not like it; they are kept as unknown"));
      member.name = Concat(kUnknown, ++unknown);
    }
    int inserted = before;
    for (const RecordEdit& edit : solution.edits) {
      inserted += edit.kind == RecordEdit::Kind::kInsert;
      found.differences.push_back(Text(edit, steps, inserted));
    }
  }

  // Of a member that is there.
  static bool IsOfMember(const RecordEdit& edit) {
    return edit.kind == RecordEdit::Kind::kForm || edit.kind == RecordEdit::Kind::kSwap;
  }

  static int Unknowns(const Layout& layout) {
    int count = 0;
    for (const LayoutClass& of : layout.classes)
      count += static_cast<int>(std::ranges::count_if(of.members, IsUnknown));
    return count;
  }

  // `unknown`: the number of the member that an insertion is.
  std::string Text(const RecordEdit& edit, const std::vector<SearchStep>& steps, int unknown) const {
    const std::string name = edit.step < steps.size() ? steps[edit.step].name : "";
    if (edit.kind == RecordEdit::Kind::kRemove) return Concat(steps[edit.step].of_class, ": no ", name);
    if (edit.kind == RecordEdit::Kind::kForm)
      return Concat(steps[edit.step].of_class, ": ", edit.type, " ", edit.name, " for ", name);
    if (edit.kind == RecordEdit::Kind::kSwap)
      return Concat(steps[edit.step].of_class, ": ", steps[edit.step + 1].name, " in front of ", name);
    const std::string owner = OwnerOf(steps, edit.step);
    if (edit.kind == RecordEdit::Kind::kRemoveClass) return Concat(owner, ": no ", steps[edit.step].of_class);
    return InsertionText(owner, Concat(kUnknown, unknown), edit.type, edit.step == 0 ? "" : steps[edit.step - 1].name,
                         name);
  }

  const ArchiveBytes& archive_;
  const std::string_view class_name_;
  const std::span<const MemberPlace> records_;
};

}  // namespace

std::string InsertionText(std::string_view of_class, std::string_view name, const std::string& type,
                          std::string_view front, std::string_view back) {
  const LayoutType parsed = ParseLayoutType(type);
  const bool raw = parsed.kind == LayoutType::Kind::kArray && parsed.elements[0].number == LayoutType::Number::kU8 &&
                   parsed.elements[0].kind == LayoutType::Kind::kNumber;
  const std::string where = front.empty()  ? Concat("in front of ", back)
                            : back.empty() ? Concat("at the end, behind ", front)
                                           : Concat("between ", front, " and ", back);
  return Concat(of_class, ": ", name, ", ", raw ? detail::Counted(parsed.count, "byte") : type, ", ", where);
}

bool IsUnknown(const LayoutMember& member) { return member.name.starts_with(kUnknown); }

std::vector<ClassOption> FindClass(const ArchiveBytes& archive, std::string_view class_name,
                                   std::span<const MemberPlace> records, const Layout& layout, bool thorough) {
  if (records.empty()) return {{layout, {}}};  // nothing speaks against the members that it has
  const ClassSearch search(archive, class_name, records);
  std::vector<ClassOption> options;
  if (std::optional<ClassOption> known = search.Known(layout)) options.push_back(std::move(*known));
  if (!options.empty() && !thorough) return options;
  for (ClassOption& changed : search.Changed(layout, thorough)) {
    std::vector<ClassOption> alike = LookAlikesOf(archive, changed, class_name, records);
    options.push_back(std::move(changed));
    std::ranges::move(alike, std::back_inserter(options));
  }
  return options;
}

// ---- Types of unknown members

namespace {

// Lists of numbers that are as long in all records: they have no class information, but are classes.
void AddLists(std::uint32_t bytes, std::vector<std::string>& types) {
  constexpr std::uint32_t kCount = 8, kHead = 12;  // count and item version
  if (bytes > kHead && (bytes - kHead) % 8 == 0) types.emplace_back("set<u64>");
  if (bytes > kHead && (bytes - kHead) % 4 == 0) types.emplace_back("set<u32>");
  if (bytes > kCount && (bytes - kCount) % 8 == 0) types.emplace_back("vec<f64>");
  if (bytes > kCount && (bytes - kCount) % 2 == 0) types.emplace_back("vec<u16>");
  if (bytes > kCount) types.emplace_back("vec<u8>");
}

// Bytes of which a part has class information in front: a list that is as long in all records, behind others or not;
// with the classes of its elements behind its count.
void AddParts(std::uint32_t bytes, std::vector<std::string>& types) {
  constexpr std::uint32_t kHead = 12, kMost = 160;  // count and item version
  const auto part = [](const char* type, std::uint32_t size, const char* end) { return Concat(type, size, end); };
  if (bytes > kHead) types.push_back(part("val<Unknown", kHead, ">") + part("+val<Unknown", bytes - kHead, ">"));
  for (std::uint32_t front = 1; front < bytes && bytes <= kMost; ++front)
    types.push_back(part("arr<u8,", front, ">") + part("+val<Unknown", bytes - front, ">"));
}

// What a member may be whose bytes were seen where every class has been met, likeliest first; several members one
// behind the other are joined by `+`.
std::vector<std::string> TypesLike(const std::string& warm_type) {
  const LayoutType type = ParseLayoutType(warm_type);
  const auto value = [](std::uint32_t bytes) { return Concat("val<Unknown", bytes, ">"); };
  if (type.kind == LayoutType::Kind::kArray) {
    const std::uint32_t bytes = type.count;
    std::vector<std::string> types{warm_type};
    if (bytes == 1) types = {"u8"};
    if (bytes == 2) types = {"u16", "ptr<GeometricCamera>"};
    if (bytes == 4) types = {"u32"};
    if (bytes == 6) types = {"ptr<GeometricCamera>", warm_type};
    if (bytes == 8) types = {"u64"};
    if (bytes > 2 && bytes != 6) types.push_back(value(bytes));
    if (bytes == 8) types.insert(types.end(), {"vec<f64>", "vec<u8>"});  // empty ones
    if (bytes == 12)
      types.insert(types.end(), {"set<u64>", "map<u64,u64>", "map<u64,i32>", "vec<vec<u64>>", "vec<vec<i32>>"});
    AddLists(bytes, types);
    AddParts(bytes, types);
    return types;
  }
  if (warm_type == "map<u32,vec<u32>>")
    return {"map<u32,vec<u32>>", "map<i32,vec<i32>>", "map<i32,vec<u32>>",
            "map<u32,vec<i32>>", "map<u32,vec<f32>>", "map<i32,vec<f32>>"};
  if (warm_type == "map<u64,vec<u64>>") return {"map<u64,vec<u64>>", "map<u64,vec<f64>>", "map<i64,vec<i64>>"};
  if (warm_type == "map<u64,vec<u32>>") return {"map<u64,vec<u32>>", "map<u64,vec<i32>>", "map<u64,vec<f32>>"};
  if (warm_type == "vec<u32>") return {"vec<u32>", "vec<i32>", "vec<f32>"};
  if (warm_type == "vec<u64>") return {"vec<u64>", "vec<i64>", "vec<f64>"};
  if (warm_type == "vec<u8>") return {"string", "vec<u8>"};
  if (warm_type == "vec<vec<u8>>" || warm_type == "vec<string>") return {"vec<string>", "vec<vec<u8>>", "set<string>"};
  if (warm_type == "vec<vec<u64>>") return {"vec<vec<u64>>", "vec<vec<f64>>"};
  if (warm_type == "vec<vec<u32>>") return {"vec<vec<u32>>", "vec<vec<i32>>", "vec<vec<f32>>"};
  if (type.kind != LayoutType::Kind::kVector || type.elements[0].kind != LayoutType::Kind::kArray) return {warm_type};
  const std::uint32_t bytes = type.elements[0].count;
  std::vector<std::string> types;
  if (bytes == 1) return {"set<u8>"};
  if (bytes == 2) types = {"set<u16>"};
  if (bytes == 4) types = {"set<u32>", "list<f32>"};
  if (bytes == 8) types = {"set<u64>", "map<u32,u32>", "map<i32,f32>"};
  if (bytes == 12) types = {"map<u64,i32>", "map<u64,f32>", "map<u32,f64>", "map<i32,f64>", "map<i64,i32>"};
  if (bytes == 16) types = {"map<u64,u64>", "map<u64,f64>"};
  types.push_back(Concat("vec<", value(bytes), ">"));
  types.push_back(Concat("set<arr<u8,", bytes, ">>"));
  if (bytes > 8) types.push_back(Concat("map<u64,arr<u8,", bytes - 8, ">>"));
  if (bytes > 4) types.push_back(Concat("map<u32,arr<u8,", bytes - 4, ">>"));
  return types;
}

// Gives the layout a class of so many bytes where the type wants one: each is a class of its own.
std::string WithClass(Layout& layout, const std::string& type) {
  constexpr std::string_view kWanted = "val<Unknown";
  const std::size_t at = type.find(kWanted);
  if (at == std::string::npos) return type;
  const std::size_t end = type.find('>', at);
  const std::string bytes = type.substr(at + kWanted.size(), end - at - kWanted.size());
  LayoutClass added;
  added.name = Concat("Unknown", bytes);
  for (int number = 2; layout.Find(added.name) != nullptr; ++number) added.name = Concat("Unknown", bytes, "_", number);
  added.members.push_back({"bytes", Concat("arr<u8,", bytes, ">")});
  const std::string typed = type.substr(0, at + 4) + added.name + type.substr(end);
  layout.classes.push_back(std::move(added));
  return typed;
}

}  // namespace

void SetType(Layout& layout, const std::string& class_name, std::size_t row, const std::string& types) {
  const std::string name = layout.Find(class_name)->members[row].name;
  std::size_t begin = 0;
  for (int part = 1; begin <= types.size(); ++part, ++row) {
    const std::size_t end = std::min(types.find('+', begin), types.size());
    const std::string type = WithClass(layout, types.substr(begin, end - begin));
    std::vector<LayoutMember>& members = layout.Find(class_name)->members;
    if (part == 1)
      members[row].type = type;
    else
      members.insert(members.begin() + static_cast<std::ptrdiff_t>(row), {Concat(name, "_", part), type});
    begin = end + 1;
  }
}

Typings::Typings(const Layout& layout) : layout_(layout) {
  for (const LayoutClass& of : layout.classes)
    for (std::size_t row = 0; row < of.members.size(); ++row)
      if (IsUnknown(of.members[row])) unknown_.push_back({of.name, row, TypesLike(of.members[row].type)});
  for (const Unknown& one : unknown_) count_ = std::min(kMost, count_ * one.types.size());
}

Layout Typings::At(std::size_t row) const {
  Layout typed = layout_;
  for (auto one = unknown_.rbegin(); one != unknown_.rend(); ++one) {  // rows in front stay where they are
    SetType(typed, one->of_class, one->row, one->types[row % one->types.size()]);
    row /= one->types.size();
  }
  return typed;
}

}  // namespace slamdb::layouts
