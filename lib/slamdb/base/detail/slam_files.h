// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/file.h"

// Maps and vocabularies of other SLAM programs that no signature tells, but only what is in them.
namespace slamdb::detail {

bool IsColmapCameras(const Probe& probe);
bool IsColmapImages(const Probe& probe);
bool IsColmapPoints(const Probe& probe);
bool IsColmapFrames(const Probe& probe);
bool IsColmapCamerasText(const Probe& probe);
bool IsColmapImagesText(const Probe& probe);

bool IsOrbslam2Map(const Probe& probe);

// Which file of an osmap map it is, `keyframes`; empty: none.
std::string_view OsmapPart(const Probe& probe);

// Of DBoW2, as text and in its binary form.
bool IsVocabulary(const Probe& probe);
bool IsBinaryVocabulary(const Probe& probe);

std::optional<Recognized> RecognizeMrpt(std::string_view head);

}  // namespace slamdb::detail
