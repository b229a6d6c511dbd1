// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/pieces.h"
#include "slamdb/base/detail/pipeline.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/archive_plan.h"
#include "slamdb/formats/orbslam3/detail/fork_files.h"
#include "slamdb/formats/orbslam3/detail/fork_losses.h"
#include "slamdb/formats/orbslam3/detail/sanitize.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"

// How an atlas is written: a plan cuts the archive into segments, threads encode them, and the caller writes the
// finished ones in order.
namespace slamdb {
namespace {

using detail::Concat;

ArchiveEncoding EncodingFor(const Atlas& atlas, const Orbslam3WriteOptions& options) {
  ArchiveEncoding encoding = atlas.encoding;
  if (options.boost_version) encoding.boost_version = *options.boost_version;
  if (encoding.boost_version < orbslam3::kOldestBoost || encoding.boost_version > 255)
    throw Error(ErrorKind::kUsage, Concat("Boost archive version ", encoding.boost_version,
                                          " cannot be written, expected 10 (Boost 1.53) to 20 (Boost 1.84)"));
  if (options.long_bytes) {
    if (*options.long_bytes != 4 && *options.long_bytes != 8)
      throw Error(ErrorKind::kUsage, Concat("a long of ", *options.long_bytes, " bytes, expected 4 or 8"));
    if (*options.long_bytes != encoding.long_bytes) encoding.size_bytes = 8;  // 64-bit Windows, 64-bit Linux and macOS
    encoding.long_bytes = static_cast<std::uint8_t>(*options.long_bytes);
  }
  return encoding;
}

// Hands the archive to take(i, pieces), segment by segment. Returns false when it is text with `nan` or `inf`.
bool Produce(const orbslam3::ArchivePlan& plan, int threads, const detail::TakeBlock<detail::Pieces>& take) {
  std::atomic<bool> finite = true;
  const auto encode = [&](std::size_t i, detail::Pieces& pieces) {
    if (!plan.Encode(i, pieces)) finite = false;
  };
  detail::ProduceInOrder<detail::Pieces>(plan.size(), plan.ThreadsThatPay(threads), encode, take);
  return finite;
}

void WriteArchive(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const orbslam3::ArchivePlan plan(atlas, EncodingFor(atlas, options.of<Orbslam3WriteOptions>()));
  AtomicFile file(target, {options.overwrite, options.sync, options.before_commit});
  const bool finite = Produce(plan, options.threads, [&](std::size_t i, const detail::Pieces& pieces) {
    pieces.ForEach([&](Bytes bytes) { file.Write(bytes); });
    if (options.progress)
      options.progress("writing " + target.path, static_cast<double>(i + 1) / static_cast<double>(plan.size()));
  });
  file.Commit();
  if (!finite)
    notices.Warn(target.path +
                 ": the text holds nan or inf, which slamdb reads back but ORB-SLAM3's own loader does not; "
                 "Orbslam3WriteOptions::sanitize clears those in uninitialised members");
}

}  // namespace

namespace {

std::string LayoutFor(const Atlas& atlas, const WriteOptions& options) {
  return options.of<Orbslam3WriteOptions>().layout.value_or(atlas.layout);
}

// Known before a byte is written.
void NameLosses(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  for (std::string& loss : orbslam3::LossesInLayout(atlas, LayoutFor(atlas, options))) {
    if (options.strict)
      throw Error(ErrorKind::kNotPossible, target.path, "", loss + "; WriteOptions::strict refuses that");
    notices.Lose(std::move(loss));
  }
}

void WriteInAnyLayout(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const std::string layout = LayoutFor(atlas, options);
  NameLosses(atlas, target, options, notices);
  if (orbslam3::IsOwnLayout(layout)) return WriteArchive(atlas, target, options, notices);
  AtomicFile file(target, {options.overwrite, options.sync, options.before_commit});
  const ArchiveEncoding encoding = EncodingFor(atlas, options.of<Orbslam3WriteOptions>());
  orbslam3::WriteInLayout(
      atlas, encoding, layout, [&](Bytes bytes) { file.Write(bytes); }, target.path, notices);
  file.Commit();
}

}  // namespace

void WriteOrbslam3(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  if (!options.of<Orbslam3WriteOptions>().sanitize) return WriteInAnyLayout(atlas, target, options, notices);
  Atlas sanitized = atlas;
  for (std::string& change : detail::SanitizeForOrbslam3(sanitized)) notices.Note("sanitized: " + std::move(change));
  WriteInAnyLayout(sanitized, target, options, notices);
}

std::string EncodeOrbslam3(const Atlas& atlas) {
  std::string encoded;
  const auto append = [&](Bytes bytes) { encoded.append(reinterpret_cast<const char*>(bytes.data()), bytes.size()); };
  if (!orbslam3::IsOwnLayout(atlas.layout)) {
    Notices unsaid;
    orbslam3::WriteInLayout(atlas, EncodingFor(atlas, {}), atlas.layout, append, "memory", unsaid);
    return encoded;
  }
  const orbslam3::ArchivePlan plan(atlas, EncodingFor(atlas, {}));
  Produce(plan, 0, [&](std::size_t, const detail::Pieces& pieces) { pieces.ForEach(append); });
  return encoded;
}

}  // namespace slamdb
