// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/content.h"

// What a verb is about to give, held against what it got: for the command and for Python.
namespace slamdb {

// What the inputs of a verb have some of, all together: with what is flagged bad, and without; and whether all are
// archives of ORB-SLAM3.
struct SLAMDB_EXPORT InputSubstance {
  Substance all, good;
  bool archives_alone = true;
  // `format`: of the file; null where nothing tells it.
  void Add(const Atlas& atlas, const Format* format);
};

// What is no map of ORB-SLAM3, written as one, is a loss, of every verb. Its own files are given back as they are, and
// a fork's descriptors are for the fork. `as_fork`: it is written in a layout of a fork.
SLAMDB_EXPORT void LoseUseToOrbslam3(const Atlas& atlas, const InputSubstance& inputs, const Format& output,
                                     bool as_fork, Notices& notices);

// The one guard against an empty result that passes for a success, for every verb that writes an atlas. Throws Error
// when the output would hold nothing of what it is for (keyframes and points; of an export what that format is of)
// though the inputs have some, or none of what the result has; warns when nothing was there, or nothing is written.
SLAMDB_EXPORT void RefuseEmptyResult(const Atlas& result, const InputSubstance& inputs, const std::string& output,
                                     const Format& format, bool dry_run, Notices& notices);

// What is no atlas (a page, a picture, a report) never replaces one: throws Error when the file reads as an atlas.
SLAMDB_EXPORT void RefuseAtlas(const std::string& output);

}  // namespace slamdb
