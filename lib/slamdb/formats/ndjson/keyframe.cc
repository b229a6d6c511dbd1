// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "slamdb/formats/ndjson/detail/members.h"
#include "slamdb/formats/ndjson/json.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb {
namespace {

// 32-bit floats as numbers, any other type as the bytes that it is.
void AppendMatrixData(detail::JsonAppender& json, const Matrix& matrix) {
  if (matrix.type == detail::kCv32F && matrix.data.size() % sizeof(float) == 0) {
    Column<float> values(matrix.data.size() / sizeof(float));
    if (!values.empty()) std::memcpy(values.data(), matrix.data.data(), matrix.data.size());
    json.Array("values", values);
  } else {
    json.Hex("bytes", matrix.data.data(), matrix.data.size());
  }
}

}  // namespace

void AppendJson(std::string& out, const KeyFrame& keyframe, std::optional<MapId> map) {
  detail::JsonAppender json(out);
  json.BeginObject();
  json.Field("type", "keyframe");
  if (map) json.Field("map", *map);
  {
    detail::DottedMembers members(json);
    ForEachField(&keyframe, [&](std::string_view name, auto... path) {
      const auto& value = Member(keyframe, path...);
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, Column<std::byte>>) {
        members.Enter(name);
        AppendMatrixData(json, keyframe.distortion);
      } else {
        members.Append(name, value);
      }
    });
  }
  json.EndObject();
}

}  // namespace slamdb
