// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/given.h"

#include <cmath>
#include <cstdint>

#include "python/src/arrays.h"
#include "slamdb/build/build.h"

namespace slamdb::python {

namespace py = pybind11;

namespace {

std::string TextOf(const Shape& shape) {
  std::string text;
  for (const py::ssize_t length : shape)
    text += (text.empty() ? "" : ", ") + (length < 0 ? "N" : std::to_string(length));
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

std::string TypeOf(const py::array& array) { return py::str(array.dtype()); }

bool Fits(const py::array& array, const Shape& shape) {
  if (array.ndim() != static_cast<py::ssize_t>(shape.size())) return false;
  for (std::size_t axis = 0; axis < shape.size(); ++axis)
    if (shape[axis] >= 0 && array.shape(static_cast<py::ssize_t>(axis)) != shape[axis]) return false;
  return true;
}

py::array Given(py::handle object, const std::string& name, const Shape& shape, const char* kinds, const char* wanted) {
  const py::array array = ArrayOrNull(object);
  if (!array) RefuseGiven(name, "is no array of " + std::string(wanted));
  RequireUnmasked(object, name);
  if (array.size() == 0 && !shape.empty() && shape.front() <= 0) {
    Shape empty = shape;
    empty.front() = 0;
    return py::array(py::dtype::of<double>(), std::move(empty));
  }
  if (std::string(kinds).find(array.dtype().kind()) == std::string::npos)
    RefuseGiven(name, "has dtype " + TypeOf(array) + ", expected " + wanted);
  if (!Fits(array, shape)) {
    const Shape has(array.shape(), array.shape() + array.ndim());
    RefuseGiven(name, "has shape " + TextOf(has) + ", expected " + TextOf(shape));
  }
  return array;
}

// Of a list of ids of which some are beyond 2^63, as NONE is; no array of anything else.
py::array ExactIds(py::handle object) {
  if (py::isinstance<py::array>(object)) return py::reinterpret_steal<py::array>(py::handle());
  const py::array items = py::module_::import("numpy").attr("array")(object, py::arg("dtype") = "object");
  for (const py::handle item : items.attr("ravel")())
    if (!PyLong_Check(item.ptr())) return py::reinterpret_steal<py::array>(py::handle());
  try {
    return items.attr("astype")("uint64");
  } catch (const py::error_already_set&) {  // below 0
    return py::reinterpret_steal<py::array>(py::handle());
  }
}

// `row 3 is ` of number `i`; of a single number `is `.
std::string PlaceIn(const py::array& array, py::ssize_t i) {
  return array.ndim() == 0 ? "is " : "row " + std::to_string(i / (array.size() / array.shape(0))) + " is ";
}

// Whole numbers in a type that may be narrower, or without sign.
template <class Number>
Contiguous<Number> Fitting(const py::array& array, const std::string& name) {
  const bool has_sign = array.dtype().kind() == 'i';
  const auto is_lost = [&](std::int64_t number) {
    if (!has_sign && number < 0) return sizeof(Number) < 8;  // beyond 2^63
    return sizeof(Number) < 8 ? number != static_cast<Number>(number) : has_sign && number < 0;
  };
  const Contiguous<std::int64_t> numbers(array);
  for (py::ssize_t i = 0; i < numbers.size(); ++i)
    if (is_lost(numbers.data()[i]))
      RefuseGiven(name, PlaceIn(numbers, i) + std::to_string(numbers.data()[i]) + ", which is out of range");
  return array;
}

}  // namespace

py::array GivenNumbers(py::handle object, const std::string& name, const Shape& shape) {
  return Given(object, name, shape, "fiu", "numbers");
}

// numpy makes floating-point numbers of signed and unsigned ones that stand together: those that are whole will do.
py::array GivenIntegers(py::handle object, const std::string& name, const Shape& shape) {
  const py::array array = Given(object, name, shape, "iuf", "whole numbers");
  if (array.size() == 0 || array.dtype().kind() != 'f') return array;
  if (const py::array exact = ExactIds(object); exact && Fits(exact, shape)) return exact;
  constexpr double kExact = 9007199254740992;  // 2^53
  const Contiguous<double> numbers(array);
  for (py::ssize_t i = 0; i < numbers.size(); ++i)
    if (!(std::abs(numbers.data()[i]) <= kExact) || numbers.data()[i] != std::floor(numbers.data()[i]))
      RefuseGiven(name, PlaceIn(numbers, i) + std::string(py::str(py::float_(numbers.data()[i]))) +
                            ", expected a whole number");
  return Contiguous<std::int64_t>(array);
}

template <>
Contiguous<std::int32_t> GivenAs(py::handle object, const std::string& name, const Shape& shape) {
  return Fitting<std::int32_t>(GivenIntegers(object, name, shape), name);
}
template <>
Contiguous<std::uint64_t> GivenAs(py::handle object, const std::string& name, const Shape& shape) {
  return Fitting<std::uint64_t>(GivenIntegers(object, name, shape), name);
}

std::vector<std::uint64_t> GivenIds(py::handle object, const std::string& name, const Shape& shape) {
  return GivenElements<std::uint64_t, std::uint64_t>(object, name, shape);
}

Rigid3f GivenTransform(py::handle object, const std::string& name) {
  using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const auto numbers = GivenAs<double>(object, name, {4, 4});
  const Eigen::Matrix4d transform = Eigen::Map<const Matrix>(numbers.data());
  return CameraFromWorldOf(transform, name).Inverse();
}

py::tuple GivenItems(py::handle object, const std::string& name) {
  if (!py::isinstance<py::sequence>(object)) RefuseGiven(name, "is no list, with one row for each keyframe");
  return py::tuple(py::reinterpret_borrow<py::sequence>(object));
}

void RequireUnmasked(py::handle object, const std::string& name) {
  if (!py::hasattr(object, "mask")) return;
  if (py::module_::import("numpy.ma").attr("is_masked")(object).cast<bool>())
    RefuseGiven(name, "has masked values; leave those rows out, or fill them");
}

py::object PartOf(py::handle object, const char* name) {
  if (py::isinstance<py::dict>(object)) {
    const auto dict = py::reinterpret_borrow<py::dict>(object);
    return dict.contains(name) ? py::object(dict[name]) : py::none();
  }
  return py::getattr(object, name, py::none());
}

}  // namespace slamdb::python
