// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>

#include "slamdb/base/atomic_folder.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/files_read.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/codec.h"
#include "slamdb/formats/colmap/detail/colmap.h"
#include "slamdb/formats/colmap/detail/database.h"
#include "slamdb/formats/colmap/detail/folders.h"
#include "slamdb/formats/colmap/detail/kept_database.h"
#include "slamdb/formats/colmap/detail/models.h"
#include "slamdb/formats/export/detail/rows.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using colmap::FileOf;
using colmap::HasModel;
using colmap::kBinary;
using colmap::kDatabase;
using colmap::kNeeded;
using colmap::kPartNames;
using colmap::kText;
using colmap::Part;
using detail::Concat;

// ---- where models are in a folder

struct Place {
  std::string folder;
  std::uint64_t number = 0;
};

// The folder itself, or the numbered ones in it, as COLMAP's mapper makes them.
std::vector<Place> FindModelsIn(const std::string& folder) {
  if (HasModel(folder)) return {{folder, 0}};
  constexpr std::size_t kMost = 10'000;
  std::vector<Place> places;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const auto number = detail::ParseNumber<std::uint32_t>(entry->path().filename().string());
    if (number && places.size() < kMost && HasModel(entry->path().string()))
      places.push_back({entry->path().string(), *number});
  }
  std::ranges::sort(places, {}, &Place::number);
  return places;
}

// Of a model, or of the workspace that COLMAP and those who take its models keep them in.
std::vector<Place> FindModels(const std::string& folder) {
  std::vector<Place> places = FindModelsIn(folder);
  return places.empty() ? FindModelsIn((fs::path(folder) / "sparse").string()) : places;
}

// Whether COLMAP would read the binary files: those of the first model.
std::optional<bool> IsBinary(const std::string& folder) {
  const std::vector<Place> places = FindModels(folder);
  if (places.empty()) return std::nullopt;
  return HasModel(places.front().folder, kBinary);
}

bool SniffBinary(const Probe& probe) { return IsBinary(probe.path) == true; }
bool SniffText(const Probe& probe) { return IsBinary(probe.path) == false; }

// ---- reading and writing

colmap::Model ReadModel(const std::string& folder, Notices& notices) {
  const bool binary = HasModel(folder, kBinary);
  const std::string_view suffix = binary ? kBinary : kText;
  colmap::Model model;
  for (std::size_t part = 0; part < kPartNames.size(); ++part) {
    const std::string path = FileOf(folder, kPartNames[part], suffix);
    std::error_code missing;
    if (part >= kNeeded && !fs::exists(path, missing)) continue;
    const WholeFile file{Source(path)};
    if (!binary) detail::WarnOfOpenEnd(file.text(), path, notices);
    (binary ? colmap::DecodeBinary : colmap::DecodeText)(static_cast<Part>(part), file, model);
  }
  return model;
}

void NoteModel(const std::string& folder, detail::FilesRead& files) {
  for (const std::string_view suffix : {kBinary, kText})
    for (const std::string_view part : kPartNames) files.Note(FileOf(folder, part, suffix));
}

// One that was named has to be one; another file of that name near a model is no reason not to read the model.
std::unique_ptr<colmap::FeatureDatabase> OpenDatabase(const std::string& given, const std::string& folder,
                                                      Notices& notices) {
  if (!given.empty()) return std::make_unique<colmap::FeatureDatabase>(given);
  const std::optional<std::string> found = colmap::FindDatabase(folder);
  if (!found) return nullptr;
  try {
    return std::make_unique<colmap::FeatureDatabase>(*found);
  } catch (const Error& error) {
    notices.Warn(Concat(error.what(), "; the model is read without it"));
    return nullptr;
  }
}

Atlas ReadColmap(const Source& source, const ReadOptions& options, Notices& notices) {
  std::vector<colmap::NamedModel> models;
  detail::FilesRead files;
  const std::vector<Place> places = FindModels(source.path);
  for (const Place& place : places) NoteModel(place.folder, files);
  for (const Place& place : places) {
    colmap::RefuseUnfinished(place.folder);
    models.push_back({.path = place.folder, .map = place.number, .model = ReadModel(place.folder, notices)});
  }
  if (models.empty())
    throw Error(ErrorKind::kDamaged, source.path, "",
                "holds no model of COLMAP: cameras, images and points3D, all .bin or all .txt");
  const std::unique_ptr<colmap::FeatureDatabase> database =
      OpenDatabase(options.of<ColmapReadOptions>().database, models.front().path, notices);
  // Once the database is open, too, which may be written with them.
  for (const Place& place : places) colmap::RefuseUnfinished(place.folder);
  files.RequireSame();
  return colmap::AtlasOf(models, database.get(), options, notices);
}

// Where the models of several maps stand in their folder; one alone is the folder.
std::vector<std::string> FoldersOf(std::size_t maps) {
  if (maps <= 1) return {""};
  std::vector<std::string> folders;
  for (std::size_t row = 0; row < maps; ++row) folders.push_back(Concat(row, "/"));
  return folders;
}

using Encode = void (*)(Part, const colmap::Model&, AtomicFile&, const WriteOptions&);

void WriteFiles(const colmap::Model& model, const std::string& folder_in, std::string_view suffix, Encode encode,
                AtomicFolder& folder, const WriteOptions& options) {
  for (std::size_t part = 0; part < kPartNames.size(); ++part) {
    const std::unique_ptr<AtomicFile> file = folder.Make(Concat(folder_in, kPartNames[part], suffix));
    encode(static_cast<Part>(part), model, *file, options);
    file->Commit();
  }
}

void WriteModels(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices,
                 std::string_view suffix, Encode encode, std::string_view id) {
  AtomicFolder folder(target, detail::FileOptions(options));
  const ColmapWriteOptions& wanted = options.of<ColmapWriteOptions>();
  const colmap::Outline outline = colmap::OutlineOf(atlas, target, options, wanted.pictures);
  const std::vector<std::string> folders = FoldersOf(outline.maps.size());
  colmap::RefuseOtherModels(target.path, folders, suffix, kPartNames.size());
  colmap::RefuseOtherCloud(target.path, folders);
  std::optional<colmap::DatabaseWriter> database;
  std::optional<colmap::KeptDatabase> kept;
  if (wanted.with_database) {
    if (target.is_file()) detail::RefuseLogOfAnother(FileOf(target.path, kDatabase, ""));
    database.emplace(outline, wanted.schema, target.path);
  } else if (target.is_file()) {
    kept.emplace((fs::path(target.path) / folders.front()).string());
  }
  colmap::Unheld unheld;
  for (std::size_t row = 0; row < outline.maps.size(); ++row) {
    const colmap::Model model = colmap::ModelOf(outline, outline.maps[row], options, unheld);
    WriteFiles(model, folders[row], suffix, encode, folder, options);
    if (database) database->AddPairs(outline.maps[row], model);
    if (kept) kept->Compare(model);
  }
  if (outline.maps.empty()) WriteFiles({}, "", suffix, encode, folder, options);
  if (database) {
    const std::unique_ptr<AtomicFile> file = folder.Make(std::string(kDatabase));
    database->Write(*file);
    file->Commit();
  }
  colmap::RefuseOtherModels(target.path, folders, suffix, kPartNames.size());  // that came in the meantime
  colmap::RefuseOtherCloud(target.path, folders);
  folder.Commit();
  if (kept) kept->Warn(notices);
  colmap::Tell(outline, unheld, id, wanted.with_database, notices);
}

void WriteDatabase(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, detail::FileOptions(options));
  if (target.is_file()) detail::RefuseLogOfAnother(target.path);
  const ColmapWriteOptions& wanted = options.of<ColmapWriteOptions>();
  const colmap::Outline outline = colmap::OutlineOf(atlas, target, options, wanted.pictures);
  colmap::DatabaseWriter database(outline, wanted.schema, target.path);
  colmap::Unheld unheld;
  for (std::size_t row = 0; row < outline.maps.size(); ++row) {
    if (options.progress)
      options.progress("writing", static_cast<double>(row) / static_cast<double>(outline.maps.size()));
    const colmap::MapOutline& map = outline.maps[row];
    database.AddPairs(map, colmap::ModelOf(outline, map, options, unheld));
  }
  database.Write(file);
  file.Commit();
  colmap::WarnOfLeftOut(outline, unheld, notices);
  notices.Tell(Concat(detail::CountWritten(database.images(), "image", outline.bad_keyframes), ", ",
                      detail::Counted(database.keypoints(), "keypoint"), ", matches of ",
                      detail::Counted(database.pairs(), "pair")),
               WrittenCounts{.keyframes = colmap::CountKeyFrames(outline.maps)});
}

void WriteBinary(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  WriteModels(atlas, target, options, notices, kBinary, colmap::EncodeBinary, "colmap");
}
void WriteText(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  WriteModels(atlas, target, options, notices, kText, colmap::EncodeText, "colmap-text");
}

constexpr Content kHolds = Content::kPoses | Content::kPoints | Content::kObservations | Content::kKeypoints |
                           Content::kDescriptors | Content::kCameras | Content::kMaps;
constexpr std::array<std::string_view, 1> kBinarySuffixes = {".colmap"}, kTextSuffixes = {".colmap.txt"},
                                          kDatabaseSuffixes = {".colmap.db"};

}  // namespace

namespace detail {

const Format kColmapFormat = {.id = "colmap",
                              .title = "COLMAP model",
                              .suffixes = kBinarySuffixes,
                              .kind = FileKind::kBinary,
                              .is_folder = true,
                              .chooses_maps = true,
                              .reads = kHolds,
                              .writes = kHolds,
                              .sniff = SniffBinary,
                              .read = ReadColmap,
                              .write = WriteBinary};

const Format kColmapTextFormat = {.id = "colmap-text",
                                  .title = "COLMAP model as text",
                                  .suffixes = kTextSuffixes,
                                  .kind = FileKind::kText,
                                  .is_folder = true,
                                  .chooses_maps = true,
                                  .reads = kHolds,
                                  .writes = kHolds,
                                  .sniff = SniffText,
                                  .read = ReadColmap,
                                  .write = WriteText};

const Format kColmapDatabaseFormat = {
    .id = "colmap-database",
    .title = "COLMAP database",
    .suffixes = kDatabaseSuffixes,
    .kind = FileKind::kBinary,
    .chooses_maps = true,
    .is_export = true,
    .writes = Content::kObservations | Content::kKeypoints | Content::kDescriptors | Content::kCameras | Content::kMaps,
    .write = WriteDatabase};

}  // namespace detail
}  // namespace slamdb
