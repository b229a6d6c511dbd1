// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <optional>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/decoder.h"
#include "slamdb/formats/orbslam3/detail/layout.h"
#include "slamdb/formats/orbslam3/detail/pointers.h"
#include "slamdb/formats/orbslam3/detail/skipper.h"

namespace slamdb::orbslam3 {

inline constexpr std::initializer_list<WireClass> kCameraClasses{WireClass::kPinhole, WireClass::kKannalaBrandt8};

// The cursor of a decoder, for a look that notes nothing.
template <class Input>
Input Silent(const Decoder<Input>& at) {
  Input input = at.input;
  input.Tolerate(nullptr);
  return input;
}

// Why what must follow does not stand at the cursor, null where it does; the cursor stays.
template <class Input>
class Lookahead {
 public:
  Lookahead(const Decoder<Input>& at, const ObjectTable& objects) : at_(at), objects_(objects) {}

  std::optional<Error> WhyNoPointer(std::initializer_list<WireClass> classes) const {
    return WhyNot([&](auto& skipper) { TakePointer(skipper, objects_, classes); });
  }
  std::optional<Error> WhyNoList(WireClass list_class, std::initializer_list<WireClass> classes) const {
    return WhyNot([&](auto& skipper) { PassListBegin(skipper, list_class, classes); });
  }
  std::optional<Error> WhyNoMapTail() const {
    return WhyNot([this](auto& skipper) { PassMapTail(skipper); });
  }
  std::optional<Error> WhyNoCounters() const {
    return WhyNot([](auto& skipper) { PassCounters(skipper); });
  }

 private:
  // Zeros look like an empty list, so what follows one must stand too.
  void PassListBegin(Skipper<Input>& skipper, WireClass list_class, std::initializer_list<WireClass> classes) const {
    if (skipper.ClassCount(list_class, 2, 1) > 0)
      TakePointer(skipper, objects_, classes);
    else if (list_class == WireClass::kMapPointList)
      PassMapTail(skipper);
    else if (list_class == WireClass::kCameraList)
      PassCounters(skipper);
  }

  // The members of a map behind its lists, and what must follow.
  void PassMapTail(Skipper<Input>& skipper) const {
    Map nothing;
    LayoutMapTail(skipper, nothing);
    Skipper<Input> cameras = skipper;
    try {
      PassListBegin(cameras, WireClass::kCameraList, kCameraClasses);
    } catch (const Error&) {
      TakePointer(skipper, objects_, {WireClass::kMap});
    }
  }

  static void PassCounters(Skipper<Input>& skipper) {
    Counters nothing;
    LayoutCounters(skipper, nothing);
    if (!skipper.input.AtEnd()) skipper.input.Fail("an empty list, and behind it not what must follow");
  }

  template <class Pass>
  std::optional<Error> WhyNot(const Pass& pass) const {
    try {
      Skipper<Input> skipper(Silent(at_), at_.classes);
      pass(skipper);
      return std::nullopt;
    } catch (const Error& error) {
      return error;
    }
  }

  const Decoder<Input>& at_;
  const ObjectTable& objects_;
};

}  // namespace slamdb::orbslam3
