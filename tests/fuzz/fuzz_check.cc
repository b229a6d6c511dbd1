// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/check.h"
#include "slamdb/checks/report.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/osa_mutator.h"
#include "tests/fuzz/require.h"

// Any atlas can be checked, and its findings told in every form.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const std::optional<Atlas> atlas = fuzz::AtlasOf(std::as_bytes(std::span(data, size)));
  if (!atlas) return 0;
  CheckOptions options;
  options.threads = 1;
  options.vocabulary_words = 1000;
  const CheckedFile file{.name = "fuzz", .report = CheckAtlas(*atlas, options), .failure = {}};
  const std::span files(&file, 1);
  std::uint64_t results = 0;
  for (const RuleResult& result : file.report.results) {
    fuzz::Require(result.count >= result.findings.size() && !result.findings.empty(), "a result has its findings");
    results += result.count;
  }
  fuzz::Require(results == file.report.Count(Severity::kError) + file.report.Count(Severity::kWarning) +
                               file.report.Count(Severity::kNote),
                "findings are counted once");
  for (const std::string& text : {TextReport(files), ToJson(files), JUnitReport(files), SarifReport(files, "0")})
    fuzz::Require(!text.empty(), "every report says something");
  return 0;
}
