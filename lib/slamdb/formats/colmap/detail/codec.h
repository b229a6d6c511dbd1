// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/base/atomic_file.h"
#include "slamdb/formats/colmap/detail/model.h"
#include "slamdb/formats/format.h"

// The bytes of each file of a model. Nothing depends on a locale or on threads.
namespace slamdb::colmap {

// Reads one file into its list of the model. Errors are kDamaged, with the place in the file.
// A count that the rest of the file cannot hold is refused before memory is taken.
void DecodeBinary(Part part, const WholeFile& file, Model& model);
void DecodeText(Part part, const WholeFile& file, Model& model);

// Writes one file.
void EncodeBinary(Part part, const Model& model, AtomicFile& file, const WriteOptions& options);
// Throws Error (kNotPossible) for a name with blanks in it, which the text form cannot hold.
void EncodeText(Part part, const Model& model, AtomicFile& file, const WriteOptions& options);

}  // namespace slamdb::colmap
