// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/rows.h"

#include <algorithm>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"

namespace slamdb::detail {

void WriteRows(AtomicFile& file, std::size_t count, std::size_t grain, const WriteOptions& options,
               const std::function<void(std::size_t begin, std::size_t end, std::string& out)>& append) {
  // Rounds of a few blocks per thread: all blocks of a round are made in parallel, then written one behind the other.
  const std::size_t blocks_per_round = 4 * static_cast<std::size_t>(ThreadCount(options.threads));
  std::vector<std::string> blocks(blocks_per_round);
  for (std::size_t begin = 0; begin < count; begin += blocks_per_round * grain) {
    const std::size_t rows = std::min(count - begin, blocks_per_round * grain);
    const std::size_t used = (rows + grain - 1) / grain;
    ParallelFor(used, 1, options.threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t block = first; block < last; ++block) {
        blocks[block].clear();
        append(begin + block * grain, begin + std::min(rows, (block + 1) * grain), blocks[block]);
      }
    });
    for (std::size_t block = 0; block < used; ++block) file.Write(blocks[block]);
    if (options.progress) options.progress("writing", static_cast<double>(begin + rows) / static_cast<double>(count));
  }
}

std::string CountWritten(std::size_t count, std::string_view noun, std::size_t bad) {
  return Counted(count, noun) + (bad == 0 ? "" : ", " + Counted(bad, "bad one") + " left out");
}

}  // namespace slamdb::detail
