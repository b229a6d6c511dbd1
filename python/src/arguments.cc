// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/arguments.h"

#include <algorithm>

#include "python/src/errors.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/location.h"
#include "slamdb/formats/results.h"

namespace slamdb::python {

namespace py = pybind11;

void OutputFile::Write(std::string_view bytes) const {
  if (!any()) return;
  AtomicFile file(path, options);
  file.Write(bytes);
  file.Commit();
}

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
  if (!value) return {};
  return inputs_.emplace_back(TextOfPath(*value));
}

std::vector<std::string> Arguments::Paths(const char* name) {
  std::vector<std::string> paths;
  for (const py::object& each : Get<std::vector<py::object>>(name))
    paths.push_back(inputs_.emplace_back(TextOfPath(each)));
  return paths;
}

OutputFile Arguments::Output(const char* name) {
  OutputFile output{.path = {}, .options = {.overwrite = Get<bool>("overwrite")}};
  const std::optional<py::object> value = Find(name);
  if (value) output.path = outputs_.emplace_back(TextOfPath(*value));
  return output;
}

std::shared_ptr<const Atlas> Arguments::AtlasAt(const char* name) {
  return Get<std::shared_ptr<HeldAtlas>>(name)->value();
}

AtlasOrPath Arguments::SourceAt(const char* name) {
  const std::optional<py::object> value = Find(name);
  if (!value) return {};
  AtlasOrPath source = SourceOf(*value);
  if (!source.path.empty()) inputs_.push_back(source.path);
  return source;
}

std::vector<AtlasOrPath> Arguments::Sources(const char* name) {
  std::vector<AtlasOrPath> sources;
  for (const py::object& each : Get<std::vector<py::object>>(name)) {
    sources.push_back(SourceOf(each));
    if (!sources.back().path.empty()) inputs_.push_back(sources.back().path);
  }
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
  GuardOutputs();
}

std::string Arguments::OutputAtlas(const char* name) {
  const std::optional<py::object> value = Find(name);
  if (!value) return {};
  return output_atlases_.emplace_back(TextOfPath(*value));
}

void Arguments::GuardOutputs() const {
  const auto is_same = [](const std::string& one, const std::string& other) {
    return detail::IsSameFile(one, std::nullopt, other, std::nullopt);
  };
  const auto atlas_in = [](const Location& place) {
    return place.name.empty() ? detail::AtlasName() : detail::AtlasName(place.name);
  };
  for (const std::string& output : output_atlases_)
    for (const std::string& input : inputs_) {
      const Location to(output), from(input);
      if (detail::IsSameFile(to.path, atlas_in(to), from.path, atlas_in(from)))
        throw Error(ErrorKind::kUsage, output, "", "is the input, too; name another output");
    }
  for (auto output = outputs_.begin(); output != outputs_.end(); ++output) {
    for (const std::string& input : inputs_)
      if (is_same(*output, Location(input).path))
        throw Error(ErrorKind::kUsage, *output, "", "is the input " + input + "; name another file");
    if (std::any_of(outputs_.begin(), output, [&](const std::string& other) { return is_same(*output, other); }))
      throw Error(ErrorKind::kUsage, *output, "", "is to be written twice; name another file");
    RefuseAtlas(*output);
  }
}

void Arguments::RefuseIdle(std::initializer_list<const char*> names, const std::string& why) {
  for (const char* name : names) {
    const std::optional<py::object> value = Find(name);
    if (value && !value->is(py::bool_(false))) throw Error(ErrorKind::kUsage, std::string(name) + "= " + why);
  }
}

void Arguments::RefuseType(const char* name, const py::object& value, std::string_view expected) {
  std::string problem =
      detail::WithoutPasswords(std::string(name) + "= cannot be " + py::repr(value).cast<std::string>());
  if (!expected.empty()) problem.append(", it takes ").append(expected);
  if (py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value)) throw Error(ErrorKind::kUsage, problem);
  throw py::type_error(problem);
}

void Arguments::RefuseNumber(const char* name, const cli::Limits& limits) {
  throw Error(ErrorKind::kUsage,
              std::string(name) + "= is " + limits.Text() + ", not " + std::string(py::repr(*Find(name))));
}

void Arguments::RefuseWord(const char* name, const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "'" : ", '") + word + "'";
  throw Error(ErrorKind::kUsage, std::string(name) + "= is one of " + all + ", not '" + Get<std::string>(name) + "'");
}

std::string TextOfPath(const py::object& path) {
  const py::object bytes = py::module_::import("os").attr("fsencode")(path);  // takes str and PathLike
  std::string text = bytes.cast<std::string>();
  if (text.find('\0') != std::string::npos) throw py::value_error("a path holds a null character");
  return text;
}

std::optional<LoadedVocabulary> VocabularyAt(const std::string& path, int threads) {
  if (path.empty()) return std::nullopt;
  return LoadVocabulary(path, threads);
}

}  // namespace slamdb::python
