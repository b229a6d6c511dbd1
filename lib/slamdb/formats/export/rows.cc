// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/rows.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/pipeline.h"

namespace slamdb::detail {

void WriteRows(AtomicFile& file, std::size_t count, std::size_t grain, const WriteOptions& options,
               const std::function<void(std::size_t begin, std::size_t end, std::string& out)>& append) {
  const std::size_t blocks = (count + grain - 1) / grain;
  const auto end_of = [&](std::size_t block) { return std::min(count, (block + 1) * grain); };
  ProduceInOrder<std::string>(
      blocks, options.threads,
      [&](std::size_t block, std::string& out) { append(block * grain, end_of(block), out); },
      [&](std::size_t block, const std::string& bytes) {
        file.Write(bytes);
        if (options.progress)
          options.progress("writing", static_cast<double>(end_of(block)) / static_cast<double>(count));
      });
}

std::string CountWritten(std::size_t count, std::string_view noun, std::size_t bad) {
  return Counted(count, noun) + (bad == 0 ? "" : ", " + Counted(bad, "bad one") + " left out");
}

}  // namespace slamdb::detail
