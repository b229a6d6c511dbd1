// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/member_checks.h"

#include <algorithm>
#include <cmath>

#include "slamdb/formats/layouts/detail/wire_walk.h"

namespace slamdb::layouts {
namespace {

using Facts = RecordFacts;

constexpr double kMostId = 2147483648.0, kMostCount = 1e6;
constexpr int kUnproven = 5, kDoubtful = 30, kWrong = 60;

template <class Number>
double At(std::string_view file, std::uint64_t at) {
  return static_cast<double>(NumberAt<Number>(file, at).value_or(Number{}));
}
double I32(std::string_view file, std::uint64_t at) { return At<std::int32_t>(file, at); }
double I64(std::string_view file, std::uint64_t at) { return At<std::int64_t>(file, at); }
double F32(std::string_view file, std::uint64_t at) { return At<float>(file, at); }
double F64(std::string_view file, std::uint64_t at) { return At<double>(file, at); }

bool Between(double value, double least, double most) { return value >= least && value <= most; }
int Unless(bool fits, int penalty) { return fits ? kNoPenalty : penalty; }
bool Near(double value, double wanted, double part = 1e-3) {
  return std::abs(value - wanted) <= part * std::abs(wanted) + 1e-12;
}
// What is not known cannot be contradicted.
bool Is(double value, double wanted) { return wanted < 0 || value == wanted; }

// ---- Kinds of values

int IdCheck(std::string_view file, MemberPlace place, Facts&) {
  return Unless(Between(I64(file, place.begin), 0, kMostId), kWrong);
}
int IdOrNoneCheck(std::string_view file, MemberPlace place, Facts&) {
  return Unless(Between(I64(file, place.begin), -1, kMostId), kWrong);
}
int BoolCheck(std::string_view file, MemberPlace place, Facts&) {
  return Unless(At<std::uint8_t>(file, place.begin) <= 1, kWrong);
}
// Of what is bad, or to be erased, a sound file has little: whoever takes a flag that is often set for it loses all.
int RareCheck(std::string_view file, MemberPlace place, int penalty) {
  const double flag = At<std::uint8_t>(file, place.begin);
  return flag <= 1 ? Unless(flag == 0, penalty) : kWrong;
}
int BadCheck(std::string_view file, MemberPlace place, Facts&) { return RareCheck(file, place, kDoubtful); }
int ToBeErasedCheck(std::string_view file, MemberPlace place, Facts&) { return RareCheck(file, place, kUnproven); }
int ReplacedCheck(std::string_view file, MemberPlace place, Facts&) {
  const double id = I64(file, place.begin);
  return Between(id, -1, kMostId) ? Unless(id == -1, kDoubtful / 3) : kWrong;
}
int FiniteCheck(std::string_view file, MemberPlace place, Facts&) {
  for (std::uint64_t at = place.begin; at < place.end; at += 4)
    if (!(std::abs(F32(file, at)) < 1e9)) return kDoubtful / 3;
  return kNoPenalty;
}
int SmallIdCheck(std::string_view file, MemberPlace place, Facts&) {
  const double id = At<std::uint32_t>(file, place.begin);
  return Unless(id < 65536 || id == 4294967295.0, kWrong);
}
int PoseCheck(std::string_view file, MemberPlace place, Facts&) {
  double norm = 0;
  for (std::uint64_t i = 0; i < 4; ++i) norm += std::pow(F32(file, place.begin + 4 * i), 2);
  bool finite = std::abs(norm - 1) < 2e-3;
  for (std::uint64_t i = 4; i < 7; ++i) finite = finite && std::abs(F32(file, place.begin + 4 * i)) < 1e7;
  return Unless(finite, kBadPenalty);
}
int IdsCheck(std::string_view file, MemberPlace place, Facts&) {
  const double count = I64(file, place.begin);
  if (count > 0 && !Between(I64(file, place.begin + 8), 0, kMostId)) return kWrong;
  return kNoPenalty;
}

int CountCheck(std::string_view file, MemberPlace place, Facts&) {
  return Unless(Between(I32(file, place.begin), 0, kMostId), kWrong);
}
int CounterCheck(std::string_view file, MemberPlace place, Facts&) {
  return Unless(Between(I64(file, place.begin), 1, kMostId), kWrong);
}

// ---- Keyframes

int OwnIdCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kId] = I64(file, place.begin);
  return Unless(Between(facts[Facts::kId], 0, kMostId), kWrong);
}
int FrameIdCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double id = I64(file, place.begin);
  if (!Between(id, 0, kMostId)) return kWrong;
  return Unless(id >= facts[Facts::kId], kDoubtful / 3);
}
int TimeCheck(std::string_view file, MemberPlace place, Facts&) {
  const double time = At<double>(file, place.begin);
  return Unless(time == 0 || Between(time, 1e-6, 1e11), kWrong);
}
int ColumnsCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kColumns] = I32(file, place.begin);
  return Between(facts[Facts::kColumns], 1, 4096) ? Unless(facts[Facts::kColumns] == 64, 10) : kBadPenalty;
}
int RowsCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double rows = I32(file, place.begin);
  facts[Facts::kRows] = rows;
  return Between(rows, 1, 4096) ? Unless(rows == 48, 10) : kBadPenalty;
}
int CellCheck(std::string_view file, MemberPlace place, double& cell) {
  cell = F32(file, place.begin);
  return Unless(Between(cell, 1e-4, 10), kWrong);
}
int CellWidthCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return CellCheck(file, place, facts[Facts::kCellWidth]);
}
int CellHeightCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return CellCheck(file, place, facts[Facts::kCellHeight]);
}
int FxCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kFx] = F32(file, place.begin);
  return Unless(Between(facts[Facts::kFx], 1, 1e5), kWrong);
}
int FyCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kFy] = F32(file, place.begin);
  return Unless(Between(facts[Facts::kFy], 1, 1e5), kWrong);
}
int InverseFxCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return Unless(facts[Facts::kFx] < 0 || Near(F32(file, place.begin) * facts[Facts::kFx], 1), kWrong);
}
int InverseFyCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return Unless(facts[Facts::kFy] < 0 || Near(F32(file, place.begin) * facts[Facts::kFy], 1), kWrong);
}
int CenterCheck(std::string_view file, MemberPlace place, Facts&) {
  return Unless(Between(F32(file, place.begin), 1, 1e5), kDoubtful);
}
int BaselineCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double baseline = F32(file, place.begin);
  facts[Facts::kBaseline] = std::isfinite(baseline) ? baseline : -1;
  return Unless(Between(baseline, 0, 1e4), kDoubtful / 3);
}
int HalfBaselineCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return Unless(facts[Facts::kBaseline] < 0 || Near(F32(file, place.begin) * 2, facts[Facts::kBaseline]), kDoubtful);
}
int DistortionCheck(std::string_view file, MemberPlace place, Facts&) {
  const double columns = I32(file, place.begin), rows = I32(file, place.begin + 4), type = I32(file, place.begin + 8);
  return Unless(columns * rows <= 14 && (type == 5 || type == 6 || columns * rows == 0), kWrong);
}
int FeaturesCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kFeatures] = I32(file, place.begin);
  return Unless(Between(facts[Facts::kFeatures], 0, kMostCount), kWrong);
}

// The first and the last key point.
bool AreKeypoints(std::string_view file, MemberPlace place) {
  const auto fits = [&](std::uint64_t at) {
    for (std::uint64_t i = 0; i < 5; ++i)
      if (!(std::abs(F32(file, at + 4 * i)) < 1e6)) return false;
    return Between(I32(file, at + 24), 0, 255);
  };
  return place.end - place.begin < 32 || (fits(place.begin + 4) && fits(place.end - 28));
}
int KeypointsCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I32(file, place.begin);
  facts[Facts::kKeypoints] = count;
  if (!AreKeypoints(file, place)) return kWrong;
  return Unless(facts[Facts::kFeatures] < 0 || count == facts[Facts::kFeatures],
                count <= facts[Facts::kFeatures] ? 5 : kWrong);
}
int UndistortedCheck(std::string_view file, MemberPlace place, Facts& facts) {
  if (!AreKeypoints(file, place)) return kWrong;
  if (facts[Facts::kKeypoints] < 0) return kUnproven;
  return Unless(Is(I32(file, place.begin), facts[Facts::kKeypoints]), kWrong);
}
int RightKeypointsCheck(std::string_view file, MemberPlace place, Facts&) {
  return Unless(AreKeypoints(file, place), kWrong);
}
int StereoCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I64(file, place.begin);
  return Unless(count == 0 || Is(count, facts[Facts::kKeypoints]) || Is(count, facts[Facts::kFeatures]), kWrong);
}
int DescriptorsCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double columns = I32(file, place.begin), rows = I32(file, place.begin + 4), type = I32(file, place.begin + 8);
  if (facts[Facts::kFeatures] < 0) return kUnproven;
  if (!Is(rows, facts[Facts::kFeatures]) && rows != 0) return kWrong;
  return Unless((columns == 32 && type == 0) || rows == 0, 5);
}
int BagCheck(std::string_view file, MemberPlace place, Facts&) {
  const double count = I64(file, place.begin);
  if (count < 2) return kNoPenalty;
  const double first = At<std::uint32_t>(file, place.begin + 12), second = At<std::uint32_t>(file, place.begin + 24);
  return Unless(first < second && Between(At<double>(file, place.begin + 16), 0, 1e3), kWrong);
}
int LevelsCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kLevels] = I32(file, place.begin);
  return Unless(Between(facts[Facts::kLevels], 1, 64), kWrong);
}
int FactorCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kFactor] = F32(file, place.begin);
  return Unless(Between(facts[Facts::kFactor], 1, 16), kWrong);
}
int LogFactorCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return Unless(facts[Facts::kFactor] <= 0 || Near(F32(file, place.begin), std::log(facts[Facts::kFactor]), 1e-2),
                kWrong);
}
// 1, s, s^2, ...: of scales s itself, of variances its square or that inverted.
int PowersCheck(std::string_view file, MemberPlace place, Facts& facts, double power) {
  const double count = I64(file, place.begin);
  if (!Is(count, facts[Facts::kLevels])) return kWrong;
  if (count < 2 || facts[Facts::kFactor] <= 0) return kNoPenalty;
  return Unless(Near(F32(file, place.begin + 12), std::pow(facts[Facts::kFactor], power), 1e-2), kDoubtful);
}
int ScalesCheck(std::string_view file, MemberPlace place, Facts& facts) { return PowersCheck(file, place, facts, 1); }
int VariancesCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return PowersCheck(file, place, facts, 2);
}
int InverseVariancesCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return PowersCheck(file, place, facts, -2);
}
int NearBoundCheck(std::string_view file, MemberPlace place, double& bound) {
  bound = I32(file, place.begin);
  return Unless(std::abs(bound) < 1e5, kWrong);
}
int LeftCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return NearBoundCheck(file, place, facts[Facts::kLeft]);
}
int TopCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return NearBoundCheck(file, place, facts[Facts::kTop]);
}
// So many cells of the grid stand between both bounds.
int FarBoundCheck(std::string_view file, MemberPlace place, double cells, double cell, double near) {
  const double bound = I32(file, place.begin);
  if (!Between(bound, 1, 1e5)) return kWrong;
  return Unless(cells < 0 || cell <= 0 || Near((bound - near) * cell, cells, 0.02), kDoubtful);
}
int RightCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return FarBoundCheck(file, place, facts[Facts::kColumns], facts[Facts::kCellWidth], facts[Facts::kLeft]);
}
int BottomCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return FarBoundCheck(file, place, facts[Facts::kRows], facts[Facts::kCellHeight], facts[Facts::kTop]);
}
int CalibrationMatrixCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const bool fits =
      F32(file, place.begin + 32) == 1 && (facts[Facts::kFx] < 0 || Near(F32(file, place.begin), facts[Facts::kFx]));
  return Unless(fits, kWrong);
}
int MatchesCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I64(file, place.begin);
  if (!Is(count, facts[Facts::kFeatures])) return kWrong;
  return Unless(count == 0 || Between(I64(file, place.begin + 8), -1, kMostId), kWrong);
}
int GridCheck(std::string_view file, MemberPlace place, Facts& facts) {
  return Unless(Is(I64(file, place.begin), facts[Facts::kColumns]), kWrong);
}
int RightGridCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I64(file, place.begin);
  return Unless(count == 0 || Is(count, facts[Facts::kColumns]), kWrong);
}
int WeightsCheck(std::string_view file, MemberPlace place, Facts&) {
  const double count = I64(file, place.begin);
  if (count < 1) return kNoPenalty;
  if (!Between(I64(file, place.begin + 12), 0, kMostId) || !Between(I32(file, place.begin + 20), -1, kMostId))
    return kWrong;
  return Unless(count < 2 || I64(file, place.begin + 12) < I64(file, place.begin + 24), kWrong);
}
int MatchIndexCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I64(file, place.begin);
  if (facts[Facts::kFeatures] < 0 || count < 1) return kNoPenalty;
  const bool fits =
      count <= facts[Facts::kFeatures] && Between(I32(file, place.begin + 8), -1, facts[Facts::kFeatures]);
  return Unless(fits, kWrong);
}
int LeftCountCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I32(file, place.begin);
  return Unless(count == -1 || (Between(count, 0, kMostCount) && Is(count, facts[Facts::kKeypoints])), kWrong);
}
int RightCountCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I32(file, place.begin);
  return Unless(count == -1 || (count >= 0 && (facts[Facts::kFeatures] < 0 || count <= facts[Facts::kFeatures])),
                kWrong);
}

// ---- Map points

int ObservationCountCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kCount] = I32(file, place.begin);
  return Unless(Between(facts[Facts::kCount], 0, kMostCount), kWrong);
}
int PositionCheck(std::string_view file, MemberPlace place, Facts&) {
  double sum = 0;
  bool is_other = false;  // whole numbers look like floats next to 0
  for (std::uint64_t i = 0; i < 3; ++i) {
    const double value = std::abs(F32(file, place.begin + 4 * i));
    if (!(value < 1e6)) return kWrong;
    is_other = is_other || value < 1e-30;
    sum += value;
  }
  if (!(sum > 1e-6)) return kDoubtful;
  double norm = 0;
  for (std::uint64_t i = 0; i < 3; ++i) norm += std::pow(F32(file, place.begin + 4 * i), 2);
  return Unless(!is_other && !Between(norm, 0.7, 1.001), kUnproven);  // of length 1: a normal
}
int NormalCheck(std::string_view file, MemberPlace place, Facts&) {
  double norm = 0;
  for (std::uint64_t i = 0; i < 3; ++i) norm += std::pow(F32(file, place.begin + 4 * i), 2);
  return Unless(Between(norm, 0.2, 1.01) || norm == 0, kWrong);
}
int ObservationsCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I64(file, place.begin);
  const int wrong =
      std::max(WeightsCheck(file, place, facts), Unless(count != 0, kUnproven));  // a point that is unseen
  facts[Facts::kObservers] = count;
  facts[Facts::kFirstObserver] = count > 0 ? I64(file, place.begin + 12) : -1;
  facts[Facts::kLastObserver] = count > 0 ? I64(file, place.end - 12) : -1;
  if (facts[Facts::kCount] < 0) return wrong;
  return std::max(wrong, Unless(facts[Facts::kCount] >= count && facts[Facts::kCount] <= 2 * count, kDoubtful));
}
int RightObservationsCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double count = I64(file, place.begin);
  if (facts[Facts::kObservers] < 0) return kUnproven;
  if (!Is(count, facts[Facts::kObservers])) return kWrong;
  return Unless(count < 1 || Is(I64(file, place.begin + 12), facts[Facts::kFirstObserver]), kWrong);
}
int PointDescriptorCheck(std::string_view file, MemberPlace place, Facts&) {
  const double columns = I32(file, place.begin), rows = I32(file, place.begin + 4), type = I32(file, place.begin + 8);
  if (rows == 0 && columns == 0) return 5;
  return Unless(rows == 1 && columns == 32 && type == 0, rows == 1 ? 5 : kWrong);
}
int ReferenceCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double id = I64(file, place.begin);
  if (!Between(id, 0, kMostId)) return kWrong;
  if (facts[Facts::kObservers] < 1) return kNoPenalty;
  return Unless(Between(id, facts[Facts::kFirstObserver], facts[Facts::kLastObserver]), kDoubtful);
}
int LeastDistanceCheck(std::string_view file, MemberPlace place, Facts& facts) {
  facts[Facts::kLeast] = F32(file, place.begin);
  return Unless(Between(facts[Facts::kLeast], 0, 1e6), kWrong);
}
int MostDistanceCheck(std::string_view file, MemberPlace place, Facts& facts) {
  const double most = F32(file, place.begin);
  if (!Between(most, 0, 1e7) || (facts[Facts::kLeast] > 0 && most < facts[Facts::kLeast])) return kWrong;
  return kNoPenalty;
}

// ---- Cameras

int CameraTypeCheck(std::string_view file, MemberPlace place, Facts&) {
  return Unless(At<std::uint32_t>(file, place.begin) <= 2, kDoubtful);
}
int CameraParametersCheck(std::string_view file, MemberPlace place, Facts&) {
  const double count = I64(file, place.begin);
  if (!Between(count, 2, 16)) return kDoubtful;
  return Unless(Between(F32(file, place.begin + 8), 1, 1e5), kDoubtful);
}

constexpr std::array kMembers = {
    KnownMember{"KeyFrame", "mnId", OwnIdCheck, 8, {.differs = true}},
    KnownMember{"KeyFrame", "mnFrameId", FrameIdCheck, 8, {.differs = true}, I64},
    KnownMember{"KeyFrame", "mTimeStamp", TimeCheck, 8, {.differs = true}, F64},
    KnownMember{"KeyFrame", "mnGridCols", ColumnsCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mnGridRows", RowsCheck, 4, {.constant = true, .anchor = true}},
    KnownMember{"KeyFrame", "mfGridElementWidthInv", CellWidthCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mfGridElementHeightInv", CellHeightCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "fx", FxCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "fy", FyCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "invfx", InverseFxCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "invfy", InverseFyCheck, 4, {.constant = true, .anchor = true}},
    KnownMember{"KeyFrame", "cx", CenterCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "cy", CenterCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mbf", FiniteCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mb", BaselineCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mThDepth", FiniteCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mDistCoef", DistortionCheck},
    KnownMember{"KeyFrame", "N", FeaturesCheck, 4},
    KnownMember{"KeyFrame", "mvKeys", KeypointsCheck},
    KnownMember{"KeyFrame", "mvKeysUn", UndistortedCheck, 0, {.anchor = true}},
    KnownMember{"KeyFrame", "mvuRight", StereoCheck},
    KnownMember{"KeyFrame", "mvDepth", StereoCheck},
    KnownMember{"KeyFrame", "mDescriptors", DescriptorsCheck, 0, {.anchor = true}},
    KnownMember{"KeyFrame", "mBowVec", BagCheck},
    KnownMember{"KeyFrame", "mTcp", PoseCheck, 28},
    KnownMember{"KeyFrame", "mnScaleLevels", LevelsCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mfScaleFactor", FactorCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mfLogScaleFactor", LogFactorCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mvScaleFactors", ScalesCheck},
    KnownMember{"KeyFrame", "mvLevelSigma2", VariancesCheck},
    KnownMember{"KeyFrame", "mvInvLevelSigma2", InverseVariancesCheck, 0, {.anchor = true}},
    KnownMember{"KeyFrame", "mnMinX", LeftCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mnMinY", TopCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mnMaxX", RightCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mnMaxY", BottomCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mK_", CalibrationMatrixCheck, 36},
    KnownMember{"KeyFrame", "mTcw", PoseCheck, 28, {.anchor = true}},
    KnownMember{"KeyFrame", "mvBackupMapPointsId", MatchesCheck},
    KnownMember{"KeyFrame", "mGrid", GridCheck, 0, {.anchor = true}},
    KnownMember{"KeyFrame", "mBackupConnectedKeyFrameIdWeights", WeightsCheck},
    KnownMember{"KeyFrame", "mbFirstConnection", BoolCheck, 1},
    KnownMember{"KeyFrame", "mBackupParentId", IdOrNoneCheck, 8},
    KnownMember{"KeyFrame", "mvBackupChildrensId", IdsCheck},
    KnownMember{"KeyFrame", "mvBackupLoopEdgesId", IdsCheck},
    KnownMember{"KeyFrame", "mvBackupMergeEdgesId", IdsCheck},
    KnownMember{"KeyFrame", "mbNotErase", BoolCheck, 1},
    KnownMember{"KeyFrame", "mbToBeErased", ToBeErasedCheck, 1},
    KnownMember{"KeyFrame", "mbBad", BadCheck, 1},
    KnownMember{"KeyFrame", "mHalfBaseline", HalfBaselineCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mnOriginMapId", SmallIdCheck, 4},
    KnownMember{"KeyFrame", "mnBackupIdCamera", SmallIdCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mnBackupIdCamera2", SmallIdCheck, 4, {.constant = true}},
    KnownMember{"KeyFrame", "mvLeftToRightMatch", MatchIndexCheck},
    KnownMember{"KeyFrame", "mvRightToLeftMatch", MatchIndexCheck},
    KnownMember{"KeyFrame", "NLeft", LeftCountCheck, 4},
    KnownMember{"KeyFrame", "NRight", RightCountCheck, 4},
    KnownMember{"KeyFrame", "mTlr", PoseCheck, 28},
    KnownMember{"KeyFrame", "mvKeysRight", RightKeypointsCheck},
    KnownMember{"KeyFrame", "mGridRight", RightGridCheck},
    KnownMember{"KeyFrame", "mBackupPrevKFId", IdOrNoneCheck, 8},
    KnownMember{"KeyFrame", "mBackupNextKFId", IdOrNoneCheck, 8},
    KnownMember{"KeyFrame", "bImu", BoolCheck, 1},
    KnownMember{"KeyFrame", "mbHasVelocity", BoolCheck, 1},
    KnownMember{"KeyFrame", "mImuBias", FiniteCheck, 24},
    KnownMember{"Calib", "mTcb", PoseCheck, 28},
    KnownMember{"Calib", "mTbc", PoseCheck, 28},
    KnownMember{"Calib", "mbIsSet", BoolCheck, 1},
    KnownMember{"MapPoint", "mnId", OwnIdCheck, 8, {.differs = true}},
    KnownMember{"MapPoint", "mnFirstKFid", IdOrNoneCheck, 8},
    KnownMember{"MapPoint", "mnFirstFrame", IdOrNoneCheck, 8},
    KnownMember{"MapPoint", "nObs", ObservationCountCheck, 4},
    KnownMember{"MapPoint", "mWorldPos", PositionCheck, 12, {.differs = true}},
    KnownMember{"MapPoint", "mNormalVector", NormalCheck, 12, {.differs = true}},
    KnownMember{"MapPoint", "mBackupObservationsId1", ObservationsCheck},
    KnownMember{"MapPoint", "mBackupObservationsId2", RightObservationsCheck, 0, {.anchor = true}},
    KnownMember{"MapPoint", "mDescriptor", PointDescriptorCheck, 0, {.anchor = true}},
    KnownMember{"MapPoint", "mBackupRefKFId", ReferenceCheck, 8},
    KnownMember{"MapPoint", "mbBad", BadCheck, 1},
    KnownMember{"MapPoint", "mBackupReplacedId", ReplacedCheck, 8},
    KnownMember{"MapPoint", "mfMinDistance", LeastDistanceCheck, 4, {.differs = true}},
    KnownMember{"MapPoint", "mfMaxDistance", MostDistanceCheck, 4, {.differs = true}},
    KnownMember{"Map", "mnId", IdCheck, 8},
    KnownMember{"Map", "mnMaxKFid", IdCheck, 8},
    KnownMember{"Map", "mnBigChangeIdx", CountCheck, 4},
    KnownMember{"Map", "mvBackupKeyFrameOriginsId", IdsCheck},
    KnownMember{"Map", "mnBackupKFinitialID", IdOrNoneCheck, 8},
    KnownMember{"Map", "mnBackupKFlowerID", IdOrNoneCheck, 8},
    KnownMember{"Map", "mbImuInitialized", BoolCheck, 1},
    KnownMember{"Map", "mbIsInertial", BoolCheck, 1},
    KnownMember{"Map", "mbIMU_BA1", BoolCheck, 1},
    KnownMember{"Map", "mbIMU_BA2", BoolCheck, 1},
    KnownMember{"GeometricCamera", "mnId", SmallIdCheck, 4},
    KnownMember{"GeometricCamera", "mnType", CameraTypeCheck, 4},
    KnownMember{"GeometricCamera", "mvParameters", CameraParametersCheck},
    KnownMember{"Atlas", "Map::nNextId", CounterCheck, 8},
    KnownMember{"Atlas", "Frame::nNextId", CounterCheck, 8},
    KnownMember{"Atlas", "KeyFrame::nNextId", CounterCheck, 8},
    KnownMember{"Atlas", "MapPoint::nNextId", CounterCheck, 8},
    KnownMember{"Atlas", "GeometricCamera::nNextId", CounterCheck, 8},
    KnownMember{"Atlas", "mnLastInitKFidMap", IdCheck, 8},
};

bool SameBytes(std::string_view file, MemberPlace a, MemberPlace b) {
  return file.substr(a.begin, a.end - a.begin) == file.substr(b.begin, b.end - b.begin);
}

// Neighbours of which the one with the larger id has the smaller number.
int Falls(const KnownMember& member, std::string_view file, std::span<const MemberPlace> places,
          std::span<const RecordFacts> facts) {
  int falls = 0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double ids = facts[i][Facts::kId] - facts[i - 1][Facts::kId];
    const double numbers = member.rises(file, places[i].begin) - member.rises(file, places[i - 1].begin);
    if (ids * numbers < 0) ++falls;
  }
  return falls;
}

}  // namespace

const KnownMember* FindKnownMember(std::string_view of_class, std::string_view name) {
  const auto found = std::find_if(kMembers.begin(), kMembers.end(), [&](const KnownMember& member) {
    return member.of_class == of_class && member.name == name;
  });
  return found == kMembers.end() ? nullptr : &*found;
}

int PenaltyOf(const KnownMember& member, std::string_view file, std::span<const MemberPlace> places,
              std::span<RecordFacts> facts) {
  if (places.empty()) return kNoPenalty;
  int sum = 0, equal = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (member.bytes > 0 && places[i].end - places[i].begin != member.bytes) continue;
    sum += member.check(file, places[i], facts[i]);
    if (i > 0 && SameBytes(file, places[i - 1], places[i])) ++equal;
  }
  const int pairs = static_cast<int>(places.size()) - 1;
  if (pairs > 0 && member.rises != nullptr)
    sum += static_cast<int>(places.size()) * kDoubtful * Falls(member, file, places, facts) / pairs;
  if (pairs > 0 && member.traits.differs) sum += static_cast<int>(places.size()) * kWrong * equal / pairs;
  if (pairs > 0 && member.traits.constant) sum += static_cast<int>(places.size()) * 20 * (pairs - equal) / pairs;
  return sum / static_cast<int>(places.size());
}

}  // namespace slamdb::layouts
