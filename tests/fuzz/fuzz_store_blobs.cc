// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/formats/rows/detail/features_blob.h"
#include "slamdb/model/detail/record.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as the blobs that the store keeps of a keyframe: one byte each for its three counts of features, then two
// bytes for the length of the details, the details, the features with the links to points among them, as stores before
// version 7 have them. They split and decode or fail with an Error; what decoded is packed into blobs that join and
// decode to the same blobs again.
namespace {

using slamdb::Bytes;

struct Blobs {
  slamdb::detail::ByteWriter details, features;
};

void Encode(const slamdb::KeyFrame& keyframe, Blobs& blobs) {
  slamdb::detail::EncodeDetails(keyframe, blobs.details);
  slamdb::detail::ByteWriter picture, points;
  slamdb::rows::EncodePicture(keyframe, picture);
  slamdb::rows::EncodePoints(keyframe, points);
  const std::string whole = slamdb::rows::Join(picture.bytes(), points.bytes());
  blobs.features.PutBytes(std::as_bytes(std::span(whole)));
}

slamdb::KeyFrame Decode(const std::uint8_t* counts, Bytes details, Bytes features) {
  slamdb::KeyFrame keyframe;
  keyframe.features.count = counts[0];
  keyframe.features.left_count = static_cast<std::int8_t>(counts[1]);
  keyframe.features.right_count = static_cast<std::int8_t>(counts[2]);
  slamdb::detail::DecodeDetails(details, keyframe);
  const slamdb::rows::SplitFeatures split = slamdb::rows::Split(features);
  slamdb::rows::DecodeFeatures(std::as_bytes(std::span(split.picture)), split.points, keyframe);
  return keyframe;
}

bool Same(Bytes a, Bytes b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 5) return 0;
  const Bytes rest = std::as_bytes(std::span(data, size)).subspan(5);
  const std::size_t cut = std::min<std::size_t>(data[3] | data[4] << 8, rest.size());
  Blobs first, second;
  try {
    Encode(Decode(data, rest.first(cut), rest.subspan(cut)), first);
  } catch (const slamdb::Error&) {
    return 0;
  }
  Encode(Decode(data, first.details.bytes(), first.features.bytes()), second);
  slamdb::fuzz::Require(
      Same(first.details.bytes(), second.details.bytes()) && Same(first.features.bytes(), second.features.bytes()),
      "what was packed decodes to the same");
  return 0;
}
