// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/convert.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <utility>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/file_size.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/put_poses.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/formats/dry_run.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/geographic/options.h"
#include "slamdb/formats/keyframe_poses.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/results.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/many/selected.h"
#include "slamdb/model/content.h"
#include "slamdb/model/geodetic.h"
#include "slamdb/model/statistics.h"
#include "slamdb/pictures/picture_list.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Counted;

void RefuseLosses(const Notices& notices) {
  for (const Notice& notice : notices.items())
    if (notice.kind == Notice::Kind::kLoss)
      throw Error(ErrorKind::kNotPossible, notice.text + "; WriteOptions::strict refuses that");
}

// Keyframes, times or a box cut through maps, whose references then lead nowhere; whole maps leave none.
bool CutsThroughMaps(Selection selection) {
  selection.map.reset();
  return !selection.everything();
}

const Format* FormatOf(const HeldSource& input, const ReadOptions& read) {
  return read.format.empty() ? FindFormatOfInput(input) : &FormatById(read.format);
}

bool IsOfTrajectory(const HeldSource& input, const ReadOptions& read) {
  const Format* format = FormatOf(input, read);
  return format != nullptr && IsTrajectory(*format);
}

// Nothing in the maps tells whether the frame is one on earth.
void WarnOfFrames(const Atlas& atlas, Notices& notices) {
  notices.Warn(
      "the frame of the maps is taken as east, north and up in metres from GeographicOptions::origin, and "
      "georeferencing "
      "makes it so");
  for (const Map& map : atlas.maps)
    if (!IsMetric(map)) notices.Warn(ToString(map.id) + " has no scale, of one camera: its sizes are not in metres");
}

void WarnOfMapsElsewhere(const Atlas& atlas, const Georeference& where, Notices& notices) {
  for (const Map& map : atlas.maps)
    if (std::ranges::find(where.maps, map.id) == where.maps.end() && !map.keyframes.empty())
      notices.Warn(ToString(map.id) + " was not georeferenced, and is not where it is shown");
}

// One conversion.
class Conversion {
 public:
  Conversion(const Location& output, const ConvertOptions& options, Notices& notices)
      : output_(output),
        options_(options),
        write_(options.write),
        format_(FormatOfOutput(output, options.write.format)),
        notices_(notices) {
    if (options.dry_run) write_.of<DryRunOptions>().bytes = &would_have_;
    if (!options.dry_run && format_.is_export && output.name.empty()) RefuseAtlas(output.path);
  }

  // A trajectory becomes a trajectory without an atlas between, in whose single precision digits would be lost. The
  // body is known to atlases alone.
  bool IsOfTrajectories(const HeldSource& input) const {
    return IsTrajectory(format_) && !options_.body && options_.onto.empty() && IsOfTrajectory(input, options_.read);
  }

  Converted ConvertPoses(const HeldSource& input) {
    ConvertReport report;
    report.format = format_.id;
    report.keyframes = ConvertTrajectory(input, output_, options_.read, write_, &notices_);
    return Finish(std::move(report));
  }

  Converted ConvertAtlas(const HeldSource& input, const std::string& name) {
    std::optional<PutInto> put;
    Atlas atlas = options_.onto.empty() ? ReadAtlas(input, options_.read, &notices_) : PutOnto(input, name, put);
    const Format* from = options_.onto.empty() ? FormatOf(input, options_.read) : FindFormatOfInput(options_.onto);
    RefuseEmptySelection(atlas, name, input, options_.read);
    return Write(std::move(atlas), from, std::move(put));
  }

  // Of an atlas that was read from a file of that format; null: of none.
  Converted Write(Atlas atlas, const Format* from, std::optional<PutInto> put = {}) {
    InputSubstance inputs;
    inputs.Add(atlas, from);
    const bool as_fork = options_.write.of<Orbslam3WriteOptions>().layout.has_value();
    LoseUseToOrbslam3(atlas, inputs, format_, as_fork, notices_);
    const bool sound = !options_.sanitize || Repair(atlas);
    RefuseEmptyResult(atlas, inputs, output_.ToString(), format_, /*dry_run=*/false, notices_);
    if (write_.strict) RefuseLosses(notices_);
    WarnOfParts(atlas);
    if (options_.where) LayOnEarth(atlas);
    ConvertReport report = ConvertReportOf(atlas, format_);
    report.put = std::move(put);
    WriteAtlas(atlas, output_, write_, &notices_);
    Converted converted = Finish(std::move(report));
    converted.sound = sound;
    return converted;
  }

 private:
  // Graphs and trajectories are what comes onto a map.
  void RequireMapOnto(const Atlas& atlas, const std::string& name) const {
    const auto is_map = [](const Map& map) {
      return !map.points.empty() || std::ranges::any_of(map.keyframes, [](const KeyFrame& keyframe) {
        return !keyframe.features.map_points.empty();
      });
    };
    if (std::ranges::any_of(atlas.maps, is_map)) return;
    throw Error(
        ErrorKind::kNotPossible, options_.onto, "",
        "holds neither points nor keypoints: ConvertOptions::onto names the map, and the input the poses that go "
        "into it. The other way round it is `Convert " +
            options_.onto + " " + output_.ToString() + " ConvertOptions::onto " + name + "`");
  }

  // The atlas of `onto` with the poses of the input.
  Atlas PutOnto(const HeldSource& poses, const std::string& name, std::optional<PutInto>& into) {
    if (const std::string why = WhyNotOnto(poses, options_); !why.empty()) throw Error(ErrorKind::kUsage, why);
    Atlas atlas = ReadAtlas(Location(options_.onto), options_.read_onto, &notices_);
    RequireMapOnto(atlas, name);
    PutPosesOptions places{.of_body = options_.body, .threads = options_.read.threads};
    Notices of_poses;
    const std::vector<KeyFramePose> found =
        ReadKeyFramePoses(poses, options_.read, &of_poses, &places.points, &places.origin);
    AddOfPoses(of_poses, name);
    const PutPosesReport put = PutPoses(atlas, found, places);
    into = {.keyframes = put.keyframes, .points = put.points, .largest_shift = put.largest_shift};
    notices_.Note(Concat("put ", Counted(put.keyframes, "pose"), " and ", Counted(put.points, "point"), " into ",
                         Location(options_.onto).ToString(), "; the largest shift of a camera is ",
                         detail::Digits(put.largest_shift, 3)));
    for (const std::string& warning : put.warnings) notices_.Warn(warning);
    for (const std::string& loss : put.losses) notices_.Lose(loss);
    return atlas;
  }

  // What there is to say of the poses' source is about what is not put: nothing of the output is lost by it.
  void AddOfPoses(const Notices& of_poses, const std::string& source) {
    for (const Notice& notice : of_poses.items()) {
      if (notice.kind == Notice::Kind::kWarning) notices_.Warn(notice.text);
      if (notice.kind == Notice::Kind::kLoss) notices_.Note(source + ": " + notice.text);
    }
  }

  // Returns whether no error is left.
  bool Repair(Atlas& atlas) {
    const RepairReport report = RepairAtlas(atlas, {.journal = false, .threads = write_.threads});
    for (const AppliedFix& fix : report.applied)
      notices_.Warn("repaired: " + fix.title + " (" + Counted(fix.changes, "change") + ")");
    for (const std::string& error : ErrorsOf(report.left)) notices_.Warn(error);
    return report.sound();
  }

  void WarnOfParts(const Atlas& atlas) {
    const Selection& selection = options_.read.selection;
    if (CutsThroughMaps(selection) && HasAny(format_.writes, Content::kObservations))
      notices_.Warn("only the selected part is written: what refers to the rest leads nowhere");
    if (selection.has_keyframe_range() && SubstanceOf(atlas).landmarks)
      notices_.Warn("landmarks belong to no keyframe: the ranges of keyframes and times leave out none of them");
  }

  void LayOnEarth(const Atlas& atlas) {
    if (options_.where->maps.empty())  // as asked for
      WarnOfFrames(atlas, notices_);
    else
      WarnOfMapsElsewhere(atlas, *options_.where, notices_);
    write_.of<GeographicOptions>().origin = options_.where->origin;
  }

  Converted Finish(ConvertReport report) const {
    const bool is_one_file = !format_.needs_path && !format_.is_folder;
    if (is_one_file && !options_.dry_run) report.bytes = detail::FileSize(output_.path);
    if (is_one_file && options_.dry_run && !format_.named && output_.path != "-" && !IsSpecialFile(output_.path))
      report.bytes = would_have_;
    report.Add(notices_);
    return {.report = std::move(report)};
  }

  const Location& output_;
  const ConvertOptions& options_;
  WriteOptions write_;
  const Format& format_;
  Notices& notices_;
  std::uint64_t would_have_ = 0;  // bytes, in a dry run
};

}  // namespace

std::string WhyNotOnto(const HeldSource& input, const ConvertOptions& options) {
  if (options.onto.empty()) return {};
  if (options.body && !IsOfTrajectory(input, options.read))
    return "ConvertOptions::body with ConvertOptions::onto is for trajectories only; the poses of other inputs are of "
           "cameras";
  if (!options.read.selection.everything())
    return "ConvertOptions::onto takes all poses of the input: it goes with no selection";
  return {};
}

Converted Convert(const HeldSource& input, const std::string& name, const Location& output,
                  const ConvertOptions& options, Notices& notices) {
  Conversion conversion(output, options, notices);
  return conversion.IsOfTrajectories(input) ? conversion.ConvertPoses(input) : conversion.ConvertAtlas(input, name);
}

Converted Convert(const Atlas& atlas, const Location& output, const ConvertOptions& options, Notices& notices) {
  return Conversion(output, options, notices)
      .Write(atlas, atlas.encoding.text ? &FormatById("orbslam3-text") : nullptr);
}

KeyFramePictures FindKeyFramePictures(const std::string& named) {
  namespace fs = std::filesystem;
  std::error_code missing;
  if (!fs::exists(named, missing)) {
    errno = ENOENT;
    throw SystemError(named, "cannot open");
  }
  const std::array<std::string, 1> names = {named};
  const fs::path folder = fs::is_directory(named, missing) ? fs::path(named) : fs::path(named).parent_path();
  return {.files = FindPictures(names), .folder = folder.empty() ? "." : folder.string()};
}

std::optional<Georeference> WhereOnEarth(const std::string& origin, const std::string& input, const Format& output,
                                         Notices& notices) {
  if (!output.is_on_globe) return std::nullopt;
  if (origin.empty()) {
    const std::optional<Georeference> found = FindGeoreference(input);
    if (found) notices.Note("the origin is that of " + GeoreferencePath(input));
    return found;
  }
  const Geodetic place = ParseGeodetic(origin);
  if (std::abs(place.longitude) > 180)
    notices.Note(Concat("the longitude ", place.longitude, " is written as ", std::remainder(place.longitude, 360)));
  return Georeference{place, {}};
}

}  // namespace slamdb
