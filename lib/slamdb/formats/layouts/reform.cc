// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/inference.h"
#include "slamdb/formats/layouts/detail/member_forms.h"

namespace slamdb::layouts {
namespace {

using detail::Concat;

constexpr int kMostRounds = 3;
constexpr double kEnough = 8;  // less does not make another reading likelier

struct Change {
  Layout layout;
  std::string text;
};

constexpr std::array kPoses = {"mTcw", "mTcp", "mTlr", "mTcb", "mTbc"};

// All poses, since whoever writes one in a form writes each so.
void AddPoses(const Layout& layout, std::vector<Change>& changes) {
  for (const char* form : {"xyzw", "inverse", "inverse.xyzw", "columns", "rows", "inverse.columns", "inverse.rows"}) {
    Change change{layout, {}};
    for (const char* name : {"KeyFrame", "Calib"}) {
      LayoutClass* of = change.layout.Find(name);
      if (of == nullptr) continue;
      for (LayoutMember& member : of->members) {
        const LayoutType* own = OwnTypeOf(name, NameOf(member.name));
        const bool is_pose = std::ranges::find(kPoses, NameOf(member.name)) != kPoses.end();
        if (!is_pose || own == nullptr || !IsForm(form, ParseLayoutType(member.type), *own)) continue;
        member.name = Concat(NameOf(member.name), ".", form);
        const bool first = change.text.find(Concat(name, ": ")) == std::string::npos;
        change.text += Concat(change.text.empty() ? ""
                              : first             ? "; "
                                                  : ", ",
                              first ? Concat(name, ": ") : "", member.name);
      }
    }
    if (change.text.empty()) continue;
    changes.push_back(std::move(change));
  }
}

void AddForms(const Layout& layout, const LayoutClass& of, std::size_t row, std::vector<Change>& changes) {
  const LayoutMember& member = of.members[row];
  const LayoutType* own = OwnTypeOf(of.name, NameOf(member.name));
  if (own == nullptr) return;
  const std::uint64_t bytes = FixedBytes(ParseLayoutType(member.type));
  for (const LayoutMember& form : AllForms(NameOf(member.name), *own)) {
    if (form == member || bytes == 0 || FixedBytes(ParseLayoutType(form.type)) != bytes) continue;
    Change change{layout, Concat(of.name, ": ", form.type, " ", form.name, " for ", member.name)};
    change.layout.Find(of.name)->members[row] = form;
    changes.push_back(std::move(change));
  }
}

void AddSwap(const Layout& layout, const LayoutClass& of, std::size_t row, std::vector<Change>& changes) {
  if (row + 1 == of.members.size()) return;
  const LayoutMember &member = of.members[row], &next = of.members[row + 1];
  if (!CheckedMember(of.name, member).known() || !CheckedMember(of.name, next).known()) return;
  if (FixedBytes(ParseLayoutType(member.type)) == 0 || FixedBytes(ParseLayoutType(next.type)) == 0) return;
  Change change{layout, Concat(of.name, ": ", next.name, " in front of ", member.name)};
  LayoutClass& changed = *change.layout.Find(of.name);
  std::swap(changed.members[row], changed.members[row + 1]);
  changes.push_back(std::move(change));
}

std::vector<Change> ChangesOf(const Layout& layout) {
  std::vector<Change> changes;
  AddPoses(layout, changes);
  for (const char* name : {"KeyFrame", "MapPoint"}) {
    const LayoutClass* of = layout.Find(name);
    for (std::size_t row = 0; of != nullptr && row < of->members.size(); ++row) {
      AddForms(layout, *of, row, changes);
      AddSwap(layout, *of, row, changes);
    }
  }
  return changes;
}

}  // namespace

void Reform(const MeaningJudge& judge, Layout& layout, Meaning& meaning, std::vector<std::string>& differences) {
  for (int round = 0; round < kMostRounds && !meaning.doubts.empty(); ++round) {
    Change best;
    Meaning of_best{.penalty = meaning.penalty - kEnough, .doubts = {}};
    for (Change& change : ChangesOf(layout)) {
      Meaning changed = judge(change.layout);
      if (changed.penalty >= of_best.penalty) continue;
      of_best = std::move(changed);
      best = std::move(change);
    }
    if (best.text.empty()) return;
    layout = std::move(best.layout);
    meaning = std::move(of_best);
    differences.push_back(std::move(best.text));
  }
}

}  // namespace slamdb::layouts
