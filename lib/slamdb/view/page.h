// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/base/wording.h"
#include "slamdb/checks/check.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/statistics.h"

// Atlases to look at: a page for a browser that carries its data with it, in one file.
namespace slamdb {

// A row of the page's panel: `points`, `3,162`.
struct ViewFact {
  std::string label, value;
};

// An atlas to show. Refers to it: it must outlive the making of the page.
struct ViewInput {
  const Atlas* atlas = nullptr;
  std::string name;    // as the page calls it
  std::string format;  // its title; empty: not told
  // What the panel says of it, for people. May be empty.
  std::function<std::vector<ViewFact>(const AtlasStatistics&)> facts;
  std::vector<RuleResult> findings = {};  // shown besides those of the check, all of them
};

// An atlas as it was read from `path`, with what InfoSections tells of it; in memory alone where that is empty.
// `format`: of the file; null: not told.
[[nodiscard]] SLAMDB_EXPORT ViewInput ViewInputOf(const Atlas& atlas, const std::string& path, const Format* format,
                                                  const Wording& wording = {});

// What a report found, to be shown in place: of ToJson(CheckedFile) the findings in `input`, or in the only atlas that
// it is of; of ToJson(ThreeWayReport) the conflicts, a rule an aspect.
//
// Throws Error: kUsage, kNotFound for other reports, those of other atlases and of merges without a base; kDamaged for
// what is no report; ReadFindings also as WholeFile does.
// Cost: linear. Thread-safe.
[[nodiscard]] SLAMDB_EXPORT std::vector<RuleResult> ParseFindings(std::string_view json, const std::string& input = {});
[[nodiscard]] SLAMDB_EXPORT std::vector<RuleResult> ReadFindings(const std::string& path,
                                                                 const std::string& input = {});

// Which keypoints the page holds.
enum class ViewKeypoints {
  kAuto,     // all, or those that see a point, or none: the most that fits into kViewAllowance
  kAll,      //
  kMatched,  // those that see a point
  kNone,
};

// How several atlases lie when the page opens.
enum class ViewLayout { kOverlay, kSideBySide };

// What a page may take, beside its own markup, style and script: bytes of each point, and of all else.
inline constexpr std::uint64_t kViewBytesPerPoint = 12, kViewAllowance = 8'000'000;

struct ViewOptions {
  std::string title;  // empty: the names of the atlases
  ViewKeypoints keypoints = ViewKeypoints::kAuto;
  ViewLayout layout = ViewLayout::kOverlay;
  bool normals = false;
  bool check = true;              // hold the rules against the atlases, and show what they find in place
  bool notes = false;             // those of severity note, too, which healthy atlases have
  std::size_t max_findings = 50;  // shown of each rule
  bool diff = false;              // show what the second of two atlases changed of the first
  int threads = 0;                // 0: every core
  Progress progress;              // may be empty
  Wording wording;                // of findings, and of what is left out; may be empty
};

// What a page holds.
struct ViewReport {
  std::uint64_t bytes = 0;       // of the page
  std::uint64_t fixed_part = 0;  // of them markup, style and script, which are in every page
  std::uint64_t maps = 0, keyframes = 0, points = 0, keypoints = 0;
  std::uint64_t findings = 0;         // in the page
  std::vector<std::string> left_out;  // a sentence each: what of the atlases is not in the page, and how it would be
};

struct ViewPage {
  std::string html;
  ViewReport report;
};

// Whether this library has the page built in; esbuild is what building it needs.
[[nodiscard]] SLAMDB_EXPORT bool HasViewPage();
// Throws Error (kUnsupported), saying what to install, when it has not.
SLAMDB_EXPORT void RequireViewPage();

// One self-contained HTML page with the points, keyframes and edges of all atlases, for browsers with WebGL 2.
// It loads nothing, from nowhere: a content security policy in it forbids that, and all scripts but its own.
// What atlases call things is in it as text alone. How the data lies in it: schema/view.md.
// Atlases may hold anything; equal input gives equal bytes whatever the threads.
//
// Throws Error: kUnsupported as RequireViewPage; kUsage for a diff of other than two atlases.
// Cost: linear. Thread-safe.
[[nodiscard]] SLAMDB_EXPORT ViewPage MakeViewPage(std::span<const ViewInput> inputs, const ViewOptions& options = {});

// As schema/view.schema.json describes it; `output` names the file.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const ViewReport& report, std::span<const std::string> inputs,
                                               const std::string& output);

}  // namespace slamdb
