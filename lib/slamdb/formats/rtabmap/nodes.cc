// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rtabmap/detail/nodes.h"

#include <algorithm>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/sqlite/detail/foreign.h"

namespace slamdb::rtabmap {
namespace {

using detail::Concat;
using sqlite::Database;
using sqlite::SelectColumns;
using sqlite::Statement;

constexpr std::int64_t kMostIds = std::numeric_limits<std::int32_t>::max();

Place RowOf(Database& database, const char* table, std::int64_t row) {
  return {database.path(), Concat("table ", table, ", row ", row)};
}

Version VersionOf(Database& database) {
  Statement statement(database, SelectColumns(database, "Admin", {"version"}) + " LIMIT 1", "table Admin");
  const std::string text = statement.Step() ? statement.Text(0) : "";
  const std::vector<std::string_view> parts = detail::Split(text, '.');
  std::array<int, 3> numbers{};
  bool sound = parts.size() == numbers.size();
  for (std::size_t i = 0; sound && i < numbers.size(); ++i) {
    const auto number = detail::ParseNumber<std::uint16_t>(parts[i]);
    sound = number.has_value();
    numbers[i] = number.value_or(0);
  }
  if (!sound)
    throw Error(ErrorKind::kDamaged, database.path(), "table Admin",
                Concat("its version is `", text, "`, expected one such as 0.21.4"));
  const Version version{numbers[0], numbers[1], numbers[2]};
  if (version < Version{0, 11, 0})
    throw Error(ErrorKind::kUnsupported, database.path(), "",
                Concat("is a database of RTAB-Map ", text, "; slamdb reads those since 0.11"));
  return version;
}

void ReadNodes(Database& database, Graph& graph) {
  Statement statement(
      database,
      SelectColumns(database, "Node", {"id", "map_id", "stamp", "pose", "ground_truth_pose", "gps"}) + " ORDER BY id",
      "table Node");
  while (statement.Step()) {
    const std::int64_t id = statement.Integer(0), session = statement.Integer(1);
    if (id <= 0 || id > kMostIds || (!graph.nodes.empty() && graph.nodes.back().id == static_cast<std::uint64_t>(id))) {
      ++graph.lost_nodes;
      continue;
    }
    const Place place = RowOf(database, "Node", id);
    Node& node = graph.nodes.emplace_back();
    node.id = static_cast<std::uint64_t>(id);
    node.session = static_cast<std::uint32_t>(std::clamp<std::int64_t>(session, 0, kMostIds));
    node.stamp = statement.Real(2);
    node.odometry = PoseOf(statement.Blob(3), place);
    node.truth = PoseOf(statement.Blob(4), place);
    node.gps = FixOf(statement.Blob(5), node.stamp, place);
  }
}

Node* Find(Graph& graph, std::int64_t id) {
  if (id <= 0) return nullptr;
  const auto found = std::ranges::lower_bound(graph.nodes, static_cast<std::uint64_t>(id), {}, &Node::id);
  return found != graph.nodes.end() && found->id == static_cast<std::uint64_t>(id) ? &*found : nullptr;
}

// What RTAB-Map saved of its graph when it was closed.
void ReadOptimized(Database& database, Graph& graph) {
  Statement statement(database, SelectColumns(database, "Admin", {"opt_ids", "opt_poses"}) + " LIMIT 1", "table Admin");
  if (!statement.Step()) return;
  const Place place{database.path(), "table Admin, optimised poses"};
  const std::vector<std::int32_t> ids = IntegersOf(statement.Blob(0), place);
  const std::vector<float> poses = FloatsOf(statement.Blob(1), place);
  if (poses.size() != 12 * ids.size())
    place.Fail(Concat("has ", poses.size(), " numbers of poses for ", ids.size(), " nodes, expected 12 each"));
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (Node* node = Find(graph, ids[i])) node->optimized = PoseOf(poses.data() + 12 * i, place);
}

void ReadCalibrations(Database& database, Graph& graph, const ReadOptions& options) {
  Statement statement(database, SelectColumns(database, "Data", {"id", "calibration"}), "table Data");
  std::size_t done = 0;
  while (statement.Step()) {
    Node* node = Find(graph, statement.Integer(0));
    if (node == nullptr) continue;
    node->cameras = CalibrationOf(statement.Blob(1), graph.version, RowOf(database, "Data", statement.Integer(0)));
    if (std::ranges::any_of(node->cameras, [](const NodeCamera& camera) { return !camera.is_valid(); }))
      node->cameras.clear();
    if (options.progress)
      options.progress("reading calibrations", static_cast<double>(++done) / static_cast<double>(graph.nodes.size()));
  }
}

// RTAB-Map stores most of them twice, once for each end.
void ReadLinks(Database& database, Graph& graph) {
  Statement statement(database, SelectColumns(database, "Link", {"from_id", "to_id", "type"}), "table Link");
  while (statement.Step()) {
    const std::int64_t from = statement.Integer(0), to = statement.Integer(1);
    Link link{.type = statement.Integer(2)};
    if ((!link.is_closure() && !link.is_neighbor()) || from == to || from <= 0 || to <= 0) {
      ++graph.other_links;
      continue;
    }
    link.from = static_cast<std::uint64_t>(std::min(from, to));
    link.to = static_cast<std::uint64_t>(std::max(from, to));
    graph.links.push_back(link);
  }
  std::ranges::sort(graph.links);
  graph.links.erase(std::unique(graph.links.begin(), graph.links.end()), graph.links.end());
}

// `...;Kp/DetectorStrategy:2;...`, of the run that wrote last.
std::optional<double> ParameterOf(std::string_view parameters, std::string_view name) {
  for (const std::string_view parameter : detail::Split(parameters, ';')) {
    if (parameter.starts_with(name) && parameter.substr(name.size()).starts_with(':'))
      return detail::ParseNumber<double>(parameter.substr(name.size() + 1));
  }
  return std::nullopt;
}

// Only ORB has octaves that differ by what its parameters say.
double ScaleFactorOf(Database& database) {
  constexpr double kUsual = 1.2, kOrb = 2;
  if (!sqlite::ColumnsOf(database, "Info").contains("parameters")) return kUsual;
  Statement statement(database, "SELECT parameters FROM Info ORDER BY rowid DESC LIMIT 1", "table Info");
  const std::string parameters = statement.Step() ? statement.Text(0) : "";
  if (ParameterOf(parameters, "Kp/DetectorStrategy") != kOrb) return kUsual;
  const double factor = ParameterOf(parameters, "ORB/ScaleFactor").value_or(kUsual);
  return factor > 1 && factor <= 4 ? factor : kUsual;
}

}  // namespace

Graph ReadGraph(Database& database, const ReadOptions& options) {
  Graph graph;
  graph.version = VersionOf(database);
  ReadNodes(database, graph);
  ReadOptimized(database, graph);
  ReadCalibrations(database, graph, options);
  ReadLinks(database, graph);
  graph.scale_factor = ScaleFactorOf(database);
  return graph;
}

}  // namespace slamdb::rtabmap
