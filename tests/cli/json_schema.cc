// SPDX-License-Identifier: BSD-3-Clause
#include "tests/cli/json_schema.h"

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;

bool HasType(const json& value, const std::string& type) {
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  return type == value.type_name();
}

class Validator {
 public:
  explicit Validator(const json& root) : root_(root) {}

  std::string Breach(const json& value, const json& schema, const std::string& place) const {
    if (schema.is_boolean()) return schema.get<bool>() ? "" : place + ": is not allowed";
    if (schema.contains("$ref")) return Breach(value, Resolve(schema.at("$ref")), place);
    if (schema.contains("type") && !HasOneType(value, schema.at("type")))
      return place + ": is " + value.type_name() + ", expected " + schema.at("type").dump();
    if (schema.contains("enum") &&
        std::find(schema.at("enum").begin(), schema.at("enum").end(), value) == schema.at("enum").end())
      return place + ": is " + value.dump() + ", expected one of " + schema.at("enum").dump();
    if (schema.contains("const") && schema.at("const") != value)
      return place + ": is " + value.dump() + ", expected " + schema.at("const").dump();
    if (schema.contains("minimum") && value.is_number() && value < schema.at("minimum"))
      return place + ": is " + value.dump() + ", expected at least " + schema.at("minimum").dump();
    if (value.is_string() && (value.get<std::string>().size() < schema.value("minLength", std::size_t{0}) ||
                              value.get<std::string>().size() > schema.value("maxLength", std::string::npos)))
      return place + ": is of " + std::to_string(value.get<std::string>().size()) + " bytes";
    if (schema.contains("anyOf"))
      if (std::string breach = AnyBreach(value, schema.at("anyOf"), place); !breach.empty()) return breach;
    if (value.is_object()) return ObjectBreach(value, schema, place);
    return value.is_array() ? ArrayBreach(value, schema, place) : "";
  }

 private:
  const json& Resolve(const std::string& reference) const { return root_.at(json::json_pointer(reference.substr(1))); }

  static bool HasOneType(const json& value, const json& types) {
    if (types.is_string()) return HasType(value, types);
    return std::any_of(types.begin(), types.end(), [&](const json& type) { return HasType(value, type); });
  }

  std::string AnyBreach(const json& value, const json& schemas, const std::string& place) const {
    std::string breaches;
    for (const json& schema : schemas) {
      const std::string breach = Breach(value, schema, place);
      if (breach.empty()) return breach;
      breaches += (breaches.empty() ? "" : "; or ") + breach;
    }
    return breaches;
  }

  std::string ObjectBreach(const json& value, const json& schema, const std::string& place) const {
    for (const json& name : schema.value("required", json::array()))
      if (!value.contains(name.get<std::string>())) return place + ": lacks " + name.dump();
    const json properties = schema.value("properties", json::object());
    const json rest = schema.value("additionalProperties", json(true));
    for (const auto& [name, member] : value.items()) {
      const json& expected = properties.contains(name) ? properties.at(name) : rest;
      if (std::string breach = Breach(member, expected, place + "." + name); !breach.empty()) return breach;
    }
    return "";
  }

  std::string ArrayBreach(const json& value, const json& schema, const std::string& place) const {
    if (value.size() < schema.value("minItems", std::size_t{0}) ||
        value.size() > schema.value("maxItems", value.size()))
      return place + ": has " + std::to_string(value.size()) + " items";
    const json items = schema.value("items", json(true));
    for (std::size_t i = 0; i < value.size(); ++i)
      if (std::string breach = Breach(value[i], items, place + "." + std::to_string(i)); !breach.empty()) return breach;
    return "";
  }

  const json& root_;
};

}  // namespace

std::string BreachOf(const json& value, const std::string& schema_name) {
  const json schema = json::parse(ReadWholeFile(std::string(SLAMDB_SCHEMAS "/") + schema_name));
  return Validator(schema).Breach(value, schema, "$");
}

}  // namespace slamdb::testing
