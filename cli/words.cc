// SPDX-License-Identifier: BSD-3-Clause
#include "cli/words.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace slamdb::cli {
namespace {

constexpr std::array kWords = {
    Word{"WriteOptions::overwrite", "-O/--overwrite"},
    Word{"WriteOptions::strict", "--strict"},
    Word{"WriteOptions::format", "--to"},
    Word{"ReadOptions::format", "--from"},
    Word{"ExportOptions::map", "`slamdb convert --map`"},
    Word{"GeographicOptions::origin, which georeferencing finds",
         "--origin LAT,LON,ALT, which `slamdb transform --georeference` finds and keeps beside its output"},
    Word{"Orbslam3WriteOptions::sanitize", "--sanitize"},
    Word{"Orbslam3ReadOptions::layout", "--layout"},
    Word{"ReadVocabularyFile", "`slamdb vocabulary show`"},
    Word{"ColmapReadOptions::database", "--database"},
    Word{"PutPoses puts", "`slamdb convert --onto` puts"},
    Word{"KeyFramePictures::files names", "--images names"},
    Word{"StoreReadOptions::accept_edits", "`slamdb recover --accept-edits`"},
    Word{"`InferLayout`", "`slamdb layouts infer`"},
    Word{"`DeriveLayoutOfFolder`", "`slamdb layouts from-source`"},
    Word{"SalvageAtlas", "`slamdb recover`"},
    Word{"`overwrite` of Store::Backup", "-O/--overwrite"},
    Word{"FitOptions::outlier_distance", "--robust"},
    Word{"FitOptions::max_time_difference", "--max-dt"},
    Word{"give FitOptions::time_offset, or let it be estimated (estimate_time_offset)",
         "give --time-offset, or --estimate-time-offset"},
    Word{"give EvaluationOptions::time_offset, or let it be estimated (estimate_time_offset)",
         "give --time-offset, or --estimate-time-offset"},
    Word{"EvaluationOptions::alignment", "--align"},
    Word{"EvaluationOptions::by_index", "--by-index"},
    Word{"EvaluationOptions::delta_tolerance", "--delta-tolerance"},
    Word{"EvaluationOptions::max_time_difference", "--max-dt"},
    Word{"the time unit of the read options", "--time-unit of `slamdb convert` and `slamdb transform`"},
    Word{"TrajectoryReadOptions::time_unit", "--time-unit"},
    Word{"TrajectoryReadOptions::times", "--times"},
    Word{"EstimatesOptions::body", "--body"},
    Word{"writing it as csv", "`slamdb convert` to a .csv file"},
    Word{"`OptimizeMaps`", "`slamdb optimize`"},
    Word{"OptimizeOptions::iterations", "--iterations"},
    Word{"OptimizeMethod::kFull adjusts", "--method full adjusts"},
    Word{"migrate it first", "run `slamdb migrate`"},
    Word{"MemoryLimit::spill_folder", "--spill"},
    Word{"MemoryLimit::bytes", "--memory"},
    Word{"RecoverOptions::rig", "--cameras"},
    Word{"keypoints `all`", "--keypoints all"},
    Word{"JoinOptions::force", "--force"},
    Word{"MergeOptions::force", "--force"},
    Word{"FindAtlasesOptions::recursive looks", "-r looks"},
    Word{"ListAtlases and CheckAtlas take", "`slamdb list` and `slamdb check` take"},
    Word{"AddOptions::name gives", "--as gives"},
    Word{"add it by itself, with AddOptions::name", "add it by itself, with --as"},
    Word{"AddOptions::name under", "--as under"},
    Word{"are aligned: `MergeAligned`", "are aligned: `slamdb merge --align`"},
    Word{"`MergeAtlases` brings", "`slamdb merge` without --base brings"},
    Word{"`JoinMaps`", "`slamdb merge --join`"},
    Word{"SameMap::kKeepFirst leaves", "--on-conflict keep-first leaves"},
    Word{"LocatePicturesOptions::camera tells that", "--camera tells the camera"},
    Word{"ConvertOptions::body with ConvertOptions::onto", "--body with --onto"},
    Word{"ConvertOptions::onto", "--onto"},
    Word{"it is `Convert ", "it is `slamdb convert "},
    Word{"from GeographicOptions::origin, and georeferencing makes",
         "from --origin; `slamdb transform --georeference` makes"},
    Word{"StampOptions::force", "--force"},
    Word{"StampOptions::vocabulary", "--vocabulary"},
    Word{"StampOptions::name", "--name"},
    Word{"StampOptions::checksum", "--checksum"},
    Word{"setting `Atlas::vocabulary`", "`slamdb vocabulary set`"},
    Word{"`CheckAtlas`", "`slamdb check`"},
    Word{"`Cull`", "`slamdb cull`"},
    Word{"`DropFragments`", "`slamdb fragments`"},
    Word{"`Extract`", "`slamdb extract`"},
    Word{"`MakeLandmarks`", "`slamdb landmarks from-points`"},
    Word{"`MakePoints`", "`slamdb landmarks to-points`"},
    Word{"`Formats` lists", "`slamdb version` lists"},
    Word{"`ReadRules`", "`slamdb check --list`"},
    Word{"`ReassignOrigins`", "`slamdb reassign-origin`"},
    Word{"`RecomputeWords`", "`slamdb vocabulary recompute`"},
    Word{"`RecoverAtlas`", "`slamdb recover`"},
    Word{"`Renumber`", "`slamdb renumber`"},
    Word{"`RepairAtlas`", "`slamdb repair`"},
};

// Members of reports that are names: they stay as they are, whatever they are called.
constexpr std::string_view kNames[] = {"after", "against", "atlas",   "before",   "below",      "folder",    "from",
                                       "input", "inputs",  "name",    "names",    "output",     "outputs",   "page",
                                       "path",  "paths",   "picture", "pictures", "provenance", "reference", "store"};

// Behind the string of a JSON text that begins at `at`.
std::size_t EndOfString(std::string_view json, std::size_t at) {
  for (++at; at < json.size() && json[at] != '"'; ++at)
    if (json[at] == '\\') ++at;
  return std::min(at + 1, json.size());
}

}  // namespace

std::span<const Word> Words() { return kWords; }

std::string InCommandWords(std::string_view sentence) {
  std::string text(sentence);
  for (const auto& [library, command] : kWords)
    for (std::size_t at = text.find(library); at != std::string::npos; at = text.find(library, at + command.size()))
      text.replace(at, library.size(), command);
  return text;
}

std::string ReportInCommandWords(std::string_view json) {
  std::string text;
  std::string_view key;
  for (std::size_t at = 0; at < json.size();) {
    const std::size_t begin = std::min(json.find('"', at), json.size());
    const std::size_t end = begin < json.size() ? EndOfString(json, begin) : begin;
    text.append(json.substr(at, begin - at));
    const std::string_view string = json.substr(begin, end - begin);
    const bool is_key = end < json.size() && json[end] == ':';
    if (is_key) key = string.substr(1, string.size() - 2);
    if (is_key || std::ranges::find(kNames, key) != std::end(kNames))
      text.append(string);
    else
      text.append(InCommandWords(string));
    at = end;
  }
  return text;
}

}  // namespace slamdb::cli
