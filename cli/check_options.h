// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "cli/help/tree.h"
#include "slamdb/checks/check.h"

// What a check holds against atlases, for the verbs that check.
namespace slamdb::cli {

// --ignore, --note, --warn, --error and --strict.
void AddRules(CLI::App& verb, CheckOptions& check);

// An option for each gate; `limits` has one for each in their order, not a number where it is not asked for.
void AddGates(CLI::App& verb, std::vector<double>& limits);
std::vector<GateLimit> GatesOf(const std::vector<double>& limits);

}  // namespace slamdb::cli
