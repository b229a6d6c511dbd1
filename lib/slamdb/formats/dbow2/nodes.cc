// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "slamdb/base/error.h"
#include "slamdb/formats/dbow2/detail/encoding.h"

namespace slamdb::dbow2 {
namespace {

std::string Name(std::uint32_t node) { return "node " + std::to_string(node); }

// What is wrong with a node beside those before it; empty when nothing is. `levels` and `children` are of the nodes so
// far. ORB-SLAM2's loader makes one node too many of a line feed at the end, and converters wrote it into binary files
// as one more word of weight 0, so a node may have one child more than the branching.
std::string Problem(const NodeTable& table, std::uint32_t node, const Column<std::uint8_t>& levels,
                    const Column<std::uint32_t>& children) {
  const VocabularyTree& tree = table.tree;
  const std::uint32_t parent = table.parents[node];
  if (parent >= node)
    return "the parent of " + Name(node) + " is " + std::to_string(parent) + ", which does not come before it";
  if (parent != 0 && table.is_word[parent] != 0)
    return Name(node) + " is a child of node " + std::to_string(parent) + ", which is a word";
  if (levels[parent] >= tree.depth)
    return Name(node) + " is deeper than the " + std::to_string(tree.depth) + " levels that the file names";
  if (children[parent] > static_cast<std::uint32_t>(tree.branching))
    return "node " + std::to_string(parent) + " has more than the " + std::to_string(tree.branching) +
           " children that the file names";
  const double weight = tree.weights[node];
  if (!std::isfinite(weight) || weight < 0) return "the weight of " + Name(node) + " is not a positive number";
  return {};
}

// Numbers words and counts children; returns the counts.
Column<std::uint32_t> Survey(NodeTable& table) {
  VocabularyTree& tree = table.tree;
  const auto nodes = static_cast<std::uint32_t>(tree.weights.size());
  Column<std::uint8_t> levels(nodes);
  Column<std::uint32_t> children(nodes, 0U);
  levels[0] = 0;
  table.is_word[0] = 0;
  tree.words.resize(nodes, VocabularyTree::kNoWord);
  for (std::uint32_t node = 1; node < nodes; ++node) {
    const std::string problem = Problem(table, node, levels, children);
    if (!problem.empty()) throw Error(ErrorKind::kDamaged, table.path, table.place(node), problem);
    const std::uint32_t parent = table.parents[node];
    ++children[parent];
    levels[node] = static_cast<std::uint8_t>(levels[parent] + 1);
    if (table.is_word[node] != 0) tree.words[node] = tree.word_count++;
  }
  for (std::uint32_t node = 1; node < nodes; ++node)
    if (children[node] == 0 && table.is_word[node] == 0)
      throw Error(ErrorKind::kDamaged, table.path, table.place(node), Name(node) + " is no word and has no children");
  return children;
}

}  // namespace

NodeTable::NodeTable(const Header& header, std::size_t nodes, std::string path_of_file)
    : path(std::move(path_of_file)) {
  if (nodes == 0) throw Error(ErrorKind::kDamaged, path, "", "is a vocabulary without words");
  if (nodes >= VocabularyTree::kNoWord)
    throw Error(ErrorKind::kUnsupported, path, "", "has more nodes than a vocabulary can number");
  tree.branching = header.branching;
  tree.depth = header.depth;
  tree.scoring = static_cast<WordScoring>(header.scoring);
  tree.weighting = static_cast<WordWeighting>(header.weighting);
  tree.descriptors.resize(nodes + 1);
  tree.weights.resize(nodes + 1);
  parents.resize(nodes + 1);
  is_word.resize(nodes + 1);
  tree.descriptors[0] = {};
  tree.weights[0] = 0;
}

VocabularyTree LinkNodes(NodeTable table) {
  Column<std::uint32_t> next = Survey(table);
  VocabularyTree& tree = table.tree;
  const auto nodes = static_cast<std::uint32_t>(next.size());
  tree.first_child.resize(nodes + 1);
  std::uint32_t sum = 0;
  for (std::uint32_t node = 0; node < nodes; ++node) {
    tree.first_child[node] = sum;
    sum += std::exchange(next[node], sum);
  }
  tree.first_child[nodes] = sum;
  tree.children.resize(sum);
  for (std::uint32_t node = 1; node < nodes; ++node) tree.children[next[table.parents[node]]++] = node;
  return std::move(table.tree);
}

}  // namespace slamdb::dbow2
