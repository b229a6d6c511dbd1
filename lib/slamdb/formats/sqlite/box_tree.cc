// SPDX-License-Identifier: BSD-3-Clause
// Building the R*Tree anew, from SQLite's description of its three tables (ext/rtree/rtree.c, "Database Format"):
//   1. the leaves: runs of points along a Morton curve, as many as fit a node
//   2. level by level their parents, until one node is left: the root, which is node 1 and knows the tree's depth
//   3. map_point_box_rowid says which leaf has a point, map_point_box_parent which node is whose parent
// A node is big endian: depth (root only) and number of cells, 2 bytes each; cells of an 8-byte row or node number and
// the bounds min x, max x, min y, ... as 4-byte floats; zeros up to the size that all nodes have.
#include "slamdb/formats/sqlite/detail/box_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <unordered_set>
#include <utility>

#include "slamdb/formats/sqlite/detail/batch_insert.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kCellBytes = 8 + 6 * sizeof(float);
constexpr std::size_t kNodeHeaderBytes = 4;
constexpr std::int64_t kRoot = 1;
constexpr std::size_t kRebuildFraction = 8;  // rebuild when more than one in so many is new

// Every third bit of the result is a bit of `value`'s lowest 21.
std::uint64_t Spread(std::uint64_t value) {
  value &= 0x1fffff;
  value = (value | value << 32) & 0x1f00000000ffff;
  value = (value | value << 16) & 0x1f0000ff0000ff;
  value = (value | value << 8) & 0x100f00f00f00f00f;
  value = (value | value << 4) & 0x10c30c30c30c30c3;
  return (value | value << 2) & 0x1249249249249249;
}

// Sorts along a Morton curve through the box of all finite positions; equal places by row.
void SortByPlace(std::vector<PointBox>& boxes) {
  constexpr float kCells = 2097151;
  Eigen::AlignedBox3f all;
  for (const PointBox& box : boxes) {
    if (box.position.allFinite()) all.extend(box.position);
  }
  const Eigen::Array3f scale = kCells / (all.max() - all.min()).array().max(1e-30F);
  struct Keyed {
    std::uint64_t code;
    PointBox box;
  };
  std::vector<Keyed> keyed;
  keyed.reserve(boxes.size());
  for (const PointBox& box : boxes) {
    std::uint64_t code = 0;
    if (box.position.allFinite()) {
      const Eigen::Array3f cell = ((box.position - all.min()).array() * scale).max(0.0F).min(kCells);
      code = Spread(static_cast<std::uint64_t>(cell.x())) | Spread(static_cast<std::uint64_t>(cell.y())) << 1 |
             Spread(static_cast<std::uint64_t>(cell.z())) << 2;
    }
    keyed.push_back({code, box});
  }
  std::sort(keyed.begin(), keyed.end(),
            [](const Keyed& a, const Keyed& b) { return a.code != b.code ? a.code < b.code : a.box.row < b.box.row; });
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = keyed[i].box;
}

void InsertOneByOne(Database& database, const std::vector<PointBox>& boxes) {
  Statement insert(database, "INSERT OR REPLACE INTO map_point_box VALUES (?1, ?2, ?2, ?3, ?3, ?4, ?4)",
                   "table map_point_box");
  for (const PointBox& box : boxes) {
    insert.Bind(1, box.row).BindReal(2, box.position.x()).BindReal(3, box.position.y());
    insert.BindReal(4, box.position.z()).Run();
  }
}

// One entry of a node: a point, or a node of the level below.
struct Cell {
  std::int64_t number = 0;
  Eigen::Array3f min, max;
};

template <class T>
void PutBigEndian(char*& to, T value) {
  for (std::size_t i = sizeof(T); i-- > 0;) *to++ = static_cast<char>(value >> (8 * i));
}

// Writes the nodes of the tree while it is built.
class TreeWriter {
 public:
  TreeWriter(Database& database, std::size_t points)
      : database_(database),
        node_bytes_(
            static_cast<std::size_t>(database.Integer("SELECT length(data) FROM map_point_box_node WHERE nodeno = 1"))),
        node_(database, "INSERT OR REPLACE INTO map_point_box_node VALUES (?1, ?2)", "table map_point_box_node"),
        parent_(database, "INSERT INTO map_point_box_parent VALUES (?1, ?2)", "table map_point_box_parent") {
    if (node_bytes_ < kNodeHeaderBytes + 2 * kCellBytes || node_bytes_ > 65536) {
      throw Error(ErrorKind::kDamaged, database.path(), "table map_point_box_node, row 1",
                  "no root of an R*Tree: the store is damaged");
    }
    leaf_of_.reserve(points);
  }

  std::size_t cells_per_node() const { return (node_bytes_ - kNodeHeaderBytes) / kCellBytes; }

  // Writes `cells` as nodes and returns the cells of their parents. `depth`: levels below these nodes.
  std::vector<Cell> WriteLevel(const std::vector<Cell>& cells, int depth) {
    const std::size_t nodes = (cells.size() + cells_per_node() - 1) / cells_per_node();
    std::vector<Cell> parents;
    parents.reserve(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
      // Equal shares, so that no node is emptier than SQLite would allow.
      const std::size_t first = cells.size() * i / nodes;
      const std::size_t end = cells.size() * (i + 1) / nodes;
      parents.push_back(WriteNode({cells.data() + first, end - first}, depth, nodes == 1));
    }
    return parents;
  }

  // Which leaf has each point; after the last level. In the order of their rows, so that the table grows at its end.
  void WriteLeafOfPoints() {
    std::sort(leaf_of_.begin(), leaf_of_.end());
    BatchInsert insert(database_, "map_point_box_rowid", 2);
    for (const auto& [point, leaf] : leaf_of_) insert.Add(std::array<Value, 2>{point, leaf});
    insert.Flush();
  }

 private:
  Cell WriteNode(std::span<const Cell> cells, int depth, bool is_root) {
    Cell node{.number = is_root ? kRoot : ++last_node_, .min = cells[0].min, .max = cells[0].max};
    std::string bytes(node_bytes_, '\0');
    char* to = bytes.data();
    PutBigEndian(to, static_cast<std::uint16_t>(is_root ? depth : 0));
    PutBigEndian(to, static_cast<std::uint16_t>(cells.size()));
    for (const Cell& cell : cells) {
      PutBigEndian(to, static_cast<std::uint64_t>(cell.number));
      for (int axis = 0; axis < 3; ++axis) {
        PutBigEndian(to, std::bit_cast<std::uint32_t>(cell.min[axis]));
        PutBigEndian(to, std::bit_cast<std::uint32_t>(cell.max[axis]));
      }
      node.min = node.min.min(cell.min);
      node.max = node.max.max(cell.max);
      if (depth == 0)
        leaf_of_.emplace_back(cell.number, node.number);
      else
        parent_.Bind(1, cell.number).Bind(2, node.number).Run();
    }
    node_.Bind(1, node.number).BindBlob(2, std::as_bytes(std::span(bytes))).Run();
    return node;
  }

  Database& database_;
  std::size_t node_bytes_;
  std::int64_t last_node_ = kRoot;
  Statement node_, parent_;
  std::vector<std::pair<std::int64_t, std::int64_t>> leaf_of_;
};

// Lets statements write the tables behind the R*Tree, which the connection forbids otherwise.
class ShadowTableAccess {
 public:
  explicit ShadowTableAccess(Database& database) : database_(database) { Set(0); }
  ~ShadowTableAccess() { Set(1); }
  ShadowTableAccess(const ShadowTableAccess&) = delete;
  ShadowTableAccess& operator=(const ShadowTableAccess&) = delete;

 private:
  void Set(int defensive) { sqlite3_db_config(database_.handle(), SQLITE_DBCONFIG_DEFENSIVE, defensive, nullptr); }
  Database& database_;
};

void Rebuild(Database& database, const std::vector<PointBox>& boxes) {
  const ShadowTableAccess access(database);
  database.Execute(
      "DELETE FROM map_point_box_rowid; DELETE FROM map_point_box_parent; DELETE FROM map_point_box_node WHERE nodeno "
      "<> 1");
  std::vector<Cell> cells;
  cells.reserve(boxes.size());
  for (const PointBox& box : boxes) cells.push_back({box.row, box.position, box.position});
  TreeWriter writer(database, boxes.size());
  int depth = 0;
  do {
    cells = writer.WriteLevel(cells, depth++);
  } while (cells.size() > 1);
  writer.WriteLeafOfPoints();
}

std::vector<PointBox> AllBoxesBut(Database& database, const std::vector<PointBox>& replaced) {
  std::unordered_set<std::int64_t> rows;
  for (const PointBox& box : replaced) rows.insert(box.row);
  Statement statement(database, "SELECT row, min_x, min_y, min_z FROM map_point_box", "table map_point_box");
  std::vector<PointBox> boxes;
  while (statement.Step()) {
    if (rows.contains(statement.Integer(0))) continue;
    const auto coordinate = [&](int column) { return static_cast<float>(statement.Real(column)); };
    boxes.push_back({statement.Integer(0), {coordinate(1), coordinate(2), coordinate(3)}});
  }
  return boxes;
}

}  // namespace

void UpdateBoxes(Database& database, std::vector<PointBox> boxes) {
  if (boxes.empty()) return;
  const auto there = static_cast<std::size_t>(database.Integer("SELECT count(*) FROM map_point_box_rowid"));
  if (boxes.size() * kRebuildFraction > there) {
    const std::vector<PointBox> kept = AllBoxesBut(database, boxes);
    boxes.insert(boxes.end(), kept.begin(), kept.end());
    SortByPlace(boxes);
    Rebuild(database, boxes);
  } else {
    SortByPlace(boxes);
    InsertOneByOne(database, boxes);
  }
}

}  // namespace slamdb::sqlite
