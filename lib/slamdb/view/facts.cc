// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include "slamdb/formats/formats.h"
#include "slamdb/formats/info.h"
#include "slamdb/formats/info_sections.h"
#include "slamdb/view/page.h"

namespace slamdb {
namespace {

std::vector<ViewFact> FactsOf(const AtlasInfo& info, const Wording& wording) {
  std::vector<ViewFact> facts;
  for (const InfoSection& section : InfoSections(info, wording)) {
    if (!section.heading.label.empty()) facts.push_back({section.heading.label, section.heading.value});
    for (const InfoRow& row : section.rows) facts.push_back({row.label, row.value});
  }
  return facts;
}

}  // namespace

ViewInput ViewInputOf(const Atlas& atlas, const std::string& path, const Format* format, const Wording& wording) {
  const auto facts = [&atlas, path, format, wording](const AtlasStatistics& statistics) {
    AtlasInfo info = InfoOf(atlas, format != nullptr ? *format : FormatById("orbslam3"), path);
    if (format == nullptr) info.format_title.clear();
    info.statistics = statistics;
    return FactsOf(info, wording);
  };
  return {.atlas = &atlas,
          .name = path.empty() ? "atlas" : std::filesystem::path(path).filename().string(),
          .format = format != nullptr ? std::string(format->title) : std::string(),
          .facts = facts};
}

}  // namespace slamdb
