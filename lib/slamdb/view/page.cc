// SPDX-License-Identifier: BSD-3-Clause
// 1. The atlases become one scene (scene.h), and the scene columns of numbers (encode.h).
// 2. Columns are packed (pack.h), of keypoints as many as the page has room for.
// 3. The header (header.h) says what the rest means; markup, style and script stand round it all.
#include "slamdb/view/page.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/markup.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/view/detail/encode.h"
#include "slamdb/view/detail/header.h"
#include "slamdb/view/detail/pack.h"
#include "slamdb/view/detail/parts.h"

namespace slamdb {
namespace view {
namespace {

using detail::Concat;
using detail::Thousands;

std::uint64_t SizeOf(const std::vector<std::string>& blocks) {
  std::uint64_t size = 0;
  for (const std::string& block : blocks) size += block.size();
  return size;
}

void Append(std::vector<std::string>& blocks, std::vector<std::string> more) {
  blocks.insert(blocks.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

void Append(Columns& columns, Columns more) {
  columns.insert(columns.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::string Policy() {
  return "default-src 'none'; script-src " + detail::PolicySource(kPageScript) + "; style-src " +
         detail::PolicySource(kPageStyle) +
         "; img-src data: blob:; connect-src 'none'; base-uri 'none'; form-action 'none'";
}

// The page in two halves, before and behind the data.
struct Frame {
  std::string before, behind;
  std::uint64_t size() const { return before.size() + behind.size(); }
};

Frame FrameOf(const std::string& title) {
  const std::array<std::pair<std::string_view, std::string>, 4> values = {{{"{{TITLE}}", detail::EscapedMarkup(title)},
                                                                           {"{{CSP}}", Policy()},
                                                                           {"{{STYLE}}", std::string(kPageStyle)},
                                                                           {"{{SCRIPT}}", std::string(kPageScript)}}};
  constexpr std::string_view kData = "{{DATA}}";
  Frame frame;
  std::string* half = &frame.before;
  std::string_view rest = kPageTemplate;
  for (std::size_t at = rest.find("{{"); at != std::string_view::npos; at = rest.find("{{")) {
    half->append(rest.substr(0, at));
    rest.remove_prefix(at);
    std::size_t taken = 0;
    if (rest.starts_with(kData)) {
      half = &frame.behind;
      taken = kData.size();
    }
    for (const auto& [name, value] : values)
      if (rest.starts_with(name)) {
        half->append(value);
        taken = name.size();
      }
    if (taken == 0) half->append(rest.substr(0, taken = 2));
    rest.remove_prefix(taken);
  }
  half->append(rest);
  return frame;
}

// What a keypoint takes in a page, about: it need not be packed to see that there are too many.
constexpr double kLeastBytesPerKeypoint = 4;

class PageMaker {
 public:
  PageMaker(std::span<const ViewInput> inputs, const ViewOptions& options)
      : options_(options), scene_(inputs), steps_(options.progress, "making the page", 6), header_{.options = options} {
    header_.title = options.title.empty() ? NamesOf(inputs) : options.title;
    frame_ = FrameOf(header_.title);
    header_.fixed_part = frame_.size();
  }

  ViewPage Make() {
    EncodeScene();
    AddKeypoints();
    Check();
    TellLandmarks();
    Columns header = {{"header", HeaderJson(scene_, header_)}};
    return Assemble(PackColumns(header, options_.threads));
  }

 private:
  static std::string NamesOf(std::span<const ViewInput> inputs) {
    std::string names;
    for (const ViewInput& input : inputs) names += (names.empty() ? "" : ", ") + input.name;
    return names;
  }

  void EncodeScene() {
    PointColumns points = EncodePoints(scene_, options_.normals, options_.threads);
    steps_.Next();
    KeyFrameColumns keyframes = EncodeKeyFrames(scene_);
    header_.error_max = points.error_max;
    header_.origin_of_time = keyframes.origin_of_time;
    Columns columns = std::move(points.columns);
    Append(columns, std::move(keyframes.columns));
    Append(columns, EncodeEdges(scene_));
    if (options_.diff) {
      header_.diff = CompareAtlases(scene_, options_.threads);
      Append(columns, EncodeDiff(*header_.diff));
    }
    steps_.Next();
    blocks_ = PackColumns(columns, options_.threads);
    steps_.Next();
  }

  // Those keypoints, packed, unless they are more than there is room for.
  std::optional<std::vector<std::string>> Keypoints(bool matched_only, std::uint64_t count) {
    const bool bounded = options_.keypoints == ViewKeypoints::kAuto;
    const std::uint64_t most = kViewBytesPerPoint * scene_.points() + kViewAllowance;
    const std::uint64_t taken = SizeOf(blocks_);
    const std::uint64_t room = most > taken ? most - taken : 0;
    if (bounded && kLeastBytesPerKeypoint * static_cast<double>(count) > static_cast<double>(room)) return std::nullopt;
    std::vector<std::string> blocks =
        PackColumns(EncodeKeypoints(scene_, matched_only, options_.threads), options_.threads);
    if (bounded && SizeOf(blocks) > room) return std::nullopt;
    return blocks;
  }

  void AddKeypoints() {
    const KeypointCounts counts = CountKeypoints(scene_, options_.threads);
    const ViewKeypoints wanted = options_.keypoints;
    std::optional<std::vector<std::string>> blocks;
    if (wanted == ViewKeypoints::kAuto || wanted == ViewKeypoints::kAll) {
      blocks = Keypoints(false, counts.all);
      if (blocks) report_.keypoints = counts.all;
    }
    if (!blocks && (wanted == ViewKeypoints::kAuto || wanted == ViewKeypoints::kMatched)) {
      blocks = Keypoints(true, counts.matched);
      if (blocks) report_.keypoints = counts.matched;
    }
    if (blocks) Append(blocks_, std::move(*blocks));
    steps_.Next();
    if (wanted == ViewKeypoints::kAuto && report_.keypoints < counts.all)
      LeaveOut(Concat(Thousands(counts.all - report_.keypoints), " of ", Thousands(counts.all),
                      " keypoints, to keep the page small; keypoints `all` keeps them"));
  }

  void Check() {
    std::vector<CheckReport> reports;
    for (const SceneAtlas& atlas : scene_.atlases()) {
      CheckReport report;
      if (options_.check)
        report = CheckAtlas(atlas.atlas(), {.max_findings = options_.max_findings, .threads = options_.threads});
      else
        report.statistics = ComputeStatistics(atlas.atlas(), options_.threads);
      std::ranges::copy(atlas.input.findings, std::back_inserter(report.results));
      header_.statistics.push_back(report.statistics);
      reports.push_back(std::move(report));
    }
    header_.findings = PlaceFindings(scene_, reports, options_.notes ? Severity::kNote : Severity::kWarning);
    steps_.Next();
  }

  void LeaveOut(const std::string& sentence) { header_.left_out.push_back(Worded(sentence, options_.wording)); }

  void TellLandmarks() {
    std::uint64_t landmarks = 0;
    for (const SceneAtlas& atlas : scene_.atlases())
      for (const Map& map : atlas.atlas().maps) landmarks += map.landmarks.size();
    if (landmarks > 0) LeaveOut(detail::Counted(landmarks, "landmark") + " of MRPT; `MakePoints` makes points of them");
  }

  ViewPage Assemble(const std::vector<std::string>& header) {
    ViewPage page;
    report_.bytes = frame_.size() + SizeOf(header) + SizeOf(blocks_);
    page.html.reserve(report_.bytes);
    page.html += frame_.before;
    for (const std::string& block : header) page.html += block;
    for (const std::string& block : blocks_) page.html += block;
    page.html += frame_.behind;
    report_.fixed_part = frame_.size();
    report_.maps = scene_.maps();
    report_.keyframes = scene_.keyframes();
    report_.points = scene_.points();
    report_.findings = header_.findings.findings.size();
    report_.left_out = header_.left_out;
    page.report = std::move(report_);
    steps_.Next();
    return page;
  }

  const ViewOptions& options_;
  Scene scene_;
  detail::Steps steps_;
  Header header_;
  Frame frame_;
  std::vector<std::string> blocks_;
  ViewReport report_;
};

}  // namespace
}  // namespace view

bool HasViewPage() { return !view::kPageTemplate.empty(); }

void RequireViewPage() {
  if (!HasViewPage())
    throw Error(ErrorKind::kUnsupported,
                "this slamdb was built without the page of its viewer, for which esbuild was missing; install it "
                "(`apt-get install esbuild`) and build slamdb again");
}

ViewPage MakeViewPage(std::span<const ViewInput> inputs, const ViewOptions& options) {
  RequireViewPage();
  if (options.diff && inputs.size() != 2)
    throw Error(ErrorKind::kUsage, detail::Concat("a diff is of two atlases, and not of ", inputs.size()));
  return view::PageMaker(inputs, options).Make();
}

std::string ToJson(const ViewReport& report, std::span<const std::string> inputs, const std::string& output) {
  detail::Json json = detail::ReportHead("view");
  json["inputs"] = detail::Json(std::vector<std::string>(inputs.begin(), inputs.end()));
  json["output"] = detail::TextOrNull(output);
  json["bytes"] = report.bytes;
  json["fixed_part"] = report.fixed_part;
  json["maps"] = report.maps;
  json["keyframes"] = report.keyframes;
  json["points"] = report.points;
  json["keypoints"] = report.keypoints;
  json["findings"] = report.findings;
  json["left_out"] = report.left_out;
  return detail::JsonText(json);
}

}  // namespace slamdb
