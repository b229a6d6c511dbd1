// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/layouts/detail/layout_json.h"

namespace slamdb::detail {
namespace {

// One short name, and what it stands for, in order: one member, or those of an array.
struct ShortName {
  std::string_view of_class;
  std::string_view name;
  std::string_view members;  // separated by spaces
};

constexpr std::array kShortNames = std::to_array<ShortName>({
    {"KeyFrame", "gw", "mfGridElementWidthInv"},
    {"KeyFrame", "gh", "mfGridElementHeightInv"},
    {"KeyFrame", "fx", "fx fy invfx invfy cx cy mbf mb mThDepth"},
    {"KeyFrame", "sf", "mfScaleFactor mfLogScaleFactor"},
    {"KeyFrame", "s1", "mvScaleFactors"},
    {"KeyFrame", "s2", "mvLevelSigma2"},
    {"KeyFrame", "s3", "mvInvLevelSigma2"},
    {"KeyFrame", "bounds", "mnMinX mnMinY mnMaxX mnMaxY"},
    {"KeyFrame", "mK", "mK_"},
    {"KeyFrame", "Tcw", "mTcw"},
    {"KeyFrame", "mps", "mvBackupMapPointsId"},
    {"KeyFrame", "conn", "mBackupConnectedKeyFrameIdWeights"},
    {"KeyFrame", "first", "mbFirstConnection"},
    {"KeyFrame", "parent", "mBackupParentId"},
    {"KeyFrame", "children", "mvBackupChildrensId"},
    {"KeyFrame", "loops", "mvBackupLoopEdgesId"},
    {"KeyFrame", "merges", "mvBackupMergeEdgesId"},
    {"KeyFrame", "flags", "mbNotErase mbToBeErased mbBad"},
    {"KeyFrame", "hb", "mHalfBaseline"},
    {"KeyFrame", "origin", "mnOriginMapId"},
    {"KeyFrame", "cam", "mnBackupIdCamera"},
    {"KeyFrame", "cam2", "mnBackupIdCamera2"},
    {"KeyFrame", "l2r", "mvLeftToRightMatch"},
    {"KeyFrame", "r2l", "mvRightToLeftMatch"},
    {"KeyFrame", "bias", "mImuBias"},
    {"KeyFrame", "pre", "mBackupImuPreintegrated"},
    {"KeyFrame", "calib", "mImuCalib"},
    {"KeyFrame", "prev", "mBackupPrevKFId"},
    {"KeyFrame", "next", "mBackupNextKFId"},
    {"KeyFrame", "v", "mVw"},
    {"KeyFrame", "Vw", "mVw"},
    {"KeyFrame", "owb", "mOwb"},
    {"KeyFrame", "Owb", "mOwb"},
    {"KeyFrame", "hasv", "mbHasVelocity"},
    {"KeyFrame", "sec", "mTimeStamp.seconds"},
    {"KeyFrame", "nsec", "mTimeStamp.nanoseconds"},
    {"KeyFrame", "bk", "mBowVec.words"},
    {"KeyFrame", "bv", "mBowVec.weights"},
    {"KeyFrame", "fk", "mFeatVec.nodes"},
    {"KeyFrame", "fv", "mFeatVec.features"},
    {"MapPoint", "pos", "mWorldPos"},
    {"MapPoint", "normal", "mNormalVector"},
    {"MapPoint", "obs1", "mBackupObservationsId1"},
    {"MapPoint", "obs2", "mBackupObservationsId2"},
    {"MapPoint", "desc", "mDescriptor"},
    {"MapPoint", "ref", "mBackupRefKFId"},
    {"MapPoint", "bad", "mbBad"},
    {"MapPoint", "replaced", "mBackupReplacedId"},
    {"MapPoint", "dmin", "mfMinDistance"},
    {"MapPoint", "dmax", "mfMaxDistance"},
    {"MapPoint", "vis", "mnVisible"},
    {"MapPoint", "found", "mnFound"},
    {"Map", "big", "mnBigChangeIdx"},
    {"Map", "kfs", "mvpBackupKeyFrames"},
    {"Map", "mps", "mvpBackupMapPoints"},
    {"Map", "origins", "mvBackupKeyFrameOriginsId"},
    {"Map", "kfini", "mnBackupKFinitialID"},
    {"Map", "kflow", "mnBackupKFlowerID"},
    {"Map", "flags", "mbImuInitialized mbIsInertial mbIMU_BA1 mbIMU_BA2"},
    {"Atlas", "maps", "mvpBackupMaps"},
    {"Atlas", "cams", "mvpCameras"},
    {"Atlas", "cnt", "Map::nNextId Frame::nNextId KeyFrame::nNextId MapPoint::nNextId GeometricCamera::nNextId"},
    {"Atlas", "last", "mnLastInitKFidMap"},
    {"GeometricCamera", "id", "mnId"},
    {"GeometricCamera", "type", "mnType"},
    {"GeometricCamera", "par", "mvParameters"},
    {"KannalaBrandt8", "prec", "precision"},
    {"Calib", "a", "mTcb"},
    {"Calib", "b", "mTbc"},
    {"Calib", "c", "Cov"},
    {"Calib", "d", "CovWalk"},
    {"Calib", "set", "mbIsSet"},
});

std::vector<std::string> Words(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

bool Has(const LayoutClass& of, std::string_view name) {
  return std::ranges::find(of.members, name, &LayoutMember::name) != of.members.end();
}

// The members that this one stands for; empty when it has no short name.
std::vector<LayoutMember> Expand(const LayoutClass& of, const LayoutMember& member) {
  const auto found = std::find_if(kShortNames.begin(), kShortNames.end(), [&](const ShortName& name) {
    return name.of_class == of.name && name.name == member.name;
  });
  if (found == kShortNames.end()) return {};
  const std::vector<std::string> names = Words(found->members);
  if (names.size() == 1)
    return Has(of, names.front()) ? std::vector<LayoutMember>()
                                  : std::vector<LayoutMember>{{names.front(), member.type}};
  const LayoutType type = ParseLayoutType(member.type);
  if (type.kind != LayoutType::Kind::kArray || type.count > names.size()) return {};
  std::vector<LayoutMember> members;
  for (std::uint32_t i = 0; i < type.count; ++i) members.push_back({names[i], ToString(type.elements.front())});
  return members;
}

// Older layout files call it i64, which it is not where a long has 4 bytes.
bool IsLong(const LayoutClass& of, const LayoutMember& member) {
  return of.name == "MapPoint" && (member.name == "mnFirstKFid" || member.name == "mnFirstFrame");
}

}  // namespace

void UseOwnNames(Layout& layout) {
  for (LayoutClass& of : layout.classes) {
    std::vector<LayoutMember> members;
    for (const LayoutMember& member : of.members) {
      std::vector<LayoutMember> own = Expand(of, member);
      if (own.empty()) own.push_back(member);
      if (IsLong(of, own.front()) && own.front().type == "i64") own.front().type = "long";
      members.insert(members.end(), own.begin(), own.end());
    }
    of.members = std::move(members);
  }
}

}  // namespace slamdb::detail
