// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/arguments.h"

#include "python/src/errors.h"
#include "slamdb/base/error.h"

namespace slamdb::python {

namespace py = pybind11;

namespace {

AtlasOrPath SourceOf(const py::object& value) {
  if (py::isinstance<HeldAtlas>(value)) return {.atlas = value.cast<std::shared_ptr<HeldAtlas>>()->value(), .path = {}};
  return {.atlas = nullptr, .path = TextOfPath(value)};
}

}  // namespace

std::optional<py::object> Arguments::Find(const char* name) {
  taken_.insert(name);
  if (!values_.contains(name)) return std::nullopt;
  py::object value = values_[name];
  return value.is_none() ? std::nullopt : std::optional(std::move(value));
}

std::vector<std::uint64_t> Arguments::Numbers(const char* name) {
  const std::optional<py::object> value = Find(name);
  if (!value) return {};
  if (py::isinstance<py::int_>(*value)) return {Get<std::uint64_t>(name)};
  return Get<std::vector<std::uint64_t>>(name);
}

std::string Arguments::Path(const char* name) {
  const std::optional<py::object> value = Find(name);
  return value ? TextOfPath(*value) : std::string();
}

std::shared_ptr<const Atlas> Arguments::AtlasAt(const char* name) {
  return Get<std::shared_ptr<HeldAtlas>>(name)->value();
}

AtlasOrPath Arguments::SourceAt(const char* name) {
  const std::optional<py::object> value = Find(name);
  return value ? SourceOf(*value) : AtlasOrPath();
}

std::vector<AtlasOrPath> Arguments::Sources(const char* name) {
  std::vector<AtlasOrPath> sources;
  for (const py::object& each : Get<std::vector<py::object>>(name)) sources.push_back(SourceOf(each));
  return sources;
}

slamdb::Progress Arguments::progress() {
  taken_.insert("progress");
  return ProgressTo(values_.contains("progress") ? py::object(values_["progress"]) : py::object(py::none()));
}

void Arguments::RequireAllTaken() const {
  for (const auto& [name, value] : values_)
    if (!taken_.contains(name.cast<std::string>()))
      throw std::runtime_error("nothing takes the argument " + name.cast<std::string>());
}

void Arguments::RefuseType(const char* name, const py::object& value) {
  throw py::type_error(std::string(name) + "= cannot be " + py::repr(value).cast<std::string>());
}

void Arguments::RefuseWord(const char* name, const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "'" : ", '") + word + "'";
  throw Error(ErrorKind::kUsage, std::string(name) + "= is one of " + all + ", not '" + Get<std::string>(name) + "'");
}

std::string TextOfPath(const py::object& path) {
  const py::object bytes = py::module_::import("os").attr("fsencode")(path);  // takes str and PathLike
  return bytes.cast<std::string>();
}

std::optional<LoadedVocabulary> VocabularyAt(const std::string& path, int threads) {
  if (path.empty()) return std::nullopt;
  return LoadVocabulary(path, threads);
}

}  // namespace slamdb::python
