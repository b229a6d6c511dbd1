// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <vector>

#include "slamdb/formats/layouts/detail/member_checks.h"
#include "slamdb/formats/layouts/detail/member_forms.h"
#include "slamdb/formats/layouts/detail/wire_walk.h"

namespace slamdb::layouts {

CheckedMember::CheckedMember(std::string_view of_class, const LayoutMember& member) : form_(FormOf(member.name)) {
  own_ = OwnTypeOf(of_class, NameOf(member.name));
  if (own_ == nullptr) return;
  type_ = ParseLayoutType(member.type);
  is_own_ = form_.empty() && SameWidths(type_, *own_);
  if (is_own_ || IsForm(form_, type_, *own_)) known_ = FindKnownMember(of_class, NameOf(member.name));
}

int CheckedMember::Penalty(std::string_view file, std::span<const MemberPlace> places,
                           std::span<RecordFacts> facts) const {
  if (!known()) return kNoPenalty;
  if (is_own_) return PenaltyOf(*known_, file, places, facts);
  std::string own;
  std::vector<MemberPlace> own_places;
  for (const MemberPlace& place : places) {
    const std::string bytes = AsOwn(form_, type_, *own_, file.substr(0, place.end), place.begin);
    if (bytes.empty()) return kBadPenalty;
    own_places.push_back({own.size(), own.size() + bytes.size()});
    own += bytes;
  }
  return PenaltyOf(*known_, own, own_places, facts);
}

std::optional<std::int64_t> CheckedMember::Whole(std::string_view file, MemberPlace place) const {
  if (!known()) return std::nullopt;
  if (is_own_) return NumberAt<std::int64_t>(file, place.begin);
  return NumberAt<std::int64_t>(AsOwn(form_, type_, *own_, file.substr(0, place.end), place.begin), 0);
}

}  // namespace slamdb::layouts
