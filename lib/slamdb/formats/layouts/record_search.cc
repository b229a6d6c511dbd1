// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/record_search.h"

#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include "slamdb/base/detail/concat.h"

namespace slamdb::layouts {
namespace {

constexpr int kEdit = 100;                 // costs a member that is more or less,
constexpr int kNextRemoval = 35;           // one more that is missing behind it,
constexpr int kTie = 4;                    // and what is as good as the best
constexpr std::array kSlacks = {45, 160};  // where an anchor was passed, ways that cost more are given up
constexpr int kMostCost = 700;
constexpr int kDoubt = 45;
constexpr std::size_t kMostEntries = 4'000'000;
constexpr std::uint8_t kMostInsertsInGap = 3;
constexpr std::size_t kMostSolutions = 64;
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

std::vector<SearchStep> StepsOf(const Wire& wire, std::string_view class_name) {
  std::vector<SearchStep> steps;
  const std::int64_t row = wire.RowOf(class_name);
  if (row < 0) return steps;
  const auto add = [&](const WireClass& of, const WireMember& member) {
    steps.push_back({of.name, member.name, member.type, FindKnownMember(of.name, member.name)});
  };
  for (const WireMember& member : wire.classes[static_cast<std::size_t>(row)].members) {
    const WireType& type = wire.types[member.type];
    const bool flat = type.kind == WireType::Kind::kValue && (wire.classes[type.class_row].name == "Preintegrated" ||
                                                              wire.classes[type.class_row].name == "Calib");
    if (!flat) add(wire.classes[static_cast<std::size_t>(row)], member);
    if (flat)
      for (const WireMember& inner : wire.classes[type.class_row].members) add(wire.classes[type.class_row], inner);
  }
  return steps;
}

RecordSearch::RecordSearch(Wire& wire, std::string_view file, const ArchiveEncoding& encoding,
                           std::vector<SearchStep> steps)
    : wire_(wire), file_(file), encoding_(encoding), steps_(std::move(steps)) {
  MakeShapes();
}

// ---- What may be put in

void RecordSearch::AddShape(std::string type, int cost, bool raw) {
  const std::uint32_t row = wire_.Add(ParseLayoutType(type));
  shapes_.push_back({std::move(type), row, kEdit + cost, raw});
}

void RecordSearch::MakeShapes() {
  int cost = 0;
  for (const std::uint32_t size : kUsualSizes) AddShape(detail::Concat("arr<u8,", size, ">"), cost++ / 2, true);
  for (const char* type : {"vec<u32>", "vec<u64>", "vec<u8>", "vec<u16>"}) AddShape(type, 4, false);
  for (const char* type : {"mat", "kps"}) AddShape(type, 5, false);
  for (const int size : {12, 8, 4, 16, 28, 24, 36, 20, 32, 9, 5, 1, 2, 40, 48, 56, 64})
    AddShape(detail::Concat("vec<arr<u8,", size, ">>"), 7, false);
  for (const char* type :
       {"ptr<GeometricCamera>", "vec<vec<u64>>", "vec<vec<u32>>", "vec<vec<u8>>", "vec<string>", "map<u32,vec<u32>>",
        "map<u64,vec<u64>>", "map<u64,vec<u32>>", "map<u64,string>", "vec<vec<vec<u64>>>", "vec<mat>"})
    AddShape(type, 9, false);
}

// ---- The search

std::vector<RecordSolution> RecordSearch::Run(std::span<const MemberPlace> samples, std::size_t most_nodes) {
  most_nodes_ = most_nodes;
  for (const int slack : kSlacks) {
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
      if (!goals_.empty()) most = std::min(most, nodes_[static_cast<std::size_t>(goals_.front())].cost + kTie);
    } else if (entry.action == kRemove) {
      RemoveStep(entry.node, entry.cost);
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
  std::uint64_t hash = Mixed(node.step, static_cast<std::uint64_t>(node.last) * 8U + node.inserts);
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
    TakeStep(id);
    if (node.inserts == 0) Push(node.cost + (node.last == Last::kRemove ? kNextRemoval : kEdit), id, kRemove);
  }
  if (node.inserts >= kMostInsertsInGap) return;
  for (std::size_t shape = 0; shape < shapes_.size(); ++shape)
    if (!shapes_[shape].raw || node.last != Last::kRaw)
      Push(node.cost + shapes_[shape].cost, id, static_cast<std::int32_t>(shape));
  if (node.last == Last::kRaw) return;
  for (std::size_t tier = 0; tier < kTiersOfSizes.size(); ++tier)
    Push(node.cost + kTiersOfSizes[tier].cost, id, kTiers - static_cast<std::int32_t>(tier));
}

void RecordSearch::TakeStep(std::int32_t id) {
  const Node node = nodes_[static_cast<std::size_t>(id)];
  const std::size_t at = static_cast<std::size_t>(id) * samples_.size();
  const SearchStep& step = steps_[node.step];
  std::vector<MemberPlace> places(samples_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::uint64_t behind = Behind(step.type, i, cursors_[at + i]);
    if (behind == kNowhere) return;
    places[i] = {cursors_[at + i], behind};
    next_cursors_[i] = behind;
    next_facts_[i] = facts_[at + i];
  }
  const int penalty = step.known == nullptr ? 0 : PenaltyOf(*step.known, file_, places, next_facts_);
  Node next{.parent = id, .action = kTake, .step = node.step + 1, .cost = node.cost + penalty, .penalty = penalty};
  if (next.cost > kMostCost) return;
  if (step.known != nullptr && step.known->anchor && penalty == 0)
    anchored_[node.step] = std::min(anchored_[node.step], next.cost);
  Settle(next);
}

bool RecordSearch::RemoveStep(std::int32_t id, int cost) {
  const Node node = nodes_[static_cast<std::size_t>(id)];
  const std::size_t at = static_cast<std::size_t>(id) * samples_.size();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    next_cursors_[i] = cursors_[at + i];
    next_facts_[i] = facts_[at + i];
  }
  Settle({.parent = id, .action = kRemove, .step = node.step + 1, .cost = cost, .last = Last::kRemove});
  return true;
}

void RecordSearch::Insert(std::int32_t id, std::size_t shape_row, int cost) {
  const Node node = nodes_[static_cast<std::size_t>(id)];
  const std::size_t at = static_cast<std::size_t>(id) * samples_.size();
  const InsertShape shape = shapes_[shape_row];
  bool grows = shape.raw;  // what is empty everywhere is no list, but bytes
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const std::uint64_t behind = Behind(shape.row, i, cursors_[at + i]);
    if (behind == kNowhere) return;
    grows = grows || behind - cursors_[at + i] != Behind(shape.row, 0, cursors_[at]) - cursors_[at];
    next_cursors_[i] = behind;
    next_facts_[i] = facts_[at + i];
  }
  if (!grows && samples_.size() > 1) return;
  Settle({.parent = id,
          .action = static_cast<std::int32_t>(shape_row),
          .step = node.step,
          .cost = cost,
          .last = shape.raw ? Last::kRaw : Last::kInsert,
          .inserts = static_cast<std::uint8_t>(node.inserts + 1)});
}

// Unusual sizes are worth a node only where the next member fits behind them.
void RecordSearch::Tier(std::int32_t id, int tier, int cost) {
  const SizeTier& sizes = kTiersOfSizes[static_cast<std::size_t>(tier)];
  for (std::uint32_t size = sizes.first; size <= sizes.last; size += sizes.step) {
    if (std::ranges::find(kUsualSizes, size) != kUsualSizes.end() || !FitsBehind(id, size)) continue;
    const std::string type = detail::Concat("arr<u8,", size, ">");
    auto shape = std::ranges::find(shapes_, type, &InsertShape::type);
    if (shape == shapes_.end()) {
      shapes_.push_back({type, wire_.Add(ParseLayoutType(type)), kMostCost + 1, true});
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
  if (node.step == steps_.size() || steps_[node.step].known == nullptr) return true;
  return PenaltyOf(*steps_[node.step].known, file_, places, next_facts_) < kDoubt;
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
  while (!open.empty() && solutions.size() < kMostSolutions) {
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
    } else {
      solution.edits.push_back({RecordEdit::Kind::kInsert, step, shapes_[static_cast<std::size_t>(at->action)].type});
    }
    solution.cost = std::max(solution.cost, node.cost);
  }
  return solution;
}

}  // namespace slamdb::layouts
