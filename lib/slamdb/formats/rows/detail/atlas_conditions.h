// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "slamdb/formats/rows/atlas_query.h"

// A query of atlases as SQL, which is the same in every database but for how it matches patterns.
namespace slamdb::rows {

struct Dialect {
  char parameter;                                 // before its number
  std::string_view matches;                       // `text MATCHES pattern`
  std::string (*pattern)(std::string_view text);  // of `*` and `?`
};

struct AtlasConditions {
  std::string sql;                                            // of a SELECT from `atlas`, behind WHERE
  std::vector<std::variant<double, std::string>> parameters;  // from 1 on
};

AtlasConditions ConditionsOf(const AtlasQuery& query, const Dialect& dialect);

}  // namespace slamdb::rows
