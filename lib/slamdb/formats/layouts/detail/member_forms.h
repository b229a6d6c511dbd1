// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "slamdb/formats/layouts/layout.h"

// Members of ORB-SLAM3 as forks write them: in numbers of another width, poses in other conventions, times as
// whole numbers. What stands behind the first dot of a name says the form:
//   .xyzw         of a pose: the quaternion begins with x
//   .inverse      of a pose: world_from_camera
//   .rows         of a pose: a matrix, row after row; of a matrix: so
//   .columns      of a pose: a matrix, column after column
//   .nanoseconds  of a time, .microseconds and .milliseconds likewise; behind .seconds, what is more than those
//   .words .weights, .nodes .features  of bags of words: as two lists
namespace slamdb::layouts {

// Holds every integer of 64 bits and every double. Of lists the count stands in front.
using Numbers = std::vector<long double>;

inline std::string_view NameOf(std::string_view member) { return member.substr(0, member.find('.')); }
inline std::string_view FormOf(std::string_view member) {
  const std::size_t dot = member.find('.');
  return dot == std::string_view::npos ? std::string_view() : member.substr(dot + 1);
}

// The type that ORB-SLAM3 v1.0 has for a member; null when it has none of that name.
const LayoutType* OwnTypeOf(std::string_view of_class, std::string_view name);

// The forms of a member but its own, likeliest first.
std::vector<LayoutMember> OtherForms(std::string_view name, const LayoutType& own);

// And its own behind them.
std::vector<LayoutMember> AllForms(std::string_view name, const LayoutType& own);

// Whether a value of the type, in that form, says what one of the type `own` says.
bool IsForm(std::string_view form, const LayoutType& type, const LayoutType& own);

// Why a member's name says a form that there is none of, or in no such type; empty as a rule.
std::string FormProblem(const LayoutMember& member, const LayoutType& own);

// Whether both types have the same bytes, where longs have 8.
bool SameWidths(const LayoutType& a, const LayoutType& b);
// Of a number or an array of them, where longs have 8; 0 of anything else.
std::uint64_t FixedBytes(const LayoutType& type);

// From the form to what v1.0 has, and back to `count` numbers; empty when they are not of it. The form of a cv::Mat is
// `rows`.
Numbers ToOwn(std::string_view form, Numbers numbers);
Numbers FromOwn(std::string_view form, Numbers own, std::size_t count);

// The value at `at`, which ends within the bytes, as the bytes of the type `own`. Longs have 8 bytes.
std::string AsOwn(std::string_view form, const LayoutType& type, const LayoutType& own, std::string_view bytes,
                  std::uint64_t at);

// Calls use(T()) with the type that a number has, where longs have 8 bytes.
template <class Use>
void WithNumberType(LayoutType::Number number, const Use& use) {
  using N = LayoutType::Number;
  switch (number) {
    case N::kU8:
    case N::kBool:
      return use(std::uint8_t());
    case N::kI8:
      return use(std::int8_t());
    case N::kI16:
      return use(std::int16_t());
    case N::kU16:
      return use(std::uint16_t());
    case N::kI32:
      return use(std::int32_t());
    case N::kU32:
      return use(std::uint32_t());
    case N::kU64:
    case N::kULongLong:
    case N::kSize:
      return use(std::uint64_t());
    case N::kI64:
    case N::kLong:
      return use(std::int64_t());
    case N::kF32:
      return use(float());
    case N::kF64:
      return use(double());
  }
}

// Negative numbers wrap, so that -1 stays `none`; what does not fit 64 bits is 0.
template <class T>
T Narrowed(long double number) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(number);
  } else {
    if (!(number >= -9223372036854775808.0L && number < 18446744073709551616.0L)) return T{};
    return number < 0 ? static_cast<T>(static_cast<std::int64_t>(number))
                      : static_cast<T>(static_cast<std::uint64_t>(number));
  }
}

}  // namespace slamdb::layouts
