// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace slamdb::testing {

// Where and why a value breaks a JSON schema of schema/, by the keywords that those use: type, const, enum, minimum,
// anyOf, required, properties, additionalProperties, items, minItems, maxItems and local $ref. Empty when it holds.
std::string BreachOf(const nlohmann::json& value, const std::string& schema_name);

}  // namespace slamdb::testing
