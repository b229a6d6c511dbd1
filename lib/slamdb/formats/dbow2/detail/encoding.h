// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "slamdb/model/vocabulary_tree.h"

// How a vocabulary stands in its file; schema/vocabulary.md is the description.
namespace slamdb::dbow2 {

// The numbers at the front of both encodings.
struct Header {
  int branching = 0, depth = 0, scoring = 0, weighting = 0;
  std::size_t bytes = 0;  // of the header: the nodes start there
};

// nullopt when the file does not start like a vocabulary of that encoding with numbers that DBoW2 takes.
std::optional<Header> ParseTextHeader(std::string_view file);
std::optional<Header> ParseBinaryHeader(std::string_view file);

// The nodes of the file, checked, on `threads` threads. Memory stays below the file's own. Throws Error naming the line
// or the byte of the first bad node.
VocabularyTree ParseText(const std::string& path, std::string_view file, const Header& header, int threads);
VocabularyTree ParseBinary(const std::string& path, std::string_view file, const Header& header, int threads);

// Words in a text vocabulary whose nodes are `lines`, without parsing or checking them.
std::uint64_t CountWordsOfText(std::string_view lines);

// Nodes as they are read, before they are linked: columns by node, of which entry 0, the root, is left alone.
struct NodeTable {
  VocabularyTree tree;  // descriptors and weights are filled by the reader, the rest by LinkNodes
  Column<std::uint32_t> parents;
  Column<std::uint8_t> is_word;
  std::string path;
  std::function<std::string(std::uint32_t node)> place;  // where a node stands in the file, for errors

  NodeTable(const Header& header, std::size_t nodes, std::string path);
};

// Numbers the words and finds the children. Throws Error for the first node whose parent does not come before it, is a
// word, or has too many children; that is too deep; that is no word and has no children; whose weight is not a number.
VocabularyTree LinkNodes(NodeTable table);

}  // namespace slamdb::dbow2
