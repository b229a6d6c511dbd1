// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/check.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/model/digest.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/osa_mutator.h"
#include "tests/fuzz/require.h"

namespace slamdb {
namespace {

// What a repair calls sound is sound, nothing is left to repair, and its journal takes all of it back.
void Repair(const Atlas& atlas) {
  Atlas repaired = atlas;
  const RepairReport report = RepairAtlas(repaired, {.threads = 1});
  CheckOptions options;
  options.threads = 1;
  const CheckReport check = CheckAtlas(repaired, options);
  fuzz::Require(report.sound() == check.ok(), "what is called sound is sound");
  std::uint64_t left = 0, found = 0;
  for (const Unrepaired& rule : report.left) left += rule.findings;
  for (const RuleResult& rule : check.results) found += rule.count;
  fuzz::Require(left == found, "the report names all that is left");
  Atlas again = repaired;
  fuzz::Require(RepairAtlas(again, {.journal = false, .threads = 1}).applied.empty(), "nothing is left to repair");
  UndoRepair(repaired, report.journal);
  fuzz::Require(HashOf(repaired, 1) == HashOf(atlas, 1), "the journal takes back what was changed");
}

// What is recovered is sound or said not to be, and can be written and read. Other layouts are fuzz_layout_infer's.
void Recover(Bytes bytes) {
  ReadOptions read;
  read.threads = 1;
  read.of<Orbslam3ReadOptions>().layout = "v1.0";
  Salvage salvage = SalvageBytes(bytes, read);
  const SalvageReport report = RecoverSalvage(salvage, {.threads = 1});
  CheckOptions options;
  options.threads = 1;
  fuzz::Require(report.untouched || report.recovery.sound() == CheckAtlas(salvage.atlas, options).ok(),
                "what is called sound is sound");
  fuzz::Require(!ToJson(report).empty(), "the losses can be told");
}

}  // namespace
}  // namespace slamdb

// Any atlas can be repaired, and any bytes recovered or refused.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const Bytes bytes = std::as_bytes(std::span(data, size));
  if (const std::optional<Atlas> atlas = fuzz::AtlasOf(bytes)) Repair(*atlas);
  fuzz::MayRefuse([&] { Recover(bytes); });
  return 0;
}
