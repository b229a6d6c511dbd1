// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/record_search.h"

#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/member_forms.h"

namespace slamdb::layouts {
namespace {

constexpr int kEdit = 100;                 // costs a member that is more or less,
constexpr int kSameBytes = 40;             // one of another form, but as many bytes,
constexpr int kLaterForm = 40;             // or where another one is wider,
constexpr int kNextForm = 8;               // or its neighbour,
constexpr int kNextRemoval = 15;           // one more that is missing behind it,
constexpr int kTie = 4;                    // and what is as good as the best,
constexpr int kNearTie = 110;              // or nearly so
constexpr std::array kSlacks = {45, 160};  // where an anchor was passed, ways that cost more are given up
constexpr int kMostCost = 700;
constexpr int kDoubt = 45;
constexpr std::size_t kMostEntries = 4'000'000;
constexpr std::uint8_t kMostInsertsInGap = 3;
constexpr std::size_t kMostSolutions = 64, kMostNearSolutions = 400;
constexpr std::uint64_t kMostOfHead = 13;  // of an empty matrix
constexpr std::uint64_t kLongBytes = 512;  // from here on ends of values are kept

// Sizes that forks' members have, likeliest first.
constexpr std::array<std::uint32_t, 15> kUsualSizes = {4, 8, 1, 12, 28, 2, 16, 24, 36, 32, 20, 40, 48, 56, 64};
// Then all others, in tiers.
struct SizeTier {
  std::uint32_t first, last, step;
  int cost;
};
constexpr std::array kTiersOfSizes = {SizeTier{3, 63, 1, 125}, SizeTier{68, 256, 4, 130}, SizeTier{260, 4096, 4, 150}};

std::uint64_t Mixed(std::uint64_t hash, std::uint64_t value) {
  hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 6U) + (hash >> 2U);
  return hash * 0xff51afd7ed558ccdULL;
}

}  // namespace

std::vector<SearchStep> StepsOf(const Layout& layout, const Wire& wire, std::string_view class_name) {
  std::vector<SearchStep> steps;
  const LayoutClass* of = layout.Find(class_name);
  if (of == nullptr) return steps;
  const auto add = [&](const LayoutClass& holder) {
    const WireClass& rows = wire.classes[static_cast<std::size_t>(wire.RowOf(holder.name))];
    return [&steps, &holder, &rows](std::size_t i) {
      const LayoutMember& member = holder.members[i];
      steps.push_back({holder.name, member.name, rows.members[i].type, CheckedMember(holder.name, member)});
    };
  };
  for (std::size_t i = 0; i < of->members.size(); ++i) {
    const std::string& type = of->members[i].type;
    const LayoutClass* flat = nullptr;
    for (const char* name : {"Preintegrated", "Calib"})
      if (type == detail::Concat("val<", name, ">")) flat = layout.Find(name);
    if (flat == nullptr) add (*of)(i);
    for (std::size_t inner = 0; flat != nullptr && inner < flat->members.size(); ++inner) add (*flat)(inner);
  }
  return steps;
}

RecordSearch::RecordSearch(Wire& wire, std::string_view file, const ArchiveEncoding& encoding,
                           std::vector<SearchStep> steps)
    : wire_(wire), file_(file), encoding_(encoding), steps_(std::move(steps)) {
  MakeShapes();
  MakeForms();
}

// ---- What may be put in

void RecordSearch::AddShape(std::string type, int cost, bool raw) {
  const std::uint32_t row = wire_.Add(ParseLayoutType(type));
  const bool has_head = type == "mat" || type == "kps";
  shapes_.push_back({std::move(type), row, kEdit + cost, raw, has_head});
}

void RecordSearch::MakeShapes() {
  int cost = 0;
  for (const std::uint32_t size : kUsualSizes) AddShape(detail::Concat("arr<u8,", size, ">"), cost++ / 2, true);
  for (const char* type : {"vec<u32>", "vec<u64>", "vec<u8>", "vec<u16>"}) AddShape(type, 4, false);
  for (const char* type : {"mat", "kps"}) AddShape(type, 5, false);
  for (const int size : {12, 8, 4, 16, 28, 24, 36, 20, 32, 9, 5, 1, 2, 40, 48, 56, 64, 11, 10, 6, 3})
    AddShape(detail::Concat("vec<arr<u8,", size, ">>"), 7, false);
  for (const char* type :
       {"ptr<GeometricCamera>", "vec<vec<u64>>", "vec<vec<u32>>", "vec<vec<u8>>", "vec<string>", "map<u32,vec<u32>>",
        "map<u64,vec<u64>>", "map<u64,vec<u32>>", "map<u64,string>", "vec<vec<vec<u64>>>", "vec<mat>"})
    AddShape(type, 9, false);
}

// What cannot be held against anything is no form: it would explain any bytes.
void RecordSearch::MakeForms() {
  for (SearchStep& step : steps_) {
    const LayoutType* own = OwnTypeOf(step.of_class, step.name);
    if (own == nullptr || !step.check.known()) continue;
    for (LayoutMember& form : OtherForms(step.name, *own)) {
      const std::uint32_t row = wire_.Add(ParseLayoutType(form.type));
      const bool same_bytes = wire_.types[row].kind == WireType::Kind::kFixed &&
                              wire_.types[step.type].kind == WireType::Kind::kFixed &&
                              wire_.types[row].bytes == wire_.types[step.type].bytes;
      const CheckedMember check(step.of_class, form);
      step.forms.push_back({std::move(form), row, static_cast<int>(step.forms.size()), same_bytes, check});
    }
  }
}

// ---- The search

std::vector<RecordSolution> RecordSearch::Run(std::span<const MemberPlace> samples, bool thorough,
                                              std::size_t most_nodes) {
  most_nodes_ = most_nodes;
  thorough_ = thorough;
  for (const int slack : kSlacks) {
    if (thorough && slack != kSlacks.back()) continue;
    slack_ = slack;
    Search(samples);
    if (!goals_.empty()) break;
  }
  return Solutions();
}

void RecordSearch::Search(std::span<const MemberPlace> samples) {
  samples_.assign(samples.begin(), samples.end());
  nodes_.clear();
  cursors_.clear();
  facts_.clear();
  others_.clear();
  known_.clear();
  behind_.clear();
  goals_.clear();
  queue_ = {};
  order_ = 0;
  anchored_.assign(steps_.size() + 1, kMostCost);
  next_cursors_.resize(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) next_cursors_[i] = samples_[i].begin;
  next_facts_.assign(samples_.size(), RecordFacts());
  Settle({});
  int most = kMostCost;
  while (!queue_.empty() && nodes_.size() < most_nodes_ && order_ < kMostEntries) {
    const Entry entry = queue_.top();
    queue_.pop();
    if (entry.cost > most) break;
    if (IsBehindHope(nodes_[static_cast<std::size_t>(entry.node)])) continue;
    if (entry.action == kTake) {
      Expand(entry.node);
      if (!goals_.empty())
        most = std::min(most, nodes_[static_cast<std::size_t>(goals_.front())].cost + (thorough_ ? kNearTie : kTie));
    } else if (entry.action == kRemove) {
      RemoveSteps(entry.node, 1, entry.cost, kRemove);
    } else if (entry.action == kRemoveClass) {
      RemoveSteps(entry.node, EndOfClass(nodes_[static_cast<std::size_t>(entry.node)].step), entry.cost, kRemoveClass);
    } else if (entry.action == kSwap) {
      TakeSwapped(entry.node, entry.cost);
    } else if (entry.action <= kForms) {
      TakeForm(entry.node, static_cast<std::size_t>(kForms - entry.action), entry.cost);
    } else if (entry.action <= kTiers) {
      Tier(entry.node, kTiers - entry.action, entry.cost);
    } else {
      Insert(entry.node, static_cast<std::size_t>(entry.action), entry.cost);
    }
  }
}

void RecordSearch::Push(int cost, std::int32_t node, std::int32_t action) {
  if (cost <= kMostCost) queue_.push({cost, order_++, node, action});
}

// Another way has passed an anchor that this one has not, and costs less.
bool RecordSearch::IsBehindHope(const Node& node) const {
  for (std::size_t step = node.step; step < steps_.size(); ++step)
    if (anchored_[step] + slack_ < node.cost) return true;
  return false;
}

// Keeps a node with the cursors and facts that were made for it, unless it is there.
void RecordSearch::Settle(const Node& node) {
  std::uint64_t hash = Mixed(node.step, static_cast<std::uint64_t>(node.last) * 16U + node.inserts * 2U + node.formed);
  for (const std::uint64_t cursor : next_cursors_) hash = Mixed(hash, cursor);
  for (const RecordFacts& facts : next_facts_)
    for (const double value : facts.values) hash = Mixed(hash, std::hash<double>()(value));
  std::vector<std::int32_t>& same = known_[hash];
  const std::size_t count = samples_.size();
  for (const std::int32_t other : same) {
    const Node& known = nodes_[static_cast<std::size_t>(other)];
    const std::size_t at = static_cast<std::size_t>(other) * count;
    const bool equal =
        known.step == node.step && known.last == node.last && known.inserts == node.inserts &&
        known.formed == node.formed &&
        std::equal(next_cursors_.begin(), next_cursors_.end(), cursors_.begin() + static_cast<std::ptrdiff_t>(at)) &&
        std::equal(next_facts_.begin(), next_facts_.end(), facts_.begin() + static_cast<std::ptrdiff_t>(at));
    if (!equal) continue;
    if (node.cost <= known.cost + kTie) others_[static_cast<std::size_t>(other)].push_back({node.parent, node.action});
    return;
  }
  const auto id = static_cast<std::int32_t>(nodes_.size());
  same.push_back(id);
  nodes_.push_back(node);
  others_.emplace_back();
  cursors_.insert(cursors_.end(), next_cursors_.begin(), next_cursors_.end());
  facts_.insert(facts_.end(), next_facts_.begin(), next_facts_.end());
  Push(node.cost, id, kTake);
}

void RecordSearch::Expand(std::int32_t id) {
  const Node node = nodes_[static_cast<std::size_t>(id)];
  const std::size_t at = static_cast<std::size_t>(id) * samples_.size();
  if (node.step == steps_.size()) {
    bool ends = true;
    for (std::size_t i = 0; i < samples_.size(); ++i) ends = ends && cursors_[at + i] == samples_[i].end;
    if (ends) {
      goals_.push_back(id);
      return;
    }
  } else {
    const bool like = TakeStep(id);
    const std::vector<StepForm>& forms = steps_[node.step].forms;
    for (std::size_t form = 0; form < forms.size(); ++form)
      if (!forms[form].same_bytes || !like)
        Push(node.cost + CostOf(node, forms[form]), id, kForms - static_cast<std::int32_t>(form));
    if (node.step + 1 < steps_.size() && steps_[node.step].check.known() && steps_[node.step + 1].check.known())
      Push(node.cost + kEdit, id, kSwap);
    const int removal = node.cost + (node.last == Last::kRemove ? kNextRemoval : kEdit);
    if (node.inserts == 0) Push(removal, id, kRemove);
    if (node.inserts == 0 && EndOfClass(node.step) > 1) Push(removal, id, kRemoveClass);
  }
  if (node.inserts >= kMostInsertsInGap) return;
  for (std::size_t shape = 0; shape < shapes_.size(); ++shape)
    if (!shapes_[shape].raw || node.last != Last::kRaw)
      Push(node.cost + shapes_[shape].cost, id, static_cast<std::int32_t>(shape));
  if (node.last == Last::kRaw) return;
  for (std::size_t tier = 0; tier < kTiersOfSizes.size(); ++tier)
    Push(node.cost + kTiersOfSizes[tier].cost, id, kTiers - static_cast<std::int32_t>(tier));
}

// The cursors and facts of a node, to go on from.
void RecordSearch::StayAt(std::int32_t id) {
  const auto at = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(id) * samples_.size());
  const auto count = static_cast<std::ptrdiff_t>(samples_.size());
  std::copy(cursors_.begin() + at, cursors_.begin() + at + count, next_cursors_.begin());
  std::copy(facts_.begin() + at, facts_.begin() + at + count, next_facts_.begin());
}

// Goes on behind a value; what speaks against it, or nothing when there can be none.
std::optional<int> RecordSearch::Pass(std::uint32_t type, const CheckedMember& check) {
  std::vector<MemberPlace> places(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::uint64_t behind = Behind(type, i, next_cursors_[i]);
    if (behind == kNowhere) return std::nullopt;
    places[i] = {next_cursors_[i], behind};
    next_cursors_[i] = behind;
  }
  return check.Penalty(file_, places, next_facts_);
}

// Whoever writes one member wider does so with others.
int RecordSearch::CostOf(const Node& node, const StepForm& form) {
  if (form.same_bytes) return kSameBytes;
  const int first = node.last == Last::kForm ? kNextForm : node.formed ? kLaterForm : kEdit + 1;
  return first + form.rank;
}

// Returns whether the bytes are like the member.
bool RecordSearch::TakeStep(std::int32_t id) {
  const Node node = nodes_[static_cast<std::size_t>(id)];
  const SearchStep& step = steps_[node.step];
  StayAt(id);
  const std::optional<int> penalty = Pass(step.type, step.check);
  if (!penalty) return false;
  const int unlike = thorough_ && *penalty >= kDoubt ? kEdit : 0;
  Node next{.parent = id,
            .action = kTake,
            .step = node.step + 1,
            .cost = node.cost + *penalty + unlike,
            .penalty = *penalty,
            .formed = node.formed};
  const bool like = *penalty < kDoubt;
  if (next.cost > kMostCost) return like;
  if (step.check.anchor() && *penalty == 0) anchored_[node.step] = std::min(anchored_[node.step], next.cost);
  Settle(next);
  return like;
}

// What is changed must be like the member.
void RecordSearch::TakeForm(std::int32_t id, std::size_t row, int cost) {
  const Node node = nodes_[static_cast<std::size_t>(id)];
  const StepForm& form = steps_[node.step].forms[row];
  StayAt(id);
  const std::optional<int> penalty = Pass(form.type, form.check);
  if (!penalty || *penalty >= kDoubt) return;
  Settle({.parent = id,
          .action = kForms - static_cast<std::int32_t>(row),
          .step = node.step + 1,
          .cost = cost + *penalty,
          .penalty = *penalty,
          .last = form.same_bytes ? Last::kTake : Last::kForm,
          .formed = node.formed || !form.same_bytes});
}

void RecordSearch::TakeSwapped(std::int32_t id, int cost) {
  const Node node = nodes_[static_cast<std::size_t>(id)];
  StayAt(id);
  int penalty = 0;
  for (const std::uint32_t step : {node.step + 1, node.step}) {
    const std::optional<int> of_step = Pass(steps_[step].type, steps_[step].check);
    if (!of_step || *of_step >= kDoubt) return;
    penalty += *of_step;
  }
  Settle({.parent = id, .action = kSwap, .step = node.step + 2, .cost = cost + penalty, .formed = node.formed});
}

void RecordSearch::RemoveSteps(std::int32_t id, std::uint32_t count, int cost, std::int32_t action) {
  StayAt(id);
  const Node& node = nodes_[static_cast<std::size_t>(id)];
  Settle({.parent = id,
          .action = action,
          .step = node.step + count,
          .cost = cost,
          .last = Last::kRemove,
          .formed = node.formed});
}

// How many steps a class has that begins here; 0 when none does.
std::uint32_t RecordSearch::EndOfClass(std::uint32_t step) const {
  const std::string& name = steps_[step].of_class;
  if (name == steps_.front().of_class || steps_[step - 1].of_class == name) return 0;
  std::uint32_t count = 0;
  while (step + count < steps_.size() && steps_[step + count].of_class == name) ++count;
  return count;
}

void RecordSearch::Insert(std::int32_t id, std::size_t shape_row, int cost) {
  const Node node = nodes_[static_cast<std::size_t>(id)];
  const std::size_t at = static_cast<std::size_t>(id) * samples_.size();
  const InsertShape shape = shapes_[shape_row];
  // What is as long everywhere is no list, but bytes; matrices and keypoints are told by their heads.
  bool grows = shape.raw;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::uint64_t behind = Behind(shape.row, i, cursors_[at + i]);
    if (behind == kNowhere) return;
    grows = grows || behind - cursors_[at + i] != Behind(shape.row, 0, cursors_[at]) - cursors_[at] ||
            (shape.has_head && behind - cursors_[at + i] > kMostOfHead);
    next_cursors_[i] = behind;
    next_facts_[i] = facts_[at + i];
  }
  if (!grows && samples_.size() > 1) return;
  Settle({.parent = id,
          .action = static_cast<std::int32_t>(shape_row),
          .step = node.step,
          .cost = cost,
          .last = shape.raw ? Last::kRaw : Last::kInsert,
          .inserts = static_cast<std::uint8_t>(node.inserts + 1),
          .formed = node.formed});
}

// Unusual sizes are worth a node only where the next member fits behind them.
void RecordSearch::Tier(std::int32_t id, int tier, int cost) {
  const SizeTier& sizes = kTiersOfSizes[static_cast<std::size_t>(tier)];
  for (std::uint32_t size = sizes.first; size <= sizes.last; size += sizes.step) {
    if (std::ranges::find(kUsualSizes, size) != kUsualSizes.end() || !FitsBehind(id, size)) continue;
    const std::string type = detail::Concat("arr<u8,", size, ">");
    auto shape = std::ranges::find(shapes_, type, &InsertShape::type);
    if (shape == shapes_.end()) {
      shapes_.push_back({type, wire_.Add(ParseLayoutType(type)), kMostCost + 1, true, false});
      shape = shapes_.end() - 1;
    }
    Insert(id, static_cast<std::size_t>(shape - shapes_.begin()), cost + static_cast<int>(size % 4 == 0 ? 0 : 4));
  }
}

bool RecordSearch::FitsBehind(std::int32_t id, std::uint64_t bytes) {
  const Node& node = nodes_[static_cast<std::size_t>(id)];
  const std::size_t at = static_cast<std::size_t>(id) * samples_.size();
  std::vector<MemberPlace> places(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::uint64_t from = cursors_[at + i] + bytes;
    if (node.step == steps_.size()) {
      if (from != samples_[i].end) return false;
      continue;
    }
    const std::uint64_t behind = Behind(steps_[node.step].type, i, from);
    if (behind == kNowhere) return false;
    places[i] = {from, behind};
    next_facts_[i] = facts_[at + i];
  }
  if (node.step == steps_.size()) return true;
  return steps_[node.step].check.Penalty(file_, places, next_facts_) < kDoubt;
}

// Behind a value that stays within the sample.
std::uint64_t RecordSearch::Behind(std::uint32_t type, std::size_t sample, std::uint64_t at) {
  if (at > samples_[sample].end) return kNowhere;
  if (wire_.types[type].kind == WireType::Kind::kFixed) {
    const std::uint64_t behind = at + wire_.types[type].bytes;
    return behind <= samples_[sample].end ? behind : kNowhere;
  }
  const std::uint64_t key = Mixed(Mixed(type, sample), at);
  if (const auto found = behind_.find(key); found != behind_.end()) return found->second;
  const WarmWalk walk(wire_, file_.substr(0, samples_[sample].end), encoding_);
  const std::uint64_t behind = walk.Behind(type, at);
  if (behind != kNowhere && behind - at < kLongBytes && wire_.types[type].kind != WireType::Kind::kCollection)
    return behind;
  behind_.emplace(key, behind);
  return behind;
}

// ---- What came of it

std::vector<RecordSolution> RecordSearch::Solutions() const {
  std::vector<RecordSolution> solutions;
  // Ways back from the goals, each step of which may have others that cost as much.
  struct Open {
    std::int32_t node;
    std::vector<Alternative> way;
  };
  std::vector<Open> open;
  for (auto goal = goals_.rbegin(); goal != goals_.rend(); ++goal) open.push_back({*goal, {}});
  const std::size_t most = thorough_ ? kMostNearSolutions : kMostSolutions;
  while (!open.empty() && solutions.size() < most) {
    Open at = std::move(open.back());
    open.pop_back();
    const Node& node = nodes_[static_cast<std::size_t>(at.node)];
    if (node.parent < 0) {
      RecordSolution solution = SolutionOf(at.way);
      if (std::ranges::find(solutions, solution.edits, &RecordSolution::edits) == solutions.end())
        solutions.push_back(std::move(solution));
      continue;
    }
    for (const Alternative& other : others_[static_cast<std::size_t>(at.node)]) {
      open.push_back({other.parent, at.way});
      open.back().way.push_back({at.node, other.action});
    }
    at.way.push_back({at.node, node.action});
    at.node = node.parent;
    open.push_back(std::move(at));
  }
  std::ranges::sort(solutions, [](const RecordSolution& a, const RecordSolution& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.edits > b.edits;
  });
  return solutions;
}

// `way`: from the goal back, each node with the action that led to it.
RecordSolution RecordSearch::SolutionOf(const std::vector<Alternative>& way) const {
  RecordSolution solution;
  std::uint32_t step = 0;
  for (auto at = way.rbegin(); at != way.rend(); ++at) {
    const Node& node = nodes_[static_cast<std::size_t>(at->parent)];
    if (at->action == kRemove) {
      solution.edits.push_back({RecordEdit::Kind::kRemove, step++, {}});
    } else if (at->action == kTake) {
      if (node.penalty >= kDoubt) solution.doubtful.push_back(step);
      ++step;
    } else if (at->action == kRemoveClass) {
      solution.edits.push_back({RecordEdit::Kind::kRemoveClass, step, {}});
      step += EndOfClass(step);
    } else if (at->action == kSwap) {
      solution.edits.push_back({RecordEdit::Kind::kSwap, step, {}});
      step += 2;
    } else if (at->action <= kForms) {
      const LayoutMember& form = steps_[step].forms[static_cast<std::size_t>(kForms - at->action)].member;
      solution.edits.push_back({RecordEdit::Kind::kForm, step++, form.type, form.name});
    } else {
      solution.edits.push_back({RecordEdit::Kind::kInsert, step, shapes_[static_cast<std::size_t>(at->action)].type});
    }
    solution.cost = std::max(solution.cost, node.cost);
  }
  return solution;
}

}  // namespace slamdb::layouts
