// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "slamdb/formats/colmap/detail/codec.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::colmap {

// A model of two images of one rig, and two points of which one has no track, with numbers that are exact.
Model SmallModel();

// The bytes that each part of SmallModel() is, spelt out.
std::string SmallBytes(Part part);
std::string SmallText(Part part);

// Reads bytes as a part.
Model Decode(Part part, const std::string& bytes, bool binary = true);
// What reading says of bytes that it refuses; "read" when it does not.
std::string Refusal(Part part, const std::string& bytes, bool binary = true);

// The files of SmallModel(), in a folder.
void MakeFiles(const TemporaryFolder& folder, bool binary, const std::map<std::string, std::string>& instead = {});

}  // namespace slamdb::colmap
