// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/boost_reference/boost_reference.h"

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/text_iarchive.hpp>
#include <boost/archive/text_oarchive.hpp>
#include <fstream>

#include "slamdb/boost.h"

namespace slamdb::reference {
namespace {

template <class Archive>
Atlas LoadAs(std::istream& stream) {
  Archive archive(stream);
  Atlas atlas;
  archive >> atlas;
  return atlas;
}

template <class Archive>
void SaveAs(const Atlas& atlas, std::ostream& stream) {
  Archive archive(stream);
  archive << atlas;
}

}  // namespace

unsigned int ArchiveVersion() {
  const auto version = boost::archive::BOOST_ARCHIVE_VERSION();
  return version;
}

Atlas Load(const std::string& path, Encoding encoding) {
  std::ifstream stream(path, std::ios::binary);
  return encoding == Encoding::kText ? LoadAs<boost::archive::text_iarchive>(stream)
                                     : LoadAs<boost::archive::binary_iarchive>(stream);
}

void Save(const Atlas& atlas, const std::string& path, Encoding encoding) {
  std::ofstream stream(path, std::ios::binary);
  if (encoding == Encoding::kText) {
    SaveAs<boost::archive::text_oarchive>(atlas, stream);
  } else {
    SaveAs<boost::archive::binary_oarchive>(atlas, stream);
  }
}

}  // namespace slamdb::reference
