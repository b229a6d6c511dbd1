// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "slamdb/formats/layouts/detail/cpp_index.h"

// C++ types as the words of a layout.
namespace slamdb::layouts {

// What was not understood.
inline constexpr std::string_view kUnknownType = "?";

class CppTypes {
 public:
  explicit CppTypes(const CppIndex& index) : index_(index) {}

  // `vec<ptr<KeyFrame>>` of `std::vector<KeyFrame*>` in a class; kUnknownType when it is not known.
  std::string WordOf(std::span<const CppToken> type, std::string_view in_class) const;
  // `f32`, 9 of `Eigen::Matrix3f`; of a diagonal matrix those on its diagonal. Count 0: it is none of fixed size.
  struct Array {
    std::string scalar;
    std::size_t count = 0;
  };
  Array ArrayOf(std::span<const CppToken> type, std::string_view in_class) const;
  // The last word of a type's name: `Map` of `ORB_SLAM3::Map*`.
  static std::string NameOf(std::span<const CppToken> type);
  // What a type's other name stands for; the type itself where it has none.
  std::span<const CppToken> Resolved(std::span<const CppToken> type, std::string_view in_class) const;

 private:
  std::string WordOf(std::span<const CppToken> type, std::string_view in_class, int depth) const;
  std::string Template(std::string_view name, std::span<const CppToken> arguments, std::string_view in_class,
                       int depth) const;

  const CppIndex& index_;
};

// `KeyFrame::mnId` as tokens.
std::span<const CppToken> WithoutQualifiers(std::span<const CppToken> type);

}  // namespace slamdb::layouts
