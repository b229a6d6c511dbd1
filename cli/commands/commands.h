// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/command.h"

// Each verb, defined in the file of its name.
namespace slamdb::cli {

extern const Command kInfo, kView, kShow, kDump, kPlot, kReport, kCheck, kConvert, kSynthesize, kVocabulary, kLayouts;
extern const Command kAlign, kMerge, kReassignOrigin, kRenumber;
extern const Command kExtract, kSplit, kCull, kShrink, kFragments;
extern const Command kRecover, kRepair;
extern const Command kOptimize, kCloseLoops;
extern const Command kEdit, kTransform, kDiff, kEvaluate, kLocate;
extern const Command kAdd, kList, kLog, kRestore, kTag, kBranch, kGc, kSync, kRemove, kStats, kVacuum, kBackup,
    kMigrate, kFleet;
extern const Command kLandmarksCommand;
extern const Command kHelp, kComplete, kCompletion, kVersion, kMan;

}  // namespace slamdb::cli
