// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace slamdb::detail {

// The FileDescriptorSet of one of Foxglove's messages, `foxglove.PointCloud`, with all that it refers to: how a reader
// of protobuf knows its fields. As of @foxglove/schemas 1.6, without the fields for a message's own lineage that came
// later.
std::string FileDescriptorSetOf(std::string_view message);

}  // namespace slamdb::detail
