// SPDX-License-Identifier: BSD-3-Clause
#include "cli/reconstructions.h"

#include "cli/choices.h"
#include "cli/options.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/options.h"
#include "slamdb/many/convert.h"

namespace slamdb::cli {
void AddReconstructionOptions(CLI::App& verb, ReconstructionOptions& options) {
  constexpr const char* kGroup = "Reconstructions";
  verb.add_option("--images", options.images,
                  "The picture files of the session: a folder of files named by their times, or a list of `time name`. "
                  "Keyframes get the names of those nearest in time; without it names are made of the times")
      ->type_name("FOLDER|FILE")
      ->group(kGroup);
  verb.add_flag("--with-database", options.with_database,
                "Write database.db into the folder of a COLMAP model too: keypoints, descriptors, matches")
      ->group(kGroup);
  verb.add_option(
          "--colmap-schema", options.schema,
          "Of the database: old (by default) opens in COLMAP 3.8 and all later versions, new has rigs and frames")
      ->type_name("SCHEMA")
      ->check(CLI::IsMember({"old", "new"}))
      ->group(kGroup);
  verb.add_option("--database", options.database,
                  "COLMAP's database, where the descriptors of a model are that is read; by default database.db in its "
                  "folder or up to two above")
      ->type_name("FILE")
      ->group(kGroup);
}

void RefuseIdleReconstructionOptions(const Format& output, const ReconstructionOptions& options) {
  const std::string is = " only; the output is " + std::string(output.title);
  if (!options.images.empty() && !NamesPictures(output))
    RefuseUsage("--images is for COLMAP, NeRF and Gaussian splatting" + is);
  if (options.with_database && !IsModel(output)) RefuseUsage("--with-database is for COLMAP models" + is);
  const bool writes_database = options.with_database || (IsColmap(output) && !IsModel(output));
  if (!options.schema.empty() && !writes_database)
    RefuseUsage("--colmap-schema is for COLMAP's database" + is + (IsModel(output) ? " without --with-database" : ""));
}

void RefuseIdleDatabase(const Format* input, const ReconstructionOptions& options) {
  if (input != nullptr && !options.database.empty() && !IsModel(*input))
    RefuseUsage("--database is for COLMAP models only; the input is " + std::string(input->title));
}

void SetReconstructionOptions(const ReconstructionOptions& options, ReadOptions& read) {
  read.of<ColmapReadOptions>().database = options.database;
}

void SetReconstructionOptions(const ReconstructionOptions& options, WriteOptions& write) {
  ColmapWriteOptions& colmap = write.of<ColmapWriteOptions>();
  if (!options.images.empty()) colmap.pictures = FindKeyFramePictures(options.images);
  colmap.with_database = options.with_database;
  colmap.schema = options.schema == "new" ? ColmapSchema::kNew : ColmapSchema::kOld;
}

}  // namespace slamdb::cli
