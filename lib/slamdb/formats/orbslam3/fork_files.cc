// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/fork_files.h"

#include <algorithm>
#include <array>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/orbslam3/detail/fork.h"
#include "slamdb/formats/orbslam3/detail/fork_losses.h"
#include "slamdb/formats/orbslam3/detail/meaning.h"
#include "slamdb/formats/orbslam3/detail/part_sizes.h"
#include "slamdb/formats/orbslam3/detail/plausible.h"

namespace slamdb::orbslam3 {
namespace {

using detail::Concat;

bool IsOfTheBytes(const Error& error) {
  return error.kind() == ErrorKind::kDamaged || error.kind() == ErrorKind::kUnsupported;
}

// Text does not say how wide the writer's long and size_t were.
struct Widths {
  std::uint8_t long_bytes, size_bytes;
};
constexpr std::array<Widths, 3> kWidths{{{8, 8}, {4, 8}, {4, 4}}};

ForkReading ReadWithWidths(const Source& source, const ForkProgram& program, const ReadOptions& options,
                           std::span<const Widths> tried = kWidths) {
  std::optional<Error> first;
  for (const Widths& widths : tried) {
    detail::FileStream file(source);
    Notices known;
    ArchiveHeader header = ReadArchiveHeader(file, known);
    if (header.encoding.text) {
      header.encoding.long_bytes = widths.long_bytes;
      header.encoding.size_bytes = widths.size_bytes;
    }
    try {
      return ReadFork(file, header, program, options);
    } catch (const Error& error) {
      if (!header.encoding.text || !IsOfTheBytes(error)) throw;
      if (!first) first = error;
    }
  }
  throw *first;  // NOLINT(cert-err60-cpp)
}

void Finish(ForkReading& reading, const ForkProgram& program, const Source& source, const ReadOptions& options,
            Notices& notices) {
  Layout layout = program.layout;
  for (const auto& [of_class, key] : reading.exported) layout.Find(of_class)->exported = key;
  reading.atlas.layout = NameFor(layout);
  if (reading.left > 0)
    notices.Lose(Concat(source.path, ": ", reading.left,
                        " bytes behind the end of the atlas are not part of it and were left out"));
  if (!reading.derived.empty())
    notices.Warn(Concat(source.path, ": derived what the layout ", TitleOf(program.layout),
                        " lacks: ", Listed(reading.derived)));
  for (const std::string& doubt : DoubtsOfMissing(program))
    notices.Warn(Concat(source.path, ": in the layout ", TitleOf(program.layout), " ", doubt));
  if (options.part_sizes != nullptr)
    ListPartSizes(reading.part_bytes, static_cast<std::size_t>(detail::FileStream(source).size()), *options.part_sizes);
  detail::Select(options.selection, reading.atlas);
}

// Made ready once, as many files may be none of them.
const std::vector<ForkProgram>& KnownForks() {
  static const std::vector<ForkProgram> kForks(KnownLayouts().begin() + 1, KnownLayouts().end());
  return kForks;
}

std::uint64_t Reachable(const std::vector<std::string>& names, std::uint64_t count) {
  return names.empty() ? 0 : count;
}

}  // namespace

bool IsOwnLayout(std::string_view layout) { return layout.empty() || layout == KnownLayouts().front().id; }

std::string NameFor(const Layout& layout) {
  for (const Layout& known : KnownLayouts())
    if (SameBytes(known, layout)) return IsOwnLayout(known.id) ? std::string() : known.id;
  return ToJson(layout);
}

LayoutReading ReadInLayout(const Source& source, const ForkProgram& program, const ReadOptions& options,
                           Notices& notices) {
  ForkReading reading = ReadWithWidths(source, program, options);
  Finish(reading, program, source, options, notices);
  const bool doubtful = LooksLikeAnotherLayout(reading.atlas, CountImplausible(reading.atlas) + reading.implausible);
  if (doubtful)
    notices.Warn(Concat(source.path, ": most keyframes have no sensible time or orientation in the layout ",
                        TitleOf(program.layout), ": it may be of another one"));
  return {std::move(reading.atlas), reading.left == 0 && !doubtful};
}

std::optional<Atlas> ReadInKnownLayout(const Source& source, const ReadOptions& options, Notices& notices) {
  std::optional<ForkReading> best;
  const ForkProgram* program = nullptr;
  std::vector<std::string> fitting;
  for (const ForkProgram& candidate : KnownForks()) {
    try {
      // Whoever has text of a fork on Windows names the layout: to try all would take long of a file that is damaged.
      ForkReading reading = ReadWithWidths(source, candidate, options, std::span(kWidths).first(1));
      reading.implausible += CountImplausible(reading.atlas);
      if (reading.left > 0 || LooksLikeAnotherLayout(reading.atlas, reading.implausible)) continue;
      fitting.push_back(candidate.layout.id);
      if (best && best->implausible <= reading.implausible) continue;
      best = std::move(reading);
      program = &candidate;
    } catch (const Error& error) {
      if (!IsOfTheBytes(error)) throw;
    }
  }
  if (!best) return std::nullopt;
  if (options.part_sizes != nullptr) options.part_sizes->clear();
  Finish(*best, *program, source, options, notices);
  notices.Note(Concat(source.path, ": read in the layout ", program->layout.id, " (", program->layout.title, ", as ",
                      program->layout.who, " write it), as it is not of ORB-SLAM3 v1.0"));
  if (fitting.size() > 1)
    notices.Warn(
        Concat(source.path, ": the layouts ", Listed(fitting), " all fit; Orbslam3ReadOptions::layout chooses"));
  return std::move(best->atlas);
}

void WriteInLayout(const Atlas& atlas, const ArchiveEncoding& encoding, const std::string& layout,
                   const Target::Sink& write, const std::string& path, Notices& notices) {
  const ForkProgram program(LayoutOf(layout));
  const bool fits = IsOfSameLayout(atlas, layout);
  const ForkWriting done = WriteFork(atlas, encoding, program, fits, write);
  const std::string filled = ForeignMembers(program, Reachable(program.foreign_keyframe, done.filled_keyframes),
                                            Reachable(program.foreign_point, done.filled_points), done.filled_others);
  if (!filled.empty()) notices.Warn(Concat(path, ": zeros stand for what the atlas does not have: ", filled));
  if (done.dropped_pointers > 0)
    notices.Lose(Concat(path, ": ", done.dropped_pointers, " pointers to what is no longer there are null"));
}

}  // namespace slamdb::orbslam3
