// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/unread.h"

#include <string_view>

#include "slamdb/base/detail/concat.h"

namespace slamdb::colmap {
namespace {

using detail::Concat;
using detail::Counted;

void TellOfDescriptors(const Unread& unread, bool has_database, Notices& notices) {
  if (unread.descriptors > 0)
    notices.Warn(Concat(Counted(unread.descriptors, "keypoint"),
                        " have descriptors that are not the 32 bytes of ORB: they are kept, and points have none"));
  if (unread.undescribed > 0)
    notices.Warn(Concat(Counted(unread.undescribed, "keypoint"), " and all points have no ORB descriptors: ",
                        has_database ? "the database has none of them"
                                     : "a model has none; ColmapReadOptions::database names the database that has"));
  if (unread.strangers > 0)
    notices.Warn(Concat("the database has other keypoints, or another name, or nothing for ",
                        Counted(unread.strangers, "image")));
}

}  // namespace

void Tell(const Unread& unread, bool has_database, bool with_descriptors, Notices& notices) {
  const auto lose = [&](std::uint64_t count, std::string_view noun, std::string_view why) {
    if (count > 0) notices.Lose(Concat(Counted(count, noun), " ", why));
  };
  lose(unread.images, "image", "left out: their id is there twice, or their camera is not there");
  lose(unread.points, "point", "left out: their id is there twice");
  lose(unread.unseen, "point", "left out, which no image sees: ORB-SLAM3 crashes on such");
  lose(unread.keypoints, "keypoint",
       "see nothing now: their point is not there, or the image has another keypoint of it");
  lose(unread.track_elements, "element",
       "of tracks left out: their image or keypoint is not there, or sees another point");
  lose(unread.colors, "point", "lose their colours, which an atlas has no place for");
  lose(unread.names, "image", "lose their names, which are no times: timestamps are their order, in seconds");
  lose(unread.undistorted, "keypoint",
       "are of lenses that slamdb has not, and are read where a lens without distortion would see them");
  if (unread.rights > 0)
    notices.Warn(Concat(Counted(unread.rights, "image"),
                        " named as right ones of fisheye pairs, which no rig of the model makes pairs: each is a "
                        "keyframe of its own. COLMAP before 3.12 knows nothing of rigs"));
  if (unread.rigs > 0)
    notices.Warn(
        "rigs that are no pair of fisheye cameras: each of their images is a keyframe of its own, at its pose");
  if (unread.moved_models > 0) notices.Warn("several models had the same ids: those of later ones were moved up");
  if (with_descriptors) TellOfDescriptors(unread, has_database, notices);
}

}  // namespace slamdb::colmap
