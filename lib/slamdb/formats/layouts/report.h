// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "slamdb/base/report_files.h"
#include "slamdb/export.h"
#include "slamdb/formats/layouts/from_source.h"
#include "slamdb/formats/layouts/infer.h"
#include "slamdb/formats/layouts/layout.h"

// What `slamdb layouts` reports, as JSON.
// Thread-safe.
namespace slamdb {

// schema/layouts.schema.json
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(std::span<const Layout> layouts);
// schema/layouts-infer.schema.json
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const InferredLayout& inferred, const ReportFiles& files);
// schema/layouts-from-source.schema.json
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const DerivedLayout& derived, const ReportFiles& files);

// As `FILE:LINE: TEXT`, or the text alone where the question is about no file.
[[nodiscard]] SLAMDB_EXPORT std::string ToString(const LayoutQuestion& question);
// How many types of members are `?`: a layout with such is to be completed first.
[[nodiscard]] SLAMDB_EXPORT std::uint64_t CountUnknownTypes(const Layout& layout);

}  // namespace slamdb
