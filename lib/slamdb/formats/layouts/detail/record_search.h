// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <queue>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "slamdb/formats/layouts/detail/member_checks.h"
#include "slamdb/formats/layouts/detail/wire_walk.h"

// Finds how the records of a class differ from a known layout: the cheapest way to read several of them from end to
// end, where a member that is missing or one that is more costs, and so does one whose bytes are not like it.
namespace slamdb::layouts {

// A form in which a fork may have written a member.
struct StepForm {
  LayoutMember member;
  std::uint32_t type = 0;   // row
  int rank = 0;             // the likeliest is 0
  bool same_bytes = false;  // as many as its own form has
  CheckedMember check;
};

// A member of the class, or of one that it holds by value.
struct SearchStep {
  std::string of_class, name;
  std::uint32_t type = 0;  // row
  CheckedMember check;
  std::vector<StepForm> forms = {};  // but its own
};

// The members of a class in order, those of Preintegrated and Calib among them.
std::vector<SearchStep> StepsOf(const Layout& layout, const Wire& wire, std::string_view class_name);

// What a fork may have put in.
struct InsertShape {
  std::string type;  // a word of a layout; the bytes where all its classes have been met
  std::uint32_t row = 0;
  int cost = 0;
  bool raw = false;       // bytes of a fixed number
  bool has_head = false;  // that tells what it is
};

struct RecordEdit {
  // kRemoveClass: all steps of the class that begins with it; kForm: it is of another form; kSwap: it stands behind the
  // next one.
  enum class Kind : std::uint8_t { kInsert, kRemove, kRemoveClass, kForm, kSwap } kind = Kind::kInsert;
  std::uint32_t step = 0;  // in front of it; the one that is removed, or changed
  std::string type;        // kInsert, kForm
  std::string name = {};   // kForm

  friend bool operator==(const RecordEdit&, const RecordEdit&) = default;
  friend auto operator<=>(const RecordEdit&, const RecordEdit&) = default;
};

struct RecordSolution {
  int cost = 0;
  std::vector<RecordEdit> edits;        // by step
  std::vector<std::uint32_t> doubtful;  // steps whose bytes are not like the member
  friend bool operator==(const RecordSolution&, const RecordSolution&) = default;
};

class RecordSearch {
 public:
  static constexpr std::size_t kMostNodes = 120'000;

  // Adds the types of what may be inserted to the wire.
  RecordSearch(Wire& wire, std::string_view file, const ArchiveEncoding& encoding, std::vector<SearchStep> steps);

  // All solutions that are as good as the best one, in a fixed order; empty when there is none within the tries.
  // `thorough`: and those that are not much worse; a member that is not like itself costs as much as one that is more.
  std::vector<RecordSolution> Run(std::span<const MemberPlace> samples, bool thorough,
                                  std::size_t most_nodes = kMostNodes);
  const std::vector<SearchStep>& steps() const { return steps_; }

 private:
  enum class Last : std::uint8_t { kTake, kRemove, kRaw, kInsert, kForm };
  // Actions; kTiers, kForms: and those below, for each tier of sizes and each form; else the row of a shape.
  static constexpr std::int32_t kTake = -1, kRemove = -2, kSwap = -3, kRemoveClass = -4, kTiers = -5, kForms = -16;
  struct Node {
    std::int32_t parent = -1, action = kTake;
    std::uint32_t step = 0;
    int cost = 0, penalty = 0;
    Last last = Last::kTake;
    std::uint8_t inserts = 0;  // in this gap
    bool formed = false;       // a member in front is of another form
  };
  struct Entry {
    int cost = 0;
    std::uint64_t order = 0;
    std::int32_t node = 0, action = 0;  // `kTake`: the node is there
    bool operator>(const Entry& other) const { return cost != other.cost ? cost > other.cost : order > other.order; }
  };
  struct Alternative {
    std::int32_t parent = 0, action = 0;
  };

  void Search(std::span<const MemberPlace> samples);
  void MakeShapes();
  void MakeForms();
  void AddShape(std::string type, int cost, bool raw);
  void Push(int cost, std::int32_t node, std::int32_t action);
  void Expand(std::int32_t node);
  bool TakeStep(std::int32_t node);
  static int CostOf(const Node& node, const StepForm& form);
  void TakeForm(std::int32_t node, std::size_t form, int cost);
  void TakeSwapped(std::int32_t node, int cost);
  void StayAt(std::int32_t node);
  std::optional<int> Pass(std::uint32_t type, const CheckedMember& check);
  void RemoveSteps(std::int32_t node, std::uint32_t count, int cost, std::int32_t action);
  std::uint32_t EndOfClass(std::uint32_t step) const;
  void Insert(std::int32_t node, std::size_t shape, int cost);
  void Tier(std::int32_t node, int tier, int cost);
  bool FitsBehind(std::int32_t node, std::uint64_t bytes);
  void Settle(const Node& node);
  bool IsBehindHope(const Node& node) const;
  std::uint64_t Behind(std::uint32_t type, std::size_t sample, std::uint64_t at);
  std::vector<RecordSolution> Solutions() const;
  RecordSolution SolutionOf(const std::vector<Alternative>& way) const;

  Wire& wire_;
  const std::string_view file_;
  const ArchiveEncoding encoding_;
  std::vector<SearchStep> steps_;
  std::vector<InsertShape> shapes_;
  std::vector<MemberPlace> samples_;
  std::vector<Node> nodes_;
  std::vector<std::uint64_t> cursors_;  // a row of samples for each node
  std::vector<RecordFacts> facts_;
  std::vector<std::vector<Alternative>> others_;  // ways to a node that cost as much
  std::vector<std::uint64_t> next_cursors_;
  std::vector<RecordFacts> next_facts_;
  std::unordered_map<std::uint64_t, std::vector<std::int32_t>> known_;  // nodes by the hash of what they are
  std::unordered_map<std::uint64_t, std::uint64_t> behind_;             // where long values end
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::vector<int> anchored_;  // by step: the least cost behind that anchor
  std::vector<std::int32_t> goals_;
  std::uint64_t order_ = 0;
  int slack_ = 0;
  std::size_t most_nodes_ = kMostNodes;
  bool thorough_ = false;
};

}  // namespace slamdb::layouts
