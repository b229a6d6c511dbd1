// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/formats.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <new>

#include "slamdb/base/error.h"
#include "slamdb/formats/csv/detail/csv.h"
#include "slamdb/formats/detail/losses.h"
#include "slamdb/formats/detail/recognize.h"
#include "slamdb/formats/mrpt/detail/mrpt.h"
#include "slamdb/formats/ndjson/detail/ndjson.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/pcd/detail/pcd.h"
#include "slamdb/formats/ply/detail/ply.h"
#include "slamdb/formats/sqlite/detail/store_format.h"
#include "slamdb/formats/trajectory/detail/trajectory.h"

namespace slamdb {
namespace {

constexpr std::string_view kStoreId = "store";

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

// The format with the longest suffix that the path ends with, the first of equals, among those that `has` asks for.
const Format* FormatBySuffix(const std::string& path, bool (*has)(const Format&)) {
  const std::string lower = Lower(path);
  const Format* best = nullptr;
  std::size_t longest = 0;
  for (const Format& format : Formats()) {
    if (!has(format)) continue;
    for (const std::string_view suffix : format.suffixes) {
      if (suffix.size() <= longest || !lower.ends_with(suffix)) continue;
      best = &format;
      longest = suffix.size();
    }
  }
  return best;
}

bool CanRead(const Format& format) { return format.read != nullptr; }
bool CanWrite(const Format& format) { return format.write != nullptr; }

// `orbslam3, store and tum` of those that can.
std::string Ids(bool (*has)(const Format&)) {
  std::string list;
  for (const Format& format : Formats())
    if (has(format)) list.append(list.empty() ? "" : ", ").append(format.id);
  return list;
}

void RequireReadable(const Format& format, const Location& location) {
  if (CanRead(format)) return;
  throw Error(location.path, "",
              "is a " + std::string(format.title) +
                  ", which slamdb writes but does not read, since it holds only a part "
                  "of an atlas; give the file it was made from (readable: " +
                  Ids(CanRead) + ")");
}

void RequireWritable(const Format& format, const Location& location) {
  if (CanWrite(format)) return;
  throw Error(location.path, "",
              "format `" + std::string(format.id) + "` can only be read; writable are " + Ids(CanWrite));
}

// `file#name` is for stores.
void RequirePlain(const Format& format, const Location& location) {
  if (location.name.empty() || format.id == kStoreId) return;
  throw Error(location.path, "",
              "`#" + location.name + "` names one atlas of a store, but " + std::string(format.title) +
                  " files hold one atlas without a name");
}

const Format& DetectFormat(const Location& location) {
  if (location.path == "-")
    throw Error(location.path, "",
                "standard input has no name to tell its format by; give --from (" + Ids(CanRead) + ")");
  const Probe probe = Probe::Of(location.path);
  for (const Format& format : Formats())
    if (format.sniff != nullptr && format.sniff(probe)) return format;
  if (const auto known = RecognizeOther(probe)) throw Error(location.path, "", *known);
  if (const Format* format = FormatBySuffix(location.path, CanRead)) return *format;
  throw Error(location.path, "", DescribeUnknown(probe));
}

}  // namespace

// In the order in which sniffers are asked: formats with a signature before those that are only lines of numbers.
std::span<const Format> Formats() {
  static const std::array kFormats = {
      kOrbslam3Format, kOrbslam3TextFormat, kStoreFormat,  kMrptFormat, kMrpt3Format,        kMrptTextFormat,
      kPlyFormat,      kPcdFormat,          kNdjsonFormat, kCsvFormat,  kCsvKeyFramesFormat, kCsvObservationsFormat,
      kEurocFormat,    kTumFormat,          kKittiFormat,
  };
  return kFormats;
}

const Format& FormatById(std::string_view id) {
  const auto formats = Formats();
  const auto found =
      std::find_if(formats.begin(), formats.end(), [id](const Format& format) { return format.id == id; });
  if (found == formats.end())
    throw Error("unknown format `" + std::string(id) + "`; known are " + Ids([](const Format&) { return true; }));
  return *found;
}

const Format& FormatOfInput(const Location& location, std::string_view id) {
  const Format& format = id.empty() ? DetectFormat(location) : FormatById(id);
  RequireReadable(format, location);
  RequirePlain(format, location);
  return format;
}

const Format& FormatOfOutput(const Location& location, std::string_view id) {
  const Format* format = id.empty() ? FormatBySuffix(location.path, CanWrite) : &FormatById(id);
  if (format == nullptr && location.path == "-")
    throw Error(location.path, "",
                "standard output has no suffix to tell the format by; give --to (" + Ids(CanWrite) + ")");
  if (format == nullptr) {
    std::string suffixes;
    for (const Format& known : Formats())
      for (const std::string_view suffix : known.suffixes)
        if (CanWrite(known) && suffixes.find(suffix) == std::string::npos)
          suffixes.append(suffixes.empty() ? "" : ", ").append(suffix);
    throw Error(location.path, "",
                "its suffix tells no format; use one of " + suffixes + ", or give --to (" + Ids(CanWrite) + ")");
  }
  RequireWritable(*format, location);
  RequirePlain(*format, location);
  return *format;
}

Atlas ReadAtlas(const Location& location, const ReadOptions& options, Notices& notices, std::string_view from) {
  const Format& format = FormatOfInput(location, from);
  try {
    return format.read(location, options, notices);
  } catch (const std::bad_alloc&) {
    throw Error(location.path, "", "the machine has too little memory left to read it");
  }
}

void WriteAtlas(const Atlas& atlas, const Location& location, const WriteOptions& options, Notices& notices,
                std::string_view to, bool strict) {
  const Format& format = FormatOfOutput(location, to);
  const std::vector<std::string> losses = LossesOf(atlas, format, options);
  if (strict && !losses.empty())
    throw Error(location.path, "", losses.front() + "; without --strict it is written all the same");
  for (const std::string& loss : losses) notices.Lose(loss);
  format.write(atlas, location, options, notices);
}

}  // namespace slamdb
