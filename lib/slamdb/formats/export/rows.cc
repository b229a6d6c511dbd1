// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/rows.h"

#include <algorithm>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/pipeline.h"

namespace slamdb::detail {

template <class Buffer>
void WriteRows(AtomicFile& file, std::size_t count, std::size_t grain, const WriteOptions& options,
               const AppendRows<Buffer>& append) {
  const std::size_t blocks = (count + grain - 1) / grain;
  const auto end_of = [&](std::size_t block) { return std::min(count, (block + 1) * grain); };
  ProduceInOrder<Buffer>(
      blocks, options.threads, [&](std::size_t block, Buffer& out) { append(block * grain, end_of(block), out); },
      [&](std::size_t block, const Buffer& bytes) {
        file.Write(std::as_bytes(std::span(bytes)));
        if (options.progress)
          options.progress("writing", static_cast<double>(end_of(block)) / static_cast<double>(count));
      });
}

template void WriteRows<std::string>(AtomicFile&, std::size_t, std::size_t, const WriteOptions&,
                                     const AppendRows<std::string>&);
template void WriteRows<Column<char>>(AtomicFile&, std::size_t, std::size_t, const WriteOptions&,
                                      const AppendRows<Column<char>>&);

std::string CountWritten(std::size_t count, std::string_view noun, std::size_t bad) {
  return Counted(count, noun) + (bad == 0 ? "" : ", " + Counted(bad, "bad one") + " left out");
}

}  // namespace slamdb::detail
