// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

// Outputs that are no atlases.
namespace slamdb::cli {

// What is no atlas (a page, a picture, a report) never replaces one: throws Error when the file reads as an atlas.
void RefuseAtlas(const std::string& output);

// The same of an output that nobody named, which is no symbolic link either: that would lead to what nobody meant.
void GuardDefaultName(const std::string& output);

}  // namespace slamdb::cli
