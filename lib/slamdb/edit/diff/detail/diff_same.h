// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "slamdb/model/fields.h"

namespace slamdb::detail {

// Whether values mean the same: numbers within a tolerance, NaNs whatever their bits, quaternions up to their sign.
class Sameness {
 public:
  explicit Sameness(double tolerance) : tolerance_(tolerance) {}

  bool operator()(double a, double b) const {
    if (a == b || (std::isnan(a) && std::isnan(b))) return true;
    return tolerance_ > 0 && std::abs(a - b) <= tolerance_ * std::max({1.0, std::abs(a), std::abs(b)});
  }
  bool operator()(float a, float b) const { return (*this)(static_cast<double>(a), static_cast<double>(b)); }

  template <int kRows, int kColumns>
  bool operator()(const Eigen::Matrix<float, kRows, kColumns>& a,
                  const Eigen::Matrix<float, kRows, kColumns>& b) const {
    return AllSame(a.data(), b.data(), static_cast<std::size_t>(a.size()));
  }

  bool operator()(const Quaternionf& a, const Quaternionf& b) const {
    const Eigen::Vector4f first = a.coeffs(), second = b.coeffs();
    return (*this)(first, second) || (*this)(first, Eigen::Vector4f(-second));
  }
  bool operator()(const Rigid3f& a, const Rigid3f& b) const {
    return (*this)(a.rotation, b.rotation) && (*this)(a.translation, b.translation);
  }
  bool operator()(const Keypoint& a, const Keypoint& b) const {
    return (*this)(a.x, b.x) && (*this)(a.y, b.y) && (*this)(a.angle, b.angle) && (*this)(a.size, b.size) &&
           (*this)(a.response, b.response) && a.class_id == b.class_id && a.octave == b.octave;
  }
  bool operator()(const ImuMeasurement& a, const ImuMeasurement& b) const {
    return (*this)(a.acceleration, b.acceleration) && (*this)(a.angular_velocity, b.angular_velocity) &&
           (*this)(a.duration, b.duration);
  }
  template <class T, class Allocator>
  bool operator()(const std::vector<T, Allocator>& a, const std::vector<T, Allocator>& b) const {
    return a.size() == b.size() && AllSame(a.data(), b.data(), a.size());
  }

  // What is the same only when it is equal: counts, ids, flags, descriptors.
  template <class T>
  requires(!std::is_floating_point_v<T>) bool operator()(const T& a, const T& b) const { return a == b; }

  // Whether the fields of two entities are the same, of those that `walk` (fields.h) visits and whose types are not
  // among Ignored.
  template <class... Ignored, class Entity, class Walk>
  bool Fields(const Entity& a, const Entity& b, const Walk& walk) const {
    bool same = true;
    walk([&](std::string_view, auto... members) {
      using Field = std::remove_cvref_t<decltype(Member(a, members...))>;
      constexpr bool kIgnored = (std::is_same_v<Field, Ignored> || ...);
      if constexpr (!kIgnored) same = same && (*this)(Member(a, members...), Member(b, members...));
    });
    return same;
  }

 private:
  // Most of what is compared is equal to the last bit. The elements hold nothing but numbers, without padding.
  template <class T>
  bool AllSame(const T* a, const T* b, std::size_t count) const {
    if (count == 0 || std::memcmp(static_cast<const void*>(a), static_cast<const void*>(b), count * sizeof(T)) == 0)
      return true;
    for (std::size_t i = 0; i < count; ++i)
      if (!(*this)(a[i], b[i])) return false;
    return true;
  }

  double tolerance_;
};

}  // namespace slamdb::detail
