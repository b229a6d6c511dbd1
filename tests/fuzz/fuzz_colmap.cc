// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/codec.h"
#include "slamdb/formats/colmap/detail/models.h"
#include "tests/fuzz/colmap_parts.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as the files of a model of COLMAP. They become an atlas or fail with an Error; what becomes an atlas is
// written to files that decode, and are written again, to the same bytes.
namespace slamdb {
namespace {

using colmap::Part;

colmap::Model Decode(const fuzz::ColmapParts& parts) {
  colmap::Model model;
  for (std::size_t part = 0; part < parts.files.size(); ++part) {
    const WholeFile file(Source(std::as_bytes(std::span(parts.files[part])), "fuzz"));
    if (part >= 3 && parts.files[part].empty()) continue;  // which older versions did not write
    (parts.binary ? colmap::DecodeBinary : colmap::DecodeText)(static_cast<Part>(part), file, model);
  }
  return model;
}

fuzz::ColmapParts Encode(const colmap::Model& model, bool binary) {
  fuzz::ColmapParts parts{.binary = binary, .files = {}};
  for (std::size_t part = 0; part < parts.files.size(); ++part) {
    std::string& bytes = parts.files[part];
    const Target target([&](Bytes more) { bytes.append(reinterpret_cast<const char*>(more.data()), more.size()); },
                        "fuzz");
    AtomicFile file(target);
    (binary ? colmap::EncodeBinary : colmap::EncodeText)(static_cast<Part>(part), model, file, {.threads = 1});
    file.Commit();
  }
  return parts;
}

}  // namespace
}  // namespace slamdb

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const fuzz::ColmapParts parts = fuzz::SplitColmap({reinterpret_cast<const char*>(data), size});
  Atlas atlas;
  Notices notices;
  try {
    colmap::NamedModel named{.path = "fuzz", .map = 0, .model = Decode(parts)};
    atlas = colmap::AtlasOf({&named, 1}, nullptr, {.threads = 1}, notices);
  } catch (const Error&) {
    return 0;
  }
  const WriteOptions options{.threads = 1};
  const colmap::Outline outline = colmap::OutlineOf(atlas, "fuzz", options, {});
  colmap::Unheld unheld;
  if (outline.maps.empty()) return 0;
  const colmap::Model model = colmap::ModelOf(outline, outline.maps[0], options, unheld);
  for (const bool binary : {true, false}) {
    const fuzz::ColmapParts written = Encode(model, binary);
    fuzz::Require(Encode(Decode(written), binary).files == written.files, "what was written decodes to the same");
  }
  return 0;
}
