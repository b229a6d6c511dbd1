// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/inference.h"
#include "slamdb/formats/layouts/detail/member_forms.h"

namespace slamdb::layouts {
namespace {

using detail::Concat;

constexpr std::size_t kMostRecords = 50;
constexpr std::uint64_t kMostBytes = 512;  // of unknown ones that are looked through

// Poses and positions, whose last three numbers are a place.
bool IsPlace(const LayoutMember& member) { return NameOf(member.name) == "mTcw" || NameOf(member.name) == "mWorldPos"; }

// Looks for the bytes of unknown members that are like another one of one class.
class LookAlikes {
 public:
  LookAlikes(const ArchiveBytes& archive, const ClassOption& option, std::string_view class_name,
             std::span<const MemberPlace> records)
      : archive_(archive),
        option_(option),
        of_(*option.layout.Find(class_name)),
        row_(static_cast<std::size_t>(std::ranges::find_if(of_.members, IsPlace) - of_.members.begin())) {
    if (row_ < of_.members.size()) own_ = OwnTypeOf(class_name, NameOf(of_.members[row_].name));
    if (own_ == nullptr) return;
    type_ = ParseLayoutType(of_.members[row_].type);
    bytes_ = FixedBytes(type_);
    if (bytes_ > 0) Walk(records);
  }

  std::vector<ClassOption> Options() const {
    std::vector<ClassOption> options;
    for (std::size_t row = 0; row < of_.members.size() && starts_.size() > 1; ++row) {
      const LayoutType type = ParseLayoutType(of_.members[row].type);
      if (!IsUnknown(of_.members[row]) || type.kind != LayoutType::Kind::kArray) continue;
      const std::uint64_t size = FixedBytes(type);
      for (std::uint64_t at = 0; at + bytes_ <= std::min(size, kMostBytes); ++at)
        if (IsLike(row, at)) options.push_back(With(row, at, size));
    }
    return options;
  }

 private:
  // Where the members of records stand.
  void Walk(std::span<const MemberPlace> records) {
    const Wire wire(option_.layout, archive_.encoding);
    const WarmWalk walk(wire, archive_.file, archive_.encoding);
    const WireClass& wire_class = wire.classes[static_cast<std::size_t>(wire.RowOf(of_.name))];
    for (std::size_t i = 0; i < records.size(); i += records.size() / kMostRecords + 1) {
      std::vector<std::uint64_t> starts;
      std::uint64_t at = records[i].begin;
      for (const WireMember& member : wire_class.members) {
        starts.push_back(at);
        if (at != kNowhere) at = walk.Behind(member.type, at);
      }
      if (at == records[i].end) starts_.push_back(std::move(starts));
    }
  }

  // Whether bytes can be the member in nearly all records, and its places are nearer to them than to each other. A copy
  // that is the same everywhere is as good as the member.
  bool IsLike(std::size_t row, std::uint64_t offset) const {
    constexpr int kMostUnlike = 10;
    const auto is_same = [&](const std::vector<std::uint64_t>& starts) {
      return archive_.file.substr(starts[row_], bytes_) == archive_.file.substr(starts[row] + offset, bytes_);
    };
    if (std::ranges::all_of(starts_, is_same)) return false;
    std::vector<MemberPlace> places;
    std::vector<double> apart, moved;
    for (std::size_t i = 0; i < starts_.size(); ++i) {
      const std::vector<std::uint64_t>& starts = starts_[i];
      const std::uint64_t at = starts[row] + offset;
      places.push_back({at, at + bytes_});
      apart.push_back(Distance(PlaceAt(starts[row_]), PlaceAt(at)));
      if (i > 0) moved.push_back(Distance(PlaceAt(starts[row_]), PlaceAt(starts_[i - 1][row_])));
    }
    std::vector<RecordFacts> facts(places.size());
    const CheckedMember check(of_.name, of_.members[row_]);
    return check.Penalty(archive_.file, places, facts) <= kMostUnlike && Median(apart) < Median(moved) / 2;
  }
  // The last three numbers.
  std::array<double, 3> PlaceAt(std::uint64_t at) const {
    const std::string own = AsOwn(FormOf(of_.members[row_].name), type_, *own_, archive_.file, at);
    std::array<float, 3> place{};
    if (own.size() >= sizeof(place)) std::memcpy(place.data(), own.data() + own.size() - sizeof(place), sizeof(place));
    return {place[0], place[1], place[2]};
  }
  // Of damaged records it may be none.
  static double Distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    const double distance = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    return std::isfinite(distance) ? distance : std::numeric_limits<double>::max();
  }
  static double Median(std::vector<double>& of) {
    if (of.empty()) return 0;
    const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
    std::ranges::nth_element(of, middle);
    return *middle;
  }

  // The member in the middle of the unknown bytes, and unknown bytes in its place.
  ClassOption With(std::size_t row, std::uint64_t offset, std::uint64_t size) const {
    ClassOption with = option_;
    std::vector<LayoutMember>& members = with.layout.Find(of_.name)->members;
    const LayoutMember unknown = members[row], known = members[row_];
    const auto bytes = [](std::uint64_t count) { return Concat("arr<u8,", count, ">"); };
    members[row_] = {unknown.name, bytes(bytes_)};
    std::vector<LayoutMember> parts;
    if (offset > 0) parts.push_back({Concat(unknown.name, "_front"), bytes(offset)});
    parts.push_back(known);
    if (offset + bytes_ < size) parts.push_back({Concat(unknown.name, "_back"), bytes(size - offset - bytes_)});
    const auto at = members.erase(members.begin() + static_cast<std::ptrdiff_t>(row));
    members.insert(at, parts.begin(), parts.end());
    Tell(unknown.name, known.name, members, with.findings.differences);
    return with;
  }

  // What was said of the unknown bytes says where they, and the member, stand now.
  void Tell(const std::string& unknown, const std::string& known, const std::vector<LayoutMember>& members,
            std::vector<std::string>& differences) const {
    std::erase_if(differences,
                  [&](const std::string& text) { return text.starts_with(Concat(of_.name, ": ", unknown, ", ")); });
    std::string front, in_front_of_known;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const LayoutMember& member = members[i];
      if (member.name == known) in_front_of_known = front;
      if (!IsUnknown(member)) front = member.name;
      if (member.name != unknown && !member.name.starts_with(unknown + "_")) continue;
      const auto back =
          std::ranges::find_if_not(members.begin() + static_cast<std::ptrdiff_t>(i), members.end(), IsUnknown);
      differences.push_back(
          InsertionText(of_.name, member.name, member.type, front, back == members.end() ? "" : back->name));
    }
    const auto was =
        std::find_if_not(of_.members.rend() - static_cast<std::ptrdiff_t>(row_), of_.members.rend(), IsUnknown);
    if (in_front_of_known != (was == of_.members.rend() ? "" : was->name))
      differences.push_back(Concat(of_.name, ": ", known, " behind ", in_front_of_known));
  }

  const ArchiveBytes& archive_;
  const ClassOption& option_;
  const LayoutClass& of_;
  const std::size_t row_;  // of the member that is known
  const LayoutType* own_ = nullptr;
  LayoutType type_;
  std::uint64_t bytes_ = 0;
  std::vector<std::vector<std::uint64_t>> starts_;  // by record, of its members
};

}  // namespace

std::vector<ClassOption> LookAlikesOf(const ArchiveBytes& archive, const ClassOption& option,
                                      std::string_view class_name, std::span<const MemberPlace> records) {
  return LookAlikes(archive, option, class_name, records).Options();
}

}  // namespace slamdb::layouts
