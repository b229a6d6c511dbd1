// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/infer_layout.h"

#include <algorithm>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/file_stream.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/fork_files.h"
#include "slamdb/formats/orbslam3/detail/fork_salvage.h"
#include "slamdb/formats/orbslam3/detail/meaning.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"

namespace slamdb {
namespace {

// Compares what is written with what there is, piece by piece.
class Comparing {
 public:
  explicit Comparing(Bytes expected) : rest_(expected) {}
  void operator()(Bytes bytes) {
    const std::size_t size = std::min(bytes.size(), rest_.size());
    same_ = same_ && size == bytes.size() && (size == 0 || std::memcmp(rest_.data(), bytes.data(), size) == 0);
    rest_ = rest_.subspan(size);
  }
  bool same() const { return same_ && rest_.empty(); }

 private:
  Bytes rest_;
  bool same_ = true;
};

std::uint64_t Sum(const Atlas& atlas, std::size_t (*of)(const Map&)) {
  std::uint64_t sum = 0;
  for (const Map& map : atlas.maps) sum += of(map);
  return sum;
}

// Reads the file in the layout and writes it again.
void Prove(const WholeFile& file, InferredLayout& inferred) {
  Notices notices;
  const Source source(file.bytes(), file.path());
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = ToJson(inferred.layout);
  const Atlas atlas = ReadOrbslam3(source, options, notices);
  inferred.keyframes = Sum(atlas, [](const Map& map) { return map.keyframes.size(); });
  inferred.points = Sum(atlas, [](const Map& map) { return map.points.size(); });
  Comparing written(file.bytes());
  const Target target([&](Bytes bytes) { written(bytes); }, file.path());
  WriteOrbslam3(atlas, target, {}, notices);
  inferred.same_bytes = written.same();
}

// Where other layouts than the known ones are not looked for: in text, and where longs have 4 bytes.
InferredLayout InferKnown(const WholeFile& file) {
  Notices notices;
  Atlas atlas;
  try {
    atlas = ReadOrbslam3(Source(file.bytes(), file.path()), {}, notices);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kDamaged) throw;
    throw Error(ErrorKind::kNotPossible, file.path(), "",
                "no layout found: it is of none of the known layouts, and others are only found in binary archives "
                "with longs of 8 bytes. `DeriveLayoutOfFolder` derives it from the sources of the program that wrote "
                "it, for `Orbslam3ReadOptions::layout`");
  }
  InferredLayout inferred{.layout = LayoutOf(atlas.layout.empty() ? KnownLayouts().front().id : atlas.layout),
                          .known = true};
  inferred.doubts = orbslam3::MeaningOf(atlas, orbslam3::ForkProgram(inferred.layout)).doubts;
  return inferred;
}

// Of the file, decoded in a layout; what speaks against one that cannot be.
layouts::MeaningJudge JudgeOf(const WholeFile& file) {
  return [&file](const Layout& layout) -> layouts::Meaning {
    try {
      const orbslam3::ForkProgram program(layout);
      Notices notices;
      const Source source(file.bytes(), file.path());
      return orbslam3::MeaningOf(orbslam3::ReadInLayout(source, program, {}, notices).atlas, program);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged && error.kind() != ErrorKind::kUnsupported) throw;
      return {.penalty = layouts::kUnreadable, .doubts = {error.problem()}};
    }
  };
}

// What stands between the records of a known layout is damaged, or cut off.
InferredLayout InferBinary(const WholeFile& file, layouts::RecordLayouts& records, const InferOptions& options) {
  try {
    return layouts::Infer(records, options, JudgeOf(file));
  } catch (const Error& error) {
    const bool none_found = error.kind() == ErrorKind::kNotPossible && !records.maps().empty();
    const Layout* known = none_found ? orbslam3::KnownLayoutOf(records.archive(), records.maps()) : nullptr;
    if (known == nullptr) throw Error(error.kind(), file.path(), "", error.problem());
    throw Error(
        ErrorKind::kNotPossible, file.path(), "",
        detail::Concat("no layout found: keyframes and map points are as in ", known->id,
                       ", but nothing explains what stands around them: the file is damaged or cut short, or "
                       "its Map and Atlas have other members. `RecoverAtlas` saves what is whole, and "
                       "`DeriveLayoutOfFolder` derives the layout from the sources of the program that wrote it"));
  }
}

}  // namespace

InferredLayout orbslam3::InferLayoutOf(const Source& source, layouts::RecordLayouts& records,
                                       const InferOptions& options) {
  const WholeFile file(source);
  const ArchiveEncoding& encoding = records.archive().encoding;
  const bool is_usual = !encoding.text && encoding.long_bytes == 8 && encoding.size_bytes == 8;
  InferredLayout inferred = is_usual ? InferBinary(file, records, options) : InferKnown(file);
  Prove(file, inferred);
  return inferred;
}

InferredLayout InferLayout(const Source& source, const InferOptions& options) {
  const WholeFile file(source);
  const Source held(file.bytes(), file.path());
  detail::FileStream stream(held);
  Notices notices;
  const orbslam3::ArchiveHeader header = orbslam3::ReadArchiveHeader(stream, notices);
  layouts::RecordLayouts records({file.text(), header.encoding, header.bytes});
  return orbslam3::InferLayoutOf(held, records, options);
}

}  // namespace slamdb
