// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/view/detail/pack.h"

#include <zlib.h>

#include <new>
#include <string_view>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/markup.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb::view {
namespace {

constexpr std::size_t kPartBytes = std::size_t{4} << 20;
constexpr int kLevel = 4;  // 6 takes twice the time for 1 % less

struct Part {
  const NamedColumn* column;
  std::size_t number;
  std::string_view bytes;
};

std::vector<Part> PartsOf(const Columns& columns) {
  std::vector<Part> parts;
  for (const NamedColumn& column : columns) {
    const std::string_view bytes = column.bytes;
    for (std::size_t at = 0; at < bytes.size(); at += kPartBytes)
      parts.push_back({&column, at / kPartBytes, bytes.substr(at, kPartBytes)});
  }
  return parts;
}

std::string Compressed(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), kLevel) != Z_OK)
    throw std::bad_alloc();
  packed.resize(size);
  return packed;
}

}  // namespace

std::vector<std::string> PackColumns(const Columns& columns, int threads) {
  const std::vector<Part> parts = PartsOf(columns);
  std::vector<std::string> blocks(parts.size());
  detail::ParallelFor(parts.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::string packed = Compressed(parts[i].bytes);
      blocks[i] =
          detail::Concat("<script type=\"text/plain\" data-name=\"", parts[i].column->name, "\" data-part=\"",
                         parts[i].number, "\">", detail::Base64(std::as_bytes(std::span(packed))), "</script>\n");
    }
  });
  return blocks;
}

}  // namespace slamdb::view
