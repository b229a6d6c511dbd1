// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "slamdb/formats/orbslam3/detail/layout.h"

// The steps of layout.h as tables, so that a fork's layout can run them in its own order.
namespace slamdb::orbslam3 {

// All members of an entity that the model knows, in one fixed order. What an atlas has itself are its counters.
template <class Visit>
void ForEachMemberOf(const KeyFrame*, const Visit& visit) {
  ForEachKeyFrameMember(visit);
}
template <class Visit>
void ForEachMemberOf(const MapPoint*, const Visit& visit) {
  ForEachMapPointMember(visit);
  visit(Part::kMapPoint);
  ForEachTrackingMember(visit);
}
template <class Visit>
void ForEachMemberOf(const Map*, const Visit& visit) {
  ForEachMapHeadMember(visit);
  ForEachMapTailMember(visit);
}
template <class Visit>
void ForEachMemberOf(const Camera*, const Visit& visit) {
  ForEachCameraMember(visit);
  ForEachFisheyeMember(visit);
}
template <class Visit>
void ForEachMemberOf(const ImuPreintegration*, const Visit& visit) {
  ForEachPreintegrationMember(visit);
}
template <class Visit>
void ForEachMemberOf(const Counters*, const Visit& visit) {
  ForEachCounterMember(visit);
}

// The entity whose members those of a class are.
template <class Entity>
Entity& StepEntity(Entity& entity) {
  return entity;
}
inline Counters& StepEntity(Atlas& atlas) { return atlas.next_ids; }
inline const Counters& StepEntity(const Atlas& atlas) { return atlas.next_ids; }

// One step for one kind of archive; `Entity` is const for one that writes.
template <class Archive, class Entity>
struct MemberStep {
  const char* name;
  Part part;
  void (*run)(Archive&, const char*, Entity&);
};

template <class Archive, class Entity>
class StepTable {
 public:
  // In the order of ForEachMemberOf.
  static const std::vector<MemberStep<Archive, Entity>>& Steps() {
    static const std::vector<MemberStep<Archive, Entity>> kSteps = Make();
    return kSteps;
  }

 private:
  struct Collector {
    std::vector<MemberStep<Archive, Entity>>& steps;
    Part& part;
    void operator()(Part next) const { part = next; }
    template <class Step>
    void operator()(const char* name, const Step& step) const {
      steps.push_back({name, part, step});
    }
  };
  static std::vector<MemberStep<Archive, Entity>> Make() {
    std::vector<MemberStep<Archive, Entity>> steps;
    Part part = Part::kOther;
    ForEachMemberOf(static_cast<const Entity*>(nullptr), Collector{steps, part});
    return steps;
  }
};

}  // namespace slamdb::orbslam3
