// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

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

// A pose or position as v1.0 has it.
struct Placed {
  std::array<float, 4> turn{};  // of a pose
  std::array<float, 3> place{};
};

// Of damaged records it may be none.
double Distance(const Placed& a, const Placed& b) {
  const double distance = std::hypot(a.place[0] - b.place[0], a.place[1] - b.place[1], a.place[2] - b.place[2]);
  return std::isfinite(distance) ? distance : std::numeric_limits<double>::max();
}
// From 0 to 1, of unit quaternions, of which two are one rotation.
double Alignment(const Placed& a, const Placed& b) {
  return std::abs(std::inner_product(a.turn.begin(), a.turn.end(), b.turn.begin(), 0.0));
}
// But for what is lost where one is written in another form.
bool IsSame(const Placed& a, const Placed& b) {
  constexpr double kLost = 1e-5;
  const float sign = std::inner_product(a.turn.begin(), a.turn.end(), b.turn.begin(), 0.0F) < 0 ? -1.0F : 1.0F;
  for (std::size_t i = 0; i < a.turn.size(); ++i)
    if (!(std::abs(a.turn[i] - sign * b.turn[i]) < kLost)) return false;
  return Distance(a, b) < kLost * (1 + std::hypot(a.place[0], a.place[1], a.place[2]));
}

double Median(std::vector<double>& of) {
  if (of.empty()) return 0;
  const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
  std::ranges::nth_element(of, middle);
  return *middle;
}

// Looks for the bytes of unknown members that are like another one of one class, in any of its forms: what is called
// that member may be its look-alike in another one, as world_from_camera.
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
    for (const LayoutMember& form : AllForms(NameOf(of_.members[row_].name), *own_))
      if (FixedBytes(ParseLayoutType(form.type)) > 0) forms_.emplace_back(class_name, form);
    bytes_ = FixedBytes(ParseLayoutType(of_.members[row_].type));
    if (bytes_ > 0) Walk(records);
  }

  std::vector<ClassOption> Options() const {
    std::vector<ClassOption> options;
    if (starts_.size() < 2) return options;
    const std::vector<KnownReading> known = Known();
    for (std::size_t row = 0; row < of_.members.size(); ++row) {
      const LayoutType type = ParseLayoutType(of_.members[row].type);
      if (!IsUnknown(of_.members[row]) || type.kind != LayoutType::Kind::kArray) continue;
      const std::uint64_t size = FixedBytes(type);
      for (std::uint64_t at = 0; at < std::min(size, kMostBytes); ++at)
        for (const Form& form : forms_)
          if (at + form.bytes <= size && IsLike(row, at, form, known)) options.push_back(With(row, at, size, form));
    }
    return options;
  }

 private:
  struct Form {
    Form(std::string_view class_name, const LayoutMember& of)
        : member(of), type(ParseLayoutType(of.type)), bytes(FixedBytes(type)), check(class_name, of) {}
    LayoutMember member;
    LayoutType type;
    std::uint64_t bytes;
    CheckedMember check;
  };
  using Reading = std::vector<Placed>;  // by record
  struct KnownReading {
    std::string_view form;
    Reading reading;
  };

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

  // What the member is in each form of as many bytes; first in the one that it is called.
  std::vector<KnownReading> Known() const {
    std::vector<KnownReading> known;
    for (const Form& form : forms_) {
      if (form.bytes != bytes_ || !CanBe(row_, 0, form, starts_.size())) continue;
      const bool is_called = form.member == of_.members[row_];
      known.insert(is_called ? known.begin() : known.end(), {FormOf(form.member.name), ReadingOf(row_, 0, form)});
    }
    return known;
  }
  // Whether the first records have nothing against it.
  bool CanBe(std::size_t row, std::uint64_t offset, const Form& form, std::size_t records) const {
    constexpr int kMostUnlike = 10;
    std::vector<MemberPlace> places;
    for (std::size_t i = 0; i < records; ++i) {
      const std::uint64_t at = starts_[i][row] + offset;
      places.push_back({at, at + form.bytes});
    }
    std::vector<RecordFacts> facts(places.size());
    return form.check.Penalty(archive_.file, places, facts) <= kMostUnlike;
  }
  // Whether bytes can be the member in nearly all records, and its places are nearer to them than to each other. A copy
  // that is the same everywhere is as good as the member.
  bool IsLike(std::size_t row, std::uint64_t offset, const Form& form, const std::vector<KnownReading>& known) const {
    if (known.empty() || !CanBe(row, offset, form, 1) || !CanBe(row, offset, form, starts_.size())) return false;
    const Reading reading = ReadingOf(row, offset, form);
    if (std::ranges::equal(reading, known.front().reading, IsSame)) return false;
    return std::ranges::any_of(known, [&](const KnownReading& of) {
      const bool both_wrong = &of != &known.front() && of.form == FormOf(form.member.name);
      return !both_wrong && IsNear(reading, of.reading);
    });
  }
  static bool IsNear(const Reading& reading, const Reading& known) {
    constexpr double kTurned = 0.1;  // by a form that is not theirs
    std::vector<double> apart, moved, turned;
    for (std::size_t i = 0; i < known.size(); ++i) {
      apart.push_back(Distance(known[i], reading[i]));
      turned.push_back(1 - Alignment(known[i], reading[i]));
      if (i > 0) moved.push_back(Distance(known[i], known[i - 1]));
    }
    const bool is_pose = known.front().turn != std::array<float, 4>{};
    return Median(apart) < Median(moved) / 2 && (!is_pose || Median(turned) < kTurned);
  }
  Reading ReadingOf(std::size_t row, std::uint64_t offset, const Form& form) const {
    Reading reading;
    for (const std::vector<std::uint64_t>& starts : starts_) {
      const std::string own = AsOwn(FormOf(form.member.name), form.type, *own_, archive_.file, starts[row] + offset);
      Placed& placed = reading.emplace_back();
      if (own.size() >= sizeof(placed.place))
        std::memcpy(placed.place.data(), own.data() + own.size() - sizeof(placed.place), sizeof(placed.place));
      if (own.size() >= sizeof(placed)) std::memcpy(placed.turn.data(), own.data(), sizeof(placed.turn));
    }
    return reading;
  }

  // The member in the middle of the unknown bytes, and unknown bytes in its place.
  ClassOption With(std::size_t row, std::uint64_t offset, std::uint64_t size, const Form& form) const {
    ClassOption with = option_;
    std::vector<LayoutMember>& members = with.layout.Find(of_.name)->members;
    const LayoutMember unknown = members[row], known = members[row_];
    const auto bytes = [](std::uint64_t count) { return Concat("arr<u8,", count, ">"); };
    members[row_] = {unknown.name, bytes(bytes_)};
    std::vector<LayoutMember> parts;
    if (offset > 0) parts.push_back({Concat(unknown.name, "_front"), bytes(offset)});
    parts.push_back(form.member);
    const std::uint64_t back = size - offset - form.bytes;
    if (back > 0) parts.push_back({Concat(unknown.name, "_back"), bytes(back)});
    const auto at = members.erase(members.begin() + static_cast<std::ptrdiff_t>(row));
    members.insert(at, parts.begin(), parts.end());
    Tell(unknown.name, form.member.name, members, with.findings.differences);
    TellForm(known, form.member, with.findings.differences);
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

  // As v1.0 has it is not worth telling.
  void TellForm(const LayoutMember& known, const LayoutMember& form, std::vector<std::string>& differences) const {
    const auto text = [&](const LayoutMember& member) {
      return Concat(of_.name, ": ", member.type, " ", member.name, " for ", NameOf(member.name));
    };
    if (known == form) return;
    std::erase(differences, text(known));
    if (form.name != NameOf(form.name) || form.type != ToString(*own_)) differences.push_back(text(form));
  }

  const ArchiveBytes& archive_;
  const ClassOption& option_;
  const LayoutClass& of_;
  const std::size_t row_;  // of the member that is known
  const LayoutType* own_ = nullptr;
  std::vector<Form> forms_;  // that it may have
  std::uint64_t bytes_ = 0;
  std::vector<std::vector<std::uint64_t>> starts_;  // by record, of its members
};

}  // namespace

std::vector<ClassOption> LookAlikesOf(const ArchiveBytes& archive, const ClassOption& option,
                                      std::string_view class_name, std::span<const MemberPlace> records) {
  return LookAlikes(archive, option, class_name, records).Options();
}

}  // namespace slamdb::layouts
