// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/new_features.h"

#include <cstring>

#include "python/src/arrays.h"
#include "python/src/given.h"

namespace slamdb::python {

namespace py = pybind11;

namespace {

// A member of all keypoints.
template <class Number>
void SetMember(Column<Keypoint>& keypoints, Number Keypoint::*member, py::handle given, const std::string& name) {
  if (given.is_none()) return;
  const auto numbers = GivenAs<Number>(given, name, {static_cast<py::ssize_t>(keypoints.size())});
  for (std::size_t i = 0; i < static_cast<std::size_t>(numbers.size()); ++i) keypoints[i].*member = numbers.data()[i];
}

// A field of a structured array, None where it has none.
py::object FieldOf(const py::array& array, const char* name) {
  return array.dtype().attr("names").contains(name) ? py::object(array[name]) : py::none();
}

void SetMembers(const py::array& array, const std::string& name, Column<Keypoint>& keypoints) {
  for (const char* needed : {"x", "y"})
    if (FieldOf(array, needed).is_none()) RefuseGiven(name, "has no field " + std::string(needed));
  SetMember(keypoints, &Keypoint::x, FieldOf(array, "x"), name + ".x");
  SetMember(keypoints, &Keypoint::y, FieldOf(array, "y"), name + ".y");
  SetMember(keypoints, &Keypoint::angle, FieldOf(array, "angle"), name + ".angle");
  SetMember(keypoints, &Keypoint::response, FieldOf(array, "response"), name + ".response");
  SetMember(keypoints, &Keypoint::size, FieldOf(array, "size"), name + ".size");
  SetMember(keypoints, &Keypoint::octave, FieldOf(array, "octave"), name + ".octave");
  SetMember(keypoints, &Keypoint::class_id, FieldOf(array, "class_id"), name + ".class_id");
}

// Places as (N, 2) numbers, or a structured array with the names of Keypoint's members.
Column<Keypoint> KeypointsOf(py::handle object, const std::string& name) {
  if (object.is_none()) return {};
  RequireUnmasked(object, name);
  const py::array array = ArrayOrNull(object);
  const bool is_structured = array && array.ndim() == 1 && !array.dtype().attr("names").is_none();
  const py::array places = is_structured ? array : GivenNumbers(object, name, {-1, 2});
  Column<Keypoint> keypoints(static_cast<std::size_t>(places.shape(0)),
                             Keypoint{0, 0, 0, 0, 0, -1, 0});  // of the usual size
  if (is_structured) {
    SetMembers(array, name, keypoints);
    return keypoints;
  }
  const Contiguous<float> numbers(places);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    keypoints[i].x = numbers.data()[2 * i];
    keypoints[i].y = numbers.data()[2 * i + 1];
  }
  return keypoints;
}

Column<Descriptor> DescriptorsIn(py::handle object, const std::string& name) {
  if (object.is_none()) return {};
  const py::array array = GivenIntegers(object, name, {-1, sizeof(Descriptor)});
  if (array.size() > 0 && array.itemsize() != 1)
    RefuseGiven(name, "has dtype " + std::string(py::str(array.dtype())) + ", expected uint8: 256 bits of ORB");
  const Contiguous<std::uint8_t> bytes(array);
  Column<Descriptor> descriptors(static_cast<std::size_t>(array.shape(0)));
  if (!descriptors.empty()) std::memcpy(descriptors.data(), bytes.data(), descriptors.size() * sizeof(Descriptor));
  return descriptors;
}

}  // namespace

Column<Descriptor> GivenDescriptors(py::handle object, const std::string& name) { return DescriptorsIn(object, name); }

// A mapping of other names than those would lose what it has under them.
void RefuseOtherNames(py::handle object, const std::string& name) {
  if (!py::isinstance<py::dict>(object)) return;
  const py::object fields = py::module_::import("slamdb.features").attr("FeatureArrays").attr("_fields");
  for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(object))
    if (!fields.contains(key))
      RefuseGiven(name, "has " + std::string(py::repr(key)) + ", and may have " +
                            std::string(py::str(py::str(", ").attr("join")(fields))));
}

Features GivenFeatures(py::handle object, const std::string& name) {
  RefuseOtherNames(object, name);
  if (object.is_none() || PartOf(object, "keypoints").is_none())
    RefuseGiven(name, "has no keypoints; features are a list of slamdb.FeatureArrays, one for each keyframe");
  const auto part = [&](const char* part_name) { return PartOf(object, part_name); };
  const auto place = [&](const char* part_name) { return name + "." + part_name; };
  Features features;
  features.keypoints = KeypointsOf(part("keypoints"), place("keypoints"));
  SetMember(features.keypoints, &Keypoint::octave, part("octaves"), place("octaves"));
  SetMember(features.keypoints, &Keypoint::angle, part("angles"), place("angles"));
  features.undistorted = KeypointsOf(part("undistorted"), place("undistorted"));
  features.right_keypoints = KeypointsOf(part("right_keypoints"), place("right_keypoints"));
  SetMember(features.right_keypoints, &Keypoint::octave, part("right_octaves"), place("right_octaves"));
  features.descriptors = DescriptorsIn(part("descriptors"), place("descriptors"));
  features.right_x = GivenElements<float, float, Column<float>>(part("right_x"), place("right_x"), {-1});
  features.depth = GivenElements<float, float, Column<float>>(part("depth"), place("depth"), {-1});
  using Rows = Column<std::int32_t>;
  features.right_of_left =
      GivenElements<std::int32_t, std::int32_t, Rows>(part("right_of_left"), place("right_of_left"), {-1});
  features.left_of_right =
      GivenElements<std::int32_t, std::int32_t, Rows>(part("left_of_right"), place("left_of_right"), {-1});
  return features;
}

}  // namespace slamdb::python
