// SPDX-License-Identifier: BSD-3-Clause
// Reports name the same thing by the same name: docs/json.md against the schemas of all of them.
#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

// The schemas of reports, by the name of the file without its end.
std::map<std::string, json> ReportSchemas() {
  std::map<std::string, json> schemas;
  for (const auto& entry : std::filesystem::directory_iterator(SLAMDB_SCHEMAS)) {
    const std::string name = entry.path().filename().string();
    constexpr std::string_view kEnd = ".schema.json";
    if (!name.ends_with(kEnd)) continue;
    json schema = json::parse(ReadWholeFile(entry.path().string()));
    if (schema.contains("/properties/report"_json_pointer))
      schemas.emplace(name.substr(0, name.size() - kEnd.size()), std::move(schema));
  }
  return schemas;
}

void CollectNames(const json& schema, std::set<std::string>& names) {
  if (schema.is_object() && schema.contains("properties"))
    for (const auto& [name, member] : schema.at("properties").items()) names.insert(name);
  if (schema.is_structured())
    for (const json& member : schema) CollectNames(member, names);
}

TEST(JsonNames, EveryReportSaysWhatItIsAndWhatItIsOf) {
  const std::set<std::string> of_no_file = {"version", "rules", "layouts"};
  const auto schemas = ReportSchemas();
  EXPECT_GE(schemas.size(), 20U);
  for (const auto& [name, schema] : schemas) {
    const json& properties = schema.at("properties");
    EXPECT_EQ(properties.at("report").at("const"), "slamdb-" + name + "-2");
    EXPECT_EQ(schema.at("required").at(0), "report") << name;
    EXPECT_EQ(properties.contains("input") + properties.contains("inputs"), of_no_file.contains(name) ? 0 : 1) << name;
  }
}

TEST(JsonNames, ArePutDownOnTheirPage) {
  const std::string page = ReadWholeFile(SLAMDB_SCHEMAS "/../docs/json.md");
  for (const auto& [name, schema] : ReportSchemas())
    EXPECT_THAT(page, HasSubstr("(../schema/" + name + ".schema.json)")) << name;
}

// What earlier versions called otherwise, here and there.
TEST(JsonNames, NoOtherNameForTheSameThing) {
  for (const auto& [name, schema] : ReportSchemas()) {
    std::set<std::string> names;
    CollectNames(schema, names);
    for (const char* retired : {"file",
                                "files",
                                "store",
                                "file_bytes",
                                "archive",
                                "length",
                                "observers",
                                "reprojection_px",
                                "ok",
                                "errors",
                                "notes",
                                "applied",
                                "first_finding",
                                "undone",
                                "dry_run",
                                "map_point",
                                "old",
                                "new",
                                "rms",
                                "fit",
                                "atlas",
                                "largest_residual_of_all_pairs"})
      EXPECT_FALSE(names.contains(retired)) << name << " has " << retired;
  }
}

}  // namespace
}  // namespace slamdb::testing
