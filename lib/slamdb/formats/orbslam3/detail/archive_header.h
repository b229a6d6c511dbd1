// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "slamdb/base/detail/file_stream.h"
#include "slamdb/base/notices.h"
#include "slamdb/model/atlas.h"

namespace slamdb::orbslam3 {

inline constexpr std::uint32_t kOldestBoost = 10;  // library versions that this codec is tested with
inline constexpr std::uint32_t kNewestBoost = 20;

// Which kind of Boost archive `head` begins: true text, false binary, nullopt neither.
std::optional<bool> SniffArchive(std::string_view head);

struct ArchiveHeader {
  ArchiveEncoding encoding;
  std::size_t bytes = 0;  // its length
};

// Reads the header of a Boost archive. Warns of library versions above kNewestBoost. Throws Error for what is no
// archive, for versions that write other bytes, big-endian and exotic writers.
ArchiveHeader ReadArchiveHeader(detail::FileStream& file, Notices& notices);

// What an archive is like whose header is damaged: as ORB-SLAM3 writes it on 64-bit Linux, text when its middle is.
ArchiveHeader UsualArchiveHeader(std::string_view file);

// The header as Boost writes it.
std::string WriteArchiveHeader(const ArchiveEncoding& encoding);

}  // namespace slamdb::orbslam3
