// SPDX-License-Identifier: BSD-3-Clause
// live_map_point: the life of map points with ORB-SLAM3's class API: create, observe, compute, predict, cull, replace.
#include <cstdio>
#include <list>
#include <vector>

#include "slamdb/live/atlas.h"
#include "slamdb/live/culling.h"
#include "slamdb/live/frame.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/derive.h"

using namespace slamdb::live;  // NOLINT(google-build-using-namespace): the names of ORB-SLAM3

namespace {

// A point 4 m in front of the first camera, and where a camera at `x` sees it.
const Eigen::Vector3f kPosition(0.5F, 0, 4);

slamdb::KeyFrame ImageFrom(const GeometricCamera& camera, const slamdb::Rigid3f& camera_from_world) {
  slamdb::KeyFrame image;
  image.camera_from_world = camera_from_world;
  image.pyramid = slamdb::DerivePyramid(8, 1.2F);
  image.bounds = {.grid_columns = 64,
                  .grid_rows = 48,
                  .inverse_cell_width = 0.1F,
                  .inverse_cell_height = 0.1F,
                  .min_x = 0,
                  .min_y = 0,
                  .max_x = 640,
                  .max_y = 480};
  const Eigen::Vector2f pixel = camera.project(Eigen::Vector3f(camera_from_world * kPosition));
  const slamdb::Keypoint keypoint{
      .angle = 0, .response = 50, .size = 31, .x = pixel.x(), .y = pixel.y(), .class_id = -1, .octave = 2};
  image.features.count = 1;
  image.features.keypoints = image.features.undistorted = {keypoint};
  image.features.right_x = image.features.depth = {-1};
  image.features.descriptors = {{0xB5, 0x3C}};
  return image;
}

}  // namespace

int main() {
  Atlas atlas;
  atlas.CreateNewMap();
  Map* pMap = atlas.GetCurrentMap();
  GeometricCamera* pCamera = atlas.AddCamera(new Pinhole({500, 500, 320, 240}));

  std::vector<KeyFrame*> vpKFs;
  for (int i = 0; i < 4; ++i) {
    const slamdb::Rigid3f Tcw{slamdb::Quaternionf::Identity(), {-0.2F * static_cast<float>(i), 0, 0}};
    Frame frame(atlas, ImageFrom(*pCamera, Tcw), pCamera);
    vpKFs.push_back(new KeyFrame(frame, pMap));
    atlas.AddKeyFrame(vpKFs.back());
  }

  // Create a map point, and tell both sides of each observation.
  MapPoint* pMP = new MapPoint(kPosition, vpKFs[0], pMap);
  for (KeyFrame* pKF : vpKFs) {
    pMP->AddObservation(pKF, 0);
    pKF->AddMapPoint(pMP, 0);
  }
  pMP->ComputeDistinctiveDescriptors();
  pMP->UpdateNormalAndDepth();
  atlas.AddMapPoint(pMP);
  for (KeyFrame* pKF : vpKFs) pKF->UpdateConnections();
  std::printf("mp %lu: %d observations, reference kf %lu\n", pMP->mnId, pMP->Observations(),
              pMP->GetReferenceKeyFrame()->mnId);
  pMP->PrintObservations();
  std::printf("seen from %.2f to %.2f m\n", static_cast<double>(pMP->GetMinDistanceInvariance()),
              static_cast<double>(pMP->GetMaxDistanceInvariance()));

  // Tracking: where should a frame see it, and at which octave?
  Frame frame(atlas, ImageFrom(*pCamera, {slamdb::Quaternionf::Identity(), {0, 0, 2}}), pCamera);
  if (frame.isInFrustum(pMP, 0.5F)) {
    pMP->IncreaseVisible();
    pMP->IncreaseFound();
    std::printf("expected at (%.1f, %.1f), octave %d\n", static_cast<double>(pMP->mTrackProjX),
                static_cast<double>(pMP->mTrackProjY), pMP->mnTrackScaleLevel);
  }
  const float distance = (kPosition - vpKFs[3]->GetCameraCenter()).norm();
  std::printf("octave %d from kf %lu\n", pMP->PredictScale(distance, vpKFs[3]), vpKFs[3]->mnId);

  // Local mapping: points that are rarely found where they should be are culled.
  MapPoint* pGhost = new MapPoint(Eigen::Vector3f(0, 0, 9), vpKFs[3], pMap);
  atlas.AddMapPoint(pGhost);
  pGhost->IncreaseVisible(10);
  std::list<MapPoint*> recent = {pMP, pGhost};
  const int culled = CullMapPoints(recent, vpKFs[3]->mnId, true);
  std::printf("%d culled; mp %lu is %s, mp %lu is %s\n", culled, pMP->mnId, pMP->isBad() ? "bad" : "good", pGhost->mnId,
              pGhost->isBad() ? "bad" : "good");

  // Loop closing: the same point was made twice.
  MapPoint* pBetter = new MapPoint(kPosition, vpKFs[0], pMap);
  atlas.AddMapPoint(pBetter);
  pMP->Replace(pBetter);
  std::printf("mp %lu replaced by mp %lu, which has %d observations\n", pMP->mnId, pMP->GetReplaced()->mnId,
              pBetter->Observations());
  return pBetter->Observations() == 4 && atlas.MapPointsInMap() == 1 ? 0 : 1;
}
