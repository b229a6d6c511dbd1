// SPDX-License-Identifier: BSD-3-Clause
#include "cli/selected.h"

#include "slamdb/base/error.h"
#include "slamdb/edit/part/select.h"
#include "slamdb/model/content.h"

namespace slamdb::cli {

void RefuseEmptySelection(const Atlas& atlas, const std::string& name, const HeldSource& input,
                          const ReadOptions& read) {
  const Selection& selection = read.selection;
  if (selection.map && atlas.maps.empty())
    throw Error(ErrorKind::kNotFound, name, "", "has no " + ToString(*selection.map));
  const Substance selected = SubstanceOf(atlas, /*with_bad=*/true);
  if (selected.landmarks) return;
  if ((selection.has_keyframe_range() && !selected.keyframes) || (selection.box && !selected.points))
    throw Error(ErrorKind::kNotFound, name, "",
                selected.keyframes ? "has no points in the box" : MissText(selection, input, read));
}

Atlas ReadPartToShow(const std::string& name, const HeldSource& input, const ReadOptions& read, Notices& notices) {
  Atlas atlas = ReadAtlas(input, read, &notices);
  RefuseEmptySelection(atlas, name, input, read);
  if (!read.selection.has_keyframe_range() || !SubstanceOf(atlas, /*with_bad=*/true).keyframes) return atlas;
  const Subset seen = Select(AtlasIndex(atlas));  // observations of keyframes that were not read lead nowhere
  KeepSubset(atlas, seen, read.threads);
  return atlas;
}

}  // namespace slamdb::cli
