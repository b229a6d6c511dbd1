// SPDX-License-Identifier: BSD-3-Clause
#include <strings.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/file_stream.h"
#include "slamdb/base/detail/pipeline.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/mrpt/detail/gzip.h"
#include "slamdb/formats/mrpt/detail/landmarks.h"
#include "slamdb/formats/mrpt/detail/mrpt.h"
#include "slamdb/formats/mrpt/detail/stream.h"
#include "slamdb/formats/mrpt/options.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/model/counters.h"

namespace slamdb {
namespace {

using mrpt::Layout;

constexpr std::size_t kGrain = 512;  // landmarks
constexpr std::array<std::string_view, 2> kSuffixes{".mrpt", ".mrpt.gz"};
constexpr std::array<std::string_view, 2> kSuffixes3{".mrpt3", ".mrpt3.gz"};
constexpr std::array<std::string_view, 2> kTextSuffixes{".mrpt.txt", ".mrpt.txt.gz"};

std::optional<Layout> LayoutOf(const Probe& probe) {
  constexpr std::size_t kEnough = 256;
  return mrpt::LayoutOf(mrpt::IsGzip(probe.head) ? mrpt::DecompressHead(probe.head, kEnough) : probe.head);
}
bool Sniff2(const Probe& probe) { return LayoutOf(probe) == Layout::kMrpt2; }
bool Sniff3(const Probe& probe) { return LayoutOf(probe) == Layout::kMrpt3; }

// The bytes of a stream, decompressed where it is compressed.
class InputFile {
 public:
  // Not `whole`: as much as can be had of a damaged one.
  InputFile(const Source& source, bool whole) : file_(source) {
    file_.FillTo(file_.size());
    bytes_ = {file_.data(), file_.size()};
    if (!mrpt::IsGzip(bytes_)) return;
    decompressed_ =
        whole ? mrpt::Decompress(source.path, bytes_) : mrpt::DecompressHead(bytes_, mrpt::MostBytes(bytes_));
    bytes_ = decompressed_;
  }
  std::string_view bytes() const { return bytes_; }

 private:
  detail::FileStream file_;
  std::string decompressed_;
  std::string_view bytes_;
};

Atlas Read(const Source& source, const ReadOptions& options, Notices&) {
  Atlas atlas;
  atlas.maps = mrpt::ReadMaps(source.path, InputFile(source, true).bytes());
  RaiseCounters(atlas);
  const Selection& selection = options.selection;
  std::erase_if(atlas.maps, [&](const Map& map) { return selection.map && *selection.map != map.id; });
  if (selection.box)
    for (Map& map : atlas.maps)
      std::erase_if(map.landmarks,
                    [&](const Landmark& landmark) { return !selection.box->contains(landmark.mean.cast<float>()); });
  return atlas;
}

// The maps that have landmarks; the first one when none has, since a file holds at least one map.
std::vector<const Map*> MapsWithLandmarks(const Atlas& atlas, const Target& target, const WriteOptions& options) {
  std::vector<const Map*> maps = detail::ChooseMaps(atlas, options, target);
  std::erase_if(maps, [](const Map* map) { return map->landmarks.empty(); });
  return maps;
}

// A new file, compressed where its name ends in `.gz`.
class OutputFile {
 public:
  OutputFile(const Target& target, const WriteOptions& options) : file_(target, detail::FileOptions(options)) {
    const std::string& path = target.path;
    if (path.size() > 3 && strncasecmp(path.c_str() + path.size() - 3, ".gz", 3) == 0)
      compressor_.emplace([this](std::string_view bytes) { file_.Write(bytes); });
  }
  void Write(std::string_view bytes) { compressor_ ? compressor_->Add(bytes) : file_.Write(bytes); }
  void Commit() {
    if (compressor_) compressor_->Finish();
    file_.Commit();
  }

 private:
  AtomicFile file_;
  std::optional<mrpt::Compressor> compressor_;
};

// Blocks of landmarks, made on all threads, to where they go.
template <class Append>
void WriteLandmarks(const std::vector<Landmark>& landmarks, const WriteOptions& options, Append append,
                    OutputFile& file) {
  const std::size_t blocks = (landmarks.size() + kGrain - 1) / kGrain;
  detail::ProduceInOrder(
      blocks, options.threads,
      [&](std::size_t block, Column<char>& buffer) {
        std::string out;
        const std::size_t end = std::min(landmarks.size(), (block + 1) * kGrain);
        for (std::size_t i = block * kGrain; i < end; ++i) append(out, landmarks[i]);
        buffer.assign(out.begin(), out.end());
      },
      [&](std::size_t block, const Column<char>& buffer) {
        file.Write({buffer.data(), buffer.size()});
        if (options.progress) options.progress("writing", static_cast<double>(block + 1) / static_cast<double>(blocks));
      });
}

template <class Append>
void WriteStream(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices,
                 Append append) {
  OutputFile file(target, options);
  const auto write_map = [&](const std::vector<Landmark>& landmarks) {
    std::string head = mrpt::HeaderOf(mrpt::kMapClass, mrpt::kMapVersion);
    detail::AppendRaw(head, static_cast<std::uint32_t>(landmarks.size()));
    file.Write(head);
    WriteLandmarks(landmarks, options, append, file);
    file.Write({&mrpt::kEndFlag, 1});
  };
  const std::vector<const Map*> maps = MapsWithLandmarks(atlas, target, options);
  for (const Map* map : maps) write_map(map->landmarks);
  if (maps.empty()) write_map({});
  file.Commit();
  if (maps.size() > 1)
    notices.Note(detail::Concat("the stream holds ", maps.size(),
                                " maps, one behind the other; programs that read one see the first "
                                "(ExportOptions::map writes one)"));
}

template <class Test>
std::uint64_t CountLandmarks(const Atlas& atlas, const WriteOptions& options, Test test) {
  const std::optional<MapId> chosen = options.of<ExportOptions>().map;
  std::uint64_t count = 0;
  for (const Map& map : atlas.maps)
    if (!chosen || map.id == *chosen)
      count += static_cast<std::uint64_t>(std::count_if(map.landmarks.begin(), map.landmarks.end(), test));
  return count;
}

bool IsRounded(const Landmark& landmark) {
  for (const double value :
       {landmark.cov_11, landmark.cov_22, landmark.cov_33, landmark.cov_12, landmark.cov_13, landmark.cov_23})
    if (value == value && static_cast<double>(static_cast<float>(value)) != value) return true;
  return false;
}

// In such a feature the slot of LATCH is read as ORB's.
bool HasLatchAlone(const Landmark& landmark) {
  return std::any_of(landmark.features.begin(), landmark.features.end(), [](const LandmarkFeature& feature) {
    return feature.type == FeatureType::kOrb && feature.FindDescriptor(DescriptorKind::kLatch) != nullptr &&
           feature.FindDescriptor(DescriptorKind::kOrb) == nullptr;
  });
}

void NameLoss(std::uint64_t count, const std::string& format, const std::string& what, Notices& notices) {
  if (count > 0) notices.Lose(format + " cannot hold " + what + " of landmarks (" + detail::Thousands(count) + ")");
}

void Write2(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const bool own_slots = options.of<MrptWriteOptions>().own_slots;
  WriteStream(atlas, target, options, notices,
              [&](std::string& out, const Landmark& landmark) { mrpt::AppendLandmark2(out, landmark, own_slots); });
  NameLoss(CountLandmarks(atlas, options, IsRounded), "mrpt", "64-bit covariances", notices);
  if (!own_slots)
    NameLoss(CountLandmarks(atlas, options, HasLatchAlone), "mrpt",
             "LATCH descriptors without ORB descriptors beside them in ORB features", notices);
}

void Write3(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  WriteStream(atlas, target, options, notices, mrpt::AppendLandmark3);
  const auto lose = [&](const std::string& what, bool (*has)(const Landmark&)) {
    NameLoss(CountLandmarks(atlas, options, has), "mrpt3", what, notices);
  };
  lose("features", [](const Landmark& landmark) { return !landmark.features.empty(); });
  lose("normals", [](const Landmark& landmark) { return landmark.normal != Eigen::Vector3d::Zero(); });
  lose("times of last sight", [](const Landmark& landmark) { return landmark.last_seen != 0; });
}

void WriteText(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  OutputFile file(target, options);
  for (const Map* map : MapsWithLandmarks(atlas, target, options))
    WriteLandmarks(map->landmarks, options, mrpt::AppendLandmarkText, file);
  file.Commit();
  const auto all = [](const Landmark&) { return true; };
  NameLoss(CountLandmarks(atlas, options, all), "mrpt-text", "covariances, normals, keypoints and dates", notices);
  const auto has_wide_id = [](const Landmark& landmark) {
    return landmark.id && landmark.id.value() > std::numeric_limits<std::int32_t>::max();
  };
  NameLoss(CountLandmarks(atlas, options, has_wide_id), "mrpt-text", "ids of more than 31 bits", notices);
}

// The landmarks in front of what is damaged or cut.
Salvage SalvageLandmarks(const Source& source, const ReadOptions&) {
  Salvage salvage = mrpt::SalvageMaps(source.path, InputFile(source, false).bytes());
  RaiseCounters(salvage.atlas);
  return salvage;
}

}  // namespace

const Format detail::kMrptFormat{.id = "mrpt",
                                 .title = "MRPT 2 landmarks map",
                                 .suffixes = kSuffixes,
                                 .kind = FileKind::kBinary,
                                 .chooses_maps = true,
                                 .reads = Content::kLandmarks | Content::kMaps,
                                 .writes = Content::kLandmarks | Content::kMaps,
                                 .sniff = Sniff2,
                                 .read = Read,
                                 .write = Write2,
                                 .salvage = SalvageLandmarks};

const Format detail::kMrpt3Format{.id = "mrpt3",
                                  .title = "MRPT 3 landmarks map",
                                  .suffixes = kSuffixes3,
                                  .kind = FileKind::kBinary,
                                  .chooses_maps = true,
                                  .reads = Content::kLandmarks | Content::kMaps,
                                  .writes = Content::kLandmarks | Content::kMaps,
                                  .sniff = Sniff3,
                                  .read = Read,
                                  .write = Write3,
                                  .salvage = SalvageLandmarks};

const Format detail::kMrptTextFormat{.id = "mrpt-text",
                                     .title = "MRPT landmarks as text",
                                     .suffixes = kTextSuffixes,
                                     .chooses_maps = true,
                                     .writes = Content::kLandmarks,
                                     .write = WriteText};

}  // namespace slamdb
