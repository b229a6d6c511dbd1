// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/text_iarchive.hpp>
#include <boost/archive/text_oarchive.hpp>
#include <sstream>
#include <string>

// Stock Boost archives in memory.
namespace slamdb::testing {

struct Binary {
  static constexpr bool kText = false;
  using Output = boost::archive::binary_oarchive;
  using Input = boost::archive::binary_iarchive;
};
struct Text {
  static constexpr bool kText = true;
  using Output = boost::archive::text_oarchive;
  using Input = boost::archive::text_iarchive;
};
using Kinds = ::testing::Types<Binary, Text>;

template <class Kind, class... Values>
std::string Saved(const Values&... values) {
  std::ostringstream stream;
  {
    typename Kind::Output archive(stream);
    (archive << ... << values);
  }
  return stream.str();
}

template <class Kind, class... Values>
void Load(const std::string& bytes, Values&... values) {
  std::istringstream stream(bytes);
  typename Kind::Input archive(stream);
  (archive >> ... >> values);
}

template <class Value, class Kind>
Value Loaded(const std::string& bytes) {
  Value value{};
  Load<Kind>(bytes, value);
  return value;
}

inline unsigned int BoostVersion() {
  const auto version = boost::archive::BOOST_ARCHIVE_VERSION();
  return version;
}

}  // namespace slamdb::testing
