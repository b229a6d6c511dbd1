// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/checks/check.h"

// Every check and fix that the catalogue lists, by the file that defines it. A check reports each breach of its
// invariant to Findings; a fix returns how much it changed. What they mean is said in rules.cc. Private to the folder.
namespace slamdb::detail {

// identity.cc
void CheckListEntryNull(const Subject&, Findings&);
std::size_t DropNullEntries(Atlas&);
void CheckMapListedOnce(const Subject&, Findings&);
std::size_t DropRepeatedMaps(Atlas&);
void CheckListedInOneMap(const Subject&, Findings&);
std::size_t DropEntriesOfOtherMaps(Atlas&);
void CheckListedOnce(const Subject&, Findings&);
std::size_t DropRepeatedEntries(Atlas&);
void CheckMapEmpty(const Subject&, Findings&);
void CheckAtlasEmpty(const Subject&, Findings&);
std::size_t DropEmptyMaps(Atlas&);
void CheckMapIdUnique(const Subject&, Findings&);
std::size_t RenumberRepeatedMaps(Atlas&);
void CheckCameraIdUnique(const Subject&, Findings&);
std::size_t DropRepeatedCameras(Atlas&);
void CheckKeyFrameIdUnique(const Subject&, Findings&);
void CheckPointIdUnique(const Subject&, Findings&);
void CheckKeyFrameIdUniqueInAtlas(const Subject&, Findings&);
void CheckPointIdUniqueInAtlas(const Subject&, Findings&);
void CheckKeyFrameIdRange(const Subject&, Findings&);
void CheckMaxKeyFrameId(const Subject&, Findings&);
std::size_t RaiseMaxKeyFrameIds(Atlas&);
void CheckCountersAboveIds(const Subject&, Findings&);
void CheckOriginMapId(const Subject&, Findings&);
void CheckVocabularyChecksum(const Subject&, Findings&);

// references.cc
void CheckObservationTarget(const Subject&, Findings&);
std::size_t EraseDanglingObservations(Atlas&);
void CheckReferenceTarget(const Subject&, Findings&);
std::size_t ReplaceMissingReferences(Atlas&);
void CheckReplacementTarget(const Subject&, Findings&);
std::size_t ClearDanglingReplacements(Atlas&);
void CheckSlotTarget(const Subject&, Findings&);
std::size_t EmptyDanglingSlots(Atlas&);
void CheckConnectionTarget(const Subject&, Findings&);
std::size_t EraseDanglingConnections(Atlas&);
void CheckParentTarget(const Subject&, Findings&);
std::size_t ClearDanglingParents(Atlas&);
void CheckChildTarget(const Subject&, Findings&);
std::size_t EraseDanglingChildren(Atlas&);
void CheckLoopEdgeTarget(const Subject&, Findings&);
std::size_t EraseDanglingLoopEdges(Atlas&);
void CheckMergeEdgeTarget(const Subject&, Findings&);
std::size_t EraseDanglingMergeEdges(Atlas&);
void CheckTemporalTarget(const Subject&, Findings&);
std::size_t ClearDanglingNeighbours(Atlas&);
void CheckSelfLink(const Subject&, Findings&);
std::size_t EraseSelfLinks(Atlas&);
void CheckInitialKeyFrame(const Subject&, Findings&);
std::size_t SetInitialKeyFrames(Atlas&);
void CheckFixedKeyFrame(const Subject&, Findings&);
std::size_t SetFixedKeyFrames(Atlas&);
void CheckInitialKeyFrameIsFixed(const Subject&, Findings&);
std::size_t FixInitialKeyFrames(Atlas&);
void CheckLowestKeyFrame(const Subject&, Findings&);
std::size_t SetLowestKeyFrames(Atlas&);
void CheckOriginTarget(const Subject&, Findings&);
std::size_t EraseDanglingOrigins(Atlas&);
void CheckOriginGiven(const Subject&, Findings&);
std::size_t SetMissingOrigins(Atlas&);

// bad_entities.cc
void CheckKeyFrameBad(const Subject&, Findings&);
void CheckBadKeyFrameReferenced(const Subject&, Findings&);
std::size_t DropBadKeyFrames(Atlas&);
void CheckPointBad(const Subject&, Findings&);
std::size_t DropBadPoints(Atlas&);
void CheckBadPointReferenced(const Subject&, Findings&);
std::size_t EmptySlotsOfBadPoints(Atlas&);

// cameras.cc
void CheckCameraTarget(const Subject&, Findings&);
std::size_t SetMissingCameras(Atlas&);
void CheckRightCamera(const Subject&, Findings&);
std::size_t SetRightCameras(Atlas&);
void CheckCameraParameters(const Subject&, Findings&);
void CheckCameraType(const Subject&, Findings&);
std::size_t SetCameraTypes(Atlas&);
void CheckIntrinsicsPositive(const Subject&, Findings&);
void CheckIntrinsicsAgree(const Subject&, Findings&);
std::size_t RebuildIntrinsics(Atlas&);

// observations.cc
void CheckObservationSides(const Subject&, Findings&);
std::size_t CompleteObservationSides(Atlas&);
void CheckObservationSeen(const Subject&, Findings&);
std::size_t EraseUnseenObservations(Atlas&);
void CheckObservationIndex(const Subject&, Findings&);
std::size_t ReseatObservations(Atlas&);
void CheckPointObserved(const Subject&, Findings&);
std::size_t RestoreObservations(Atlas&);
void CheckPointSupport(const Subject&, Findings&);
void CheckReferenceObserves(const Subject&, Findings&);
std::size_t ReplaceUnseeingReferences(Atlas&);
void CheckObservationCount(const Subject&, Findings&);
void CheckObservationCountExcess(const Subject&, Findings&);
std::size_t RecountObservations(Atlas&);
void CheckObservationSlot(const Subject&, Findings&);
void CheckSlotObserved(const Subject&, Findings&);

// graph.cc
void CheckTreeAcyclic(const Subject&, Findings&);
void CheckTreeRoot(const Subject&, Findings&);
std::size_t RegrowTrees(Atlas&);
void CheckParentListsChild(const Subject&, Findings&);
std::size_t AddMissingChildren(Atlas&);
void CheckChildHasParent(const Subject&, Findings&);
std::size_t EraseForeignChildren(Atlas&);
void CheckFirstConnection(const Subject&, Findings&);
std::size_t ClearFirstConnections(Atlas&);
void CheckConnectionMutual(const Subject&, Findings&);
void CheckConnectionWeight(const Subject&, Findings&);
void CheckConnectionPositive(const Subject&, Findings&);
std::size_t WeighConnections(Atlas&);
void CheckLoopEdgeMutual(const Subject&, Findings&);
std::size_t AddMissingLoopEdges(Atlas&);
void CheckMergeEdgeMutual(const Subject&, Findings&);
std::size_t AddMissingMergeEdges(Atlas&);
void CheckLoopEdgeKept(const Subject&, Findings&);
std::size_t KeepLoopKeyFrames(Atlas&);
void CheckLinksUnique(const Subject&, Findings&);
std::size_t EraseRepeatedLinks(Atlas&);

// chains.cc
void CheckTemporalMutual(const Subject&, Findings&);
std::size_t MendChains(Atlas&);

// features.cc, and fixes in features_fix.cc
void CheckFeatureCount(const Subject&, Findings&);
std::size_t RecountFeatures(Atlas&);
void CheckColumnLength(const Subject&, Findings&);
void CheckPyramidTables(const Subject&, Findings&);
std::size_t RebuildPyramids(Atlas&);
void CheckPyramidScale(const Subject&, Findings&);
void CheckGridShape(const Subject&, Findings&);
void CheckGridIndex(const Subject&, Findings&);
void CheckGridCell(const Subject&, Findings&);
std::size_t RebuildGrids(Atlas&);
void CheckImageBounds(const Subject&, Findings&);
void CheckFeatureVectorIndex(const Subject&, Findings&);
std::size_t EraseWildFeatures(Atlas&);
void CheckBagOfWordsPaired(const Subject&, Findings&);
std::size_t ClearHalfBags(Atlas&);
void CheckBagOfWordsWeight(const Subject&, Findings&);
void CheckBagOfWordsSorted(const Subject&, Findings&);
std::size_t DropUnsortedBags(Atlas&);
std::size_t DropWildBags(Atlas&);
void CheckWordRange(const Subject&, Findings&);

// keypoints.cc
void CheckOctave(const Subject&, Findings&);
void CheckKeypointFinite(const Subject&, Findings&);
void CheckKeypointUndistorted(const Subject&, Findings&);
void CheckStereoMatch(const Subject&, Findings&);
std::size_t ClearWildMatches(Atlas&);  // features_fix.cc
void CheckStereoFinite(const Subject&, Findings&);
std::size_t RestoreStereo(Atlas&);
void CheckStereoDepth(const Subject&, Findings&);

// values.cc
void CheckPoseFinite(const Subject&, Findings&);
void CheckRotationUnit(const Subject&, Findings&);
std::size_t NormalizeRotations(Atlas&);
void CheckPointFinite(const Subject&, Findings&);
std::size_t DropInfinitePoints(Atlas&);
void CheckPointNormal(const Subject&, Findings&);
std::size_t RestoreNormals(Atlas&);
void CheckPointDescriptor(const Subject&, Findings&);
std::size_t RestoreDescriptors(Atlas&);
void CheckDistanceRange(const Subject&, Findings&);
std::size_t RestoreDistanceRanges(Atlas&);
void CheckDistanceRatio(const Subject&, Findings&);
void CheckPointInFront(const Subject&, Findings&);
void CheckReprojection(const Subject&, Findings&);
void CheckTimestampFinite(const Subject&, Findings&);
void CheckFlagByte(const Subject&, Findings&);
std::size_t NormalizeFlags(Atlas&);

// times.cc
void CheckTimestampSeconds(const Subject&, Findings&);
std::size_t ReadTimestampsAsSeconds(Atlas&);
void CheckTimestampOrder(const Subject&, Findings&);
void CheckTimestampGap(const Subject&, Findings&);

// inertial.cc
void CheckImuChain(const Subject&, Findings&);
void CheckImuCalibration(const Subject&, Findings&);
void CheckImuCalibrationInverse(const Subject&, Findings&);
void CheckImuPreintegration(const Subject&, Findings&);
void CheckImuDuration(const Subject&, Findings&);
void CheckImuMotion(const Subject&, Findings&);
void CheckImuStages(const Subject&, Findings&);
std::size_t ResetImuStages(Atlas&);
void CheckUninitialised(const Subject&, Findings&);
std::size_t ZeroUninitialised(Atlas&);
void CheckTextNumbers(const Subject&, Findings&);

// landmarks.cc
void CheckLandmarkIdUnique(const Subject&, Findings&);
void CheckLandmarkFinite(const Subject&, Findings&);
void CheckLandmarkNormal(const Subject&, Findings&);
std::size_t TurnLandmarkNormals(Atlas&);
void CheckLandmarkCovariance(const Subject&, Findings&);
void CheckLandmarkDescriptors(const Subject&, Findings&);

}  // namespace slamdb::detail
