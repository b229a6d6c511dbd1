// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/src/given.h"
#include "python/src/map_in_atlas.h"
#include "python/src/module.h"
#include "python/src/reopen.h"
#include "slamdb/build/imu.h"
#include "slamdb/build/links.h"
#include "slamdb/edit/part/subset.h"

// What changes a map: removing, links, and what follows from what was changed.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using MapClass = py::class_<MapInAtlas>;
using Flags = std::vector<std::uint8_t>;

// Which points or keyframes a verb is of. It is held against those that are there when the verb begins: while arguments
// are read, another thread may change the map.
struct Which {
  bool is_mask = false;
  Flags mask;
  std::vector<std::uint64_t> ids;
};

Which WhichOf(const py::object& given) {
  const py::array array = ArrayOrNull(given);
  if (array && py::isinstance(given, py::module_::import("numpy.ma").attr("MaskedArray")))
    RefuseGiven("which", "is a masked array, of which some rows say nothing: give filled(False), or the ids");
  if (!array || array.dtype().kind() != 'b') return {.ids = GivenIds(given, "which")};
  if (array.ndim() != 1) RefuseGiven("which", "is a mask of more than one dimension");
  const py::array_t<bool, py::array::c_style> mask(array);
  return {.is_mask = true, .mask = Flags(mask.data(), mask.data() + mask.size()), .ids = {}};
}

// Flags of all rows. `noun`: of what.
template <class List>
Flags ChosenOf(const Which& which, const List& list, const std::string& noun) {
  if (which.is_mask && which.mask.size() != list.size())
    RefuseGiven("which", "is a mask of another shape; there are " + std::to_string(list.size()) + " " + noun + "s");
  if (which.is_mask) return which.mask;
  // Ids stand once; so many of 0 and 1 are flags.
  if (list.size() > 2 && which.ids.size() == list.size() && std::ranges::max(which.ids) <= 1)
    RefuseGiven("which", "are ids, all of them 0 or 1: is that a mask? give it as bool");
  Flags chosen(list.size(), 0);
  std::vector<std::pair<std::uint64_t, std::size_t>> rows;
  for (std::size_t row = 0; row < list.size(); ++row) rows.emplace_back(list[row].id.value(), row);
  std::ranges::sort(rows);
  for (const std::uint64_t id : which.ids) {
    const auto found = std::ranges::lower_bound(rows, std::pair(id, std::size_t{0}));
    if (found == rows.end() || found->first != id)
      RefuseGiven("which", "the map has no " + noun + " " + std::to_string(id));
    chosen[found->second] = 1;
  }
  return chosen;
}

Border BorderOf(const std::string& name) {
  if (name == "strict") return Border::kStrict;
  if (name == "smart") return Border::kSmart;
  RefuseGiven("border", "is 'strict' or 'smart'");
}

std::vector<KeyFrameEdge> PairsOf(const py::object& ones, const py::object& others, const char* ones_name,
                                  const char* others_name) {
  const std::vector<std::uint64_t> one = GivenIds(ones, ones_name);
  const std::vector<std::uint64_t> other = GivenIds(others, others_name, {static_cast<py::ssize_t>(one.size())});
  std::vector<KeyFrameEdge> pairs;
  for (std::size_t row = 0; row < one.size(); ++row) pairs.emplace_back(KeyFrameId(one[row]), KeyFrameId(other[row]));
  return pairs;
}

// Of who called.
void Warn(const std::string& sentence) {
  const py::object category = py::module_::import("slamdb.errors").attr("SlamdbWarning");
  if (PyErr_WarnEx(category.ptr(), sentence.c_str(), 1) != 0) throw py::error_already_set();
}

// Removes what is chosen of `List`, closes what is left, and tells what became of it.
template <auto List, auto Rows>
py::object Remove(const MapInAtlas& map, const py::object& given, const char* noun, std::optional<Border> border) {
  const Which which = WhichOf(given);
  bool nothing_left = false;
  const std::string report = map.atlas->Apply([&](Atlas& atlas) {
    const Flags chosen = ChosenOf(which, map.In(atlas).*List, noun);
    Subset subset = Subset::Everything(atlas);
    std::ranges::transform(chosen, (subset.maps[map.row].*Rows).begin(), [](bool goes) { return goes ? 0 : 1; });
    if (border) SettleBorder(AtlasIndex(atlas), *border, subset);
    std::string json = ToJson(KeepSubset(atlas, subset));
    const auto left = std::ranges::find(atlas.maps, map.id, &Map::id);
    nothing_left = left == atlas.maps.end() || ((*left).*List).empty();
    return json;
  });
  if (nothing_left) Warn(ToString(map.id) + " has no " + noun + " left");
  return py::module_::import("slamdb.report").attr("Report").attr("parse")(report);
}

py::object RemovePoints(const MapInAtlas& map, const py::object& which) {
  return Remove<&Map::points, &Subset::MapRows::points>(map, which, "point", std::nullopt);
}

py::object RemoveKeyFrames(const MapInAtlas& map, const py::object& which, const std::string& border) {
  return Remove<&Map::keyframes, &Subset::MapRows::keyframes>(map, which, "keyframe", BorderOf(border));
}

// `change(map)` of the map as it is in the value that is changed: of links, in little time.
template <class Change>
auto ChangeMap(const MapInAtlas& map, const Change& change) {
  return map.atlas->ApplyWhole([&](Atlas& atlas) { return change(map.In(atlas)); });
}

struct Nothing {};

void UpdateCovisibility(const MapInAtlas& map) {
  map.atlas->Apply([&](Atlas& atlas) { return UpdateConnections(map.In(atlas)), Nothing(); });
}

void UpdateChosen(const MapInAtlas& map, const py::object& given) {
  const std::optional<Which> which = given.is_none() ? std::nullopt : std::optional(WhichOf(given));
  map.atlas->Apply([&](Atlas& atlas) {
    Map& changed = map.In(atlas);
    const Flags chosen = which ? ChosenOf(*which, changed.points, "point") : Flags(changed.points.size(), 1);
    std::vector<std::uint32_t> rows;
    for (std::uint32_t row = 0; row < chosen.size(); ++row)
      if (chosen[row] != 0) rows.push_back(row);
    return UpdatePoints(changed, rows), Nothing();
  });
}

std::uint64_t AddEdgesTo(const MapInAtlas& map, EdgeKind kind, const py::object& given) {
  const std::vector<std::uint64_t> ids = GivenIds(given, "pairs", {-1, 2});
  std::vector<KeyFrameEdge> pairs;
  for (std::size_t at = 0; at < ids.size(); at += 2) pairs.emplace_back(KeyFrameId(ids[at]), KeyFrameId(ids[at + 1]));
  return ChangeMap(map, [&](Map& changed) { return AddEdges(changed, kind, pairs); });
}

void SetParentsOf(const MapInAtlas& map, const py::object& keyframes, const py::object& parents) {
  const std::vector<KeyFrameEdge> pairs = PairsOf(keyframes, parents, "keyframes", "parents");
  ChangeMap(map, [&](Map& changed) { return SetParents(changed, pairs), Nothing(); });
}

void AddObservationsTo(const MapInAtlas& map, const py::object& points, const py::object& keyframes,
                       const py::object& keypoints) {
  const std::vector<std::uint64_t> rows = GivenIds(keypoints, "keypoints");
  const Shape as_many{static_cast<py::ssize_t>(rows.size())};
  const std::vector<std::uint64_t> seen = GivenIds(points, "points", as_many);
  const std::vector<std::uint64_t> by = GivenIds(keyframes, "keyframes", as_many);
  std::vector<PointObservation> observations;
  for (std::size_t row = 0; row < rows.size(); ++row)
    observations.push_back({MapPointId(seen[row]), KeyFrameId(by[row]), rows[row]});
  ChangeMap(map, [&](Map& changed) { return AddObservations(changed, observations), Nothing(); });
}

ImuStage ImuStageOf(const std::string& name) {
  if (name == "none") return ImuStage::kNone;
  if (name == "initialized") return ImuStage::kInitialized;
  if (name == "ba1") return ImuStage::kAdjusted;
  if (name == "ba2") return ImuStage::kAdjustedTwice;
  RefuseGiven("stage", "'" + name + "' is none of 'none', 'initialized', 'ba1' and 'ba2'");
}

void SetReferencesOf(const MapInAtlas& map, const py::object& points, const py::object& keyframes) {
  std::vector<std::pair<MapPointId, KeyFrameId>> pairs;
  for (const auto& [point, keyframe] : PairsOf(points, keyframes, "points", "keyframes"))
    pairs.emplace_back(MapPointId(point.value()), keyframe);
  ChangeMap(map, [&](Map& changed) { return SetReferences(changed, pairs), Nothing(); });
}

void DefineRemoving(MapClass map) {
  map.def("remove_points", &RemovePoints, py::arg("which"),
          R"(Remove points, and all that refers to them; returns what went as a Report: before, after, cut, chosen.

which: mask (N,) bool, or ids
Warns (SlamdbWarning) where none is left.)")
      .def("remove_keyframes", &RemoveKeyFrames, py::arg("which"), py::kw_only(), py::arg("border") = "strict",
           R"(Remove keyframes, and all that refers to them; returns what went as a Report: before, after, cut, chosen.

Their children get other parents, points other reference keyframes, IMU measurements are joined over the gap.
which: mask (N,) bool, or ids
border: "strict": points go that fewer than two keyframes, and none with depth, still see; "smart": those that
    ORB-SLAM3 culls, with observations that add up to 2 or less
Warns (SlamdbWarning) where none, and with them no map, is left.)");
}

void DefineLinking(MapClass map) {
  map.def("set_parents", &SetParentsOf, py::arg("keyframes"), py::arg("parents"),
          "Give keyframes other parents in the spanning tree, both (N,) ids; children follow.")
      .def("set_reference_keyframes", &SetReferencesOf, py::arg("points"), py::arg("keyframes"),
           "Give points other reference keyframes, both (N,) ids; distance ranges follow. They must observe them.")
      .def("add_observations", &AddObservationsTo, py::arg("points"), py::arg("keyframes"), py::arg("keypoints"),
           R"(Say which keypoints of keyframes points of the map are, too.

points: (N,) ids
keyframes: (N,) ids
keypoints: (N,) rows; those of a right fisheye camera stand behind the left ones

What follows for these points (see update_points), for covisibility and the spanning tree is made anew.
Raises UsageError (a ValueError) when a keypoint is a point already, a point would be two keypoints of one picture, or
one of them is not there; then nothing is changed.)")
      .def(
          "set_imu_stage",
          [](const MapInAtlas& m, const std::string& stage) {
            const ImuStage known = ImuStageOf(stage);
            ChangeMap(m, [&](Map& changed) { return SetImuStage(changed, known), Nothing(); });
          },
          py::arg("stage"), R"(Say how far the IMU of a map is, for which its keyframes were added with one.

stage: "none", as in a new map; "initialized": the world is metric, with z up; "ba1", "ba2": ORB-SLAM3's first and
    second inertial bundle adjustment are done, too
Raises UsageError (a ValueError) when a keyframe has no calibration, or no measurements since the one before.)")
      .def(
          "add_loop_edges",
          [](const MapInAtlas& m, const py::object& pairs) { return AddEdgesTo(m, EdgeKind::kLoop, pairs); },
          py::arg("pairs"), "Add loop edges, (N, 2) ids of keyframes, to both sides; returns how many were new.")
      .def(
          "add_merge_edges",
          [](const MapInAtlas& m, const py::object& pairs) { return AddEdgesTo(m, EdgeKind::kMerge, pairs); },
          py::arg("pairs"), "Add merge edges in the same way.")
      .def("update_points", &UpdateChosen, py::arg("which") = py::none(),
           R"(Make of points anew what follows from where they are and who sees them, after arrays were written to:
normals, distance ranges, descriptors and observation counts.

which: mask (N,) bool, or ids; by default all)")
      .def("update_covisibility", &UpdateCovisibility, "Count anew which keyframes share how many points.");
}

}  // namespace

void DefineMapVerbs(py::module_& module) {
  const auto map = Reopen<MapClass>(module, "Map");
  DefineRemoving(map);
  DefineLinking(map);
}

}  // namespace slamdb::python
