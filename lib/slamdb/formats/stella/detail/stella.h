// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// `stella`: MessagePack maps of stella_vslam, and of OpenVSLAM before it. schema/stella.md has the bytes.
extern const Format kStellaFormat;

// `stella-sqlite`: its databases.
extern const Format kStellaDatabaseFormat;

}  // namespace slamdb::detail
