// SPDX-License-Identifier: BSD-3-Clause
// Holds what ndjson writes and schema/ndjson.schema.json to each other.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "slamdb/formats/ndjson/detail/ndjson.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

using nlohmann::json;

// The part of JSON Schema that our schema uses. Answers where and why a value breaks it, or "".
class Schema {
 public:
  explicit Schema(json root) : root_(std::move(root)) {}

  std::string Problem(const json& value) const { return Problem(root_, value, "line"); }

 private:
  std::string Problem(const json& schema, const json& value, const std::string& place) const {
    if (schema.contains("$ref")) {
      const std::string problem =
          Problem(root_.at(json::json_pointer(schema["$ref"].get<std::string>().substr(1))), value, place);
      if (!problem.empty()) return problem;
    }
    for (const char* alternatives : {"anyOf", "oneOf"})
      if (schema.contains(alternatives) && !AnyOf(schema[alternatives], value, place))
        return place + " fits none of " + schema[alternatives].dump() + ": " + value.dump().substr(0, 200);
    if (schema.contains("const") && schema["const"] != value) return place + " is not " + schema["const"].dump();
    if (schema.contains("enum") &&
        std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end())
      return place + " is none of " + schema["enum"].dump();
    if (schema.contains("type") && !HasType(schema["type"].get<std::string>(), value))
      return place + " is no " + schema["type"].get<std::string>() + ": " + value.dump();
    if (schema.contains("minimum") && value < schema["minimum"]) return place + " is too small: " + value.dump();
    if (schema.contains("maximum") && value > schema["maximum"]) return place + " is too large: " + value.dump();
    if (schema.contains("pattern") &&
        !std::regex_match(value.get<std::string>(), std::regex(schema["pattern"].get<std::string>())))
      return place + " does not match: " + value.dump();
    if (value.is_object() && schema.contains("properties")) return ObjectProblem(schema, value, place);
    if (value.is_array() && schema.contains("items")) return ArrayProblem(schema, value, place);
    return "";
  }

  bool AnyOf(const json& alternatives, const json& value, const std::string& place) const {
    return std::any_of(alternatives.begin(), alternatives.end(),
                       [&](const json& schema) { return Problem(schema, value, place).empty(); });
  }

  static bool HasType(const std::string& type, const json& value) {
    if (type == "number") return value.is_number();
    if (type == "integer") return value.is_number_integer();
    return type == value.type_name();
  }

  std::string ObjectProblem(const json& schema, const json& value, const std::string& place) const {
    for (const auto& name : schema["required"])
      if (!value.contains(name.get<std::string>())) return place + " has no " + name.dump();
    for (const auto& [name, member] : value.items()) {
      if (!schema["properties"].contains(name)) return place + " has a member " + name;
      const std::string problem = Problem(schema["properties"][name], member, place + "/" + name);
      if (!problem.empty()) return problem;
    }
    return "";
  }

  std::string ArrayProblem(const json& schema, const json& value, const std::string& place) const {
    if (value.size() < schema.value("minItems", std::size_t{0})) return place + " has too few elements";
    if (value.size() > schema.value("maxItems", value.size())) return place + " has too many elements";
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string problem = Problem(schema["items"], value[i], place + "/" + std::to_string(i));
      if (!problem.empty()) return problem;
    }
    return "";
  }

  json root_;
};

class NdjsonSchema : public ::testing::Test {
 protected:
  // The first problem of any line that the atlas is written as.
  static std::string ProblemOf(const Atlas& atlas) {
    std::ifstream file(SLAMDB_FIXTURES "/../schema/ndjson.schema.json");
    json root = json::parse(file);
    std::istringstream lines(Encoded(detail::kNdjsonFormat, atlas));
    for (std::string line; std::getline(lines, line);) {
      // Of the kinds of line, the one that this line says it is: its problem is the one to tell.
      const json value = json::parse(line);
      root.erase("oneOf");
      root["$ref"] = "#/$defs/" + value["type"].get<std::string>();
      const std::string problem = Schema(root).Problem(value);
      if (!problem.empty()) return problem;
    }
    return "";
  }
};

TEST_F(NdjsonSchema, DescribesEveryLine) {
  EXPECT_EQ(ProblemOf({}), "");
  EXPECT_EQ(ProblemOf(LandmarkAtlas()), "");
  EXPECT_EQ(ProblemOf(InertialAtlas()), "");
}

TEST_F(NdjsonSchema, DescribesIrregularValues) {
  Atlas atlas = InertialAtlas();
  Map& map = atlas.maps[0];
  map.points[0].position.x() = std::nanf("");
  map.points[0].bad.recorded = 200;
  map.points[0].observations[0].left = Observation::kAbsent;
  map.keyframes[0].distortion = {.rows = 1, .columns = 1, .type = 0, .continuous = true, .data = Column<std::byte>(1)};
  map.keyframes[0].preintegration.measurements.resize(2, ImuMeasurement{{1, 2, 3}, {4, 5, 6}, HUGE_VALF});
  map.repeated_points = {{.position = 3}, {.position = 4, .owner_map = 0, .row = 1}};
  EXPECT_EQ(ProblemOf(atlas), "");
}

TEST_F(NdjsonSchema, DescribesWhatForksHave) {
  Atlas atlas = InertialAtlas();
  atlas.layout = "gnss";
  atlas.cameras[0].model = CameraModel::kEquirectangular;
  for (Boxed<Carried>* carried : {&atlas.carried, &atlas.cameras[0].carried, &atlas.maps[0].carried,
                                  &atlas.maps[0].keyframes[0].carried, &atlas.maps[0].points[0].carried})
    carried->Make().members.resize(3, std::byte{0xa7});
  Matrix& descriptors = atlas.maps[0].points[0].carried.Make().descriptors;
  descriptors = {.rows = 1, .columns = 2, .type = 5, .continuous = true, .data = Column<std::byte>(8)};
  EXPECT_EQ(ProblemOf(atlas), "");
}

TEST_F(NdjsonSchema, FindsWhatDoesNotFit) {
  std::ifstream file(SLAMDB_FIXTURES "/../schema/ndjson.schema.json");
  const Schema schema(json::parse(file));
  EXPECT_NE(schema.Problem(json::parse(R"({"type":"camera","id":0})")), "");
  EXPECT_NE(schema.Problem(json::parse(R"({"type":"dog"})")), "");
}

}  // namespace
}  // namespace slamdb
