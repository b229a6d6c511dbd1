// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/formats/osmap/detail/header.h"
#include "slamdb/formats/osmap/detail/osmap.h"

namespace slamdb {
namespace {

constexpr std::array<std::string_view, 1> kSuffixes{".yaml"};
constexpr Content kHeld = Content::kPoses | Content::kPoints | Content::kObservations | Content::kKeypoints |
                          Content::kDescriptors | Content::kGraph | Content::kCameras | Content::kIdentity |
                          Content::kTracking;

}  // namespace

const Format detail::kOsmapFormat{.id = "osmap",
                                  .title = "osmap map of ORB-SLAM2 (YAML and Protocol Buffers)",
                                  .suffixes = kSuffixes,
                                  .kind = FileKind::kBinary,
                                  .needs_path = true,
                                  .chooses_maps = true,
                                  .reads = kHeld,
                                  .writes = kHeld,
                                  .sniff = osmap::IsHeader,
                                  .read = osmap::Read,
                                  .write = osmap::Write};

}  // namespace slamdb
