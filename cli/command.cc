// SPDX-License-Identifier: BSD-3-Clause
#include "cli/command.h"

#include <algorithm>
#include <array>

#include "cli/commands/commands.h"

namespace slamdb::cli {

// The list of verbs. A new verb is a file in commands/, a line in commands/commands.h and a line here.
std::span<const Command* const> Commands() {
  static constexpr std::array kCommands = {
      &kInfo,       &kView,    &kShow,     &kDump,           &kPlot,
      &kReport,     &kCheck,   &kConvert,  &kSynthesize,     &kVocabulary,
      &kLayouts,    &kExtract, &kSplit,    &kCull,           &kShrink,
      &kFragments,  &kAlign,   &kMerge,    &kReassignOrigin, &kRenumber,
      &kRepair,     &kRecover, &kEdit,     &kTransform,      &kOptimize,
      &kCloseLoops, &kDiff,    &kEvaluate, &kLocate,         &kLandmarksCommand,
      &kAdd,        &kList,    &kLog,      &kRestore,        &kTag,
      &kBranch,     &kGc,      &kSync,     &kRemove,         &kStats,
      &kVacuum,     &kBackup,  &kMigrate,  &kFleet,          &kHelp,
      &kCompletion, &kVersion, &kMan,      &kComplete,
  };
  return kCommands;
}

std::string_view TitleOf(Group group) {
  static constexpr std::array<std::string_view, 7> kTitles = {
      "look", "check and repair", "change", "combine", "convert", "store", "more"};
  return kTitles[static_cast<std::size_t>(group)];
}

const Command* FindCommand(std::string_view name) {
  const auto commands = Commands();
  const auto found = std::ranges::find(commands, name, &Command::name);
  return found == commands.end() ? nullptr : *found;
}

}  // namespace slamdb::cli
