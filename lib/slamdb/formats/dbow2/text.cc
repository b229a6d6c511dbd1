// SPDX-License-Identifier: BSD-3-Clause
// `k L scoring weighting`, then a line for each node but the root: `parent is-word descriptor-bytes weight`.
// First the lines of each block of the file are counted, which says where in the columns its nodes go; then the blocks
// are parsed side by side.
#include "slamdb/base/detail/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/dbow2/detail/encoding.h"

namespace slamdb::dbow2 {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;
constexpr std::size_t kShortestLine = 70;  // `0 0 `, 32 times `0 `, `0`, a line feed

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Reads a number of at most `most_digits` digits and the spaces before it; false when there is none. The text ends with
// a character that is neither.
template <int most_digits>
bool ReadNumber(const char*& at, std::uint64_t& value) {
  while (*at == ' ') ++at;
  if (!IsDigit(*at)) return false;
  value = 0;
  for (int digit = 0; digit < most_digits && IsDigit(*at); ++digit)
    value = value * 10 + static_cast<unsigned>(*at++ - '0');
  return !IsDigit(*at);
}

bool ReadDescriptor(const char*& at, Descriptor& descriptor) {
  for (std::uint8_t& byte : descriptor) {
    std::uint64_t value = 0;
    if (!ReadNumber<3>(at, value) || value > 255) return false;
    byte = static_cast<std::uint8_t>(value);
  }
  return true;
}

bool ReadWeight(const char*& at, const char* end, double& weight) {
  while (*at == ' ') ++at;
  const auto [next, error] = std::from_chars(at, end, weight);
  at = next;
  return error == std::errc();
}

// What is wrong with the line [at, end), or null. `*end` can be read and is neither digit nor space.
const char* ParseLine(const char* at, const char* end, NodeTable& table, std::size_t node) {
  std::uint64_t parent = 0, is_word = 0;
  if (!ReadNumber<10>(at, parent) || parent >= VocabularyTree::kNoWord) return "expected the number of a parent node";
  if (!ReadNumber<1>(at, is_word) || is_word > 1) return "expected 1 for a word or 0 for an inner node";
  if (!ReadDescriptor(at, table.tree.descriptors[node])) return "expected a descriptor of 32 bytes, each 0 to 255";
  if (!ReadWeight(at, end, table.tree.weights[node])) return "expected a weight behind the descriptor";
  while (at < end && (*at == ' ' || *at == '\r')) ++at;
  if (at != end) return "expected the end of the line behind the weight";
  table.parents[node] = static_cast<std::uint32_t>(parent);
  table.is_word[node] = static_cast<std::uint8_t>(is_word);
  return nullptr;
}

struct Block {
  std::size_t first_node = 0;
  std::size_t bad_node = 0;  // the first one; 0: none
  const char* problem = nullptr;
};

// The lines of nodes, each of which ends with a line feed.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text), blocks_((text.size() + kBlock - 1) / kBlock) {}

  // Finds where in the columns the nodes of each block go, and returns the number of all.
  std::size_t Count(int threads);
  void Parse(NodeTable& table, int threads);

 private:
  // The lines that start in a block: the first one behind the last line feed before it.
  std::string_view LinesOf(std::size_t block) const;
  void ParseBlock(std::size_t block, NodeTable& table);

  std::string_view text_;
  std::vector<Block> blocks_;
};

std::string_view Lines::LinesOf(std::size_t block) const {
  const auto line_from = [&](std::size_t at) {
    if (at == 0 || at >= text_.size()) return std::min(at, text_.size());
    return std::min(text_.find('\n', at - 1), text_.size() - 1) + 1;
  };
  const std::size_t begin = line_from(block * kBlock);
  return text_.substr(begin, line_from((block + 1) * kBlock) - begin);
}

std::size_t Lines::Count(int threads) {
  std::vector<std::size_t> counts(blocks_.size());
  detail::ParallelFor(blocks_.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::string_view lines = LinesOf(i);
      counts[i] = static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n'));
    }
  });
  std::size_t nodes = 0;
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    blocks_[i].first_node = nodes + 1;
    nodes += counts[i];
  }
  return nodes;
}

void Lines::ParseBlock(std::size_t i, NodeTable& table) {
  Block& block = blocks_[i];
  std::string_view lines = LinesOf(i);
  for (std::size_t node = block.first_node; !lines.empty(); ++node) {
    const std::string_view line = detail::TakeLine(lines);
    block.problem = ParseLine(line.data(), line.data() + line.size(), table, node);
    if (block.problem != nullptr) {
      block.bad_node = node;
      return;
    }
  }
}

void Lines::Parse(NodeTable& table, int threads) {
  detail::ParallelFor(blocks_.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ParseBlock(i, table);
  });
  for (const Block& block : blocks_)
    if (block.problem != nullptr)
      throw Error(ErrorKind::kDamaged, table.path, table.place(static_cast<std::uint32_t>(block.bad_node)),
                  block.problem);
}

}  // namespace

std::optional<Header> ParseTextHeader(std::string_view file) {
  constexpr std::size_t kLongestLine = 256;
  if (detail::IsUtf16(file)) return std::nullopt;
  std::string_view lines = detail::WithoutMark(file).substr(0, kLongestLine);
  std::string_view line = detail::TakeLine(lines);
  const auto bytes = static_cast<std::size_t>(lines.data() - file.data());
  if (bytes == 0 || file[bytes - 1] != '\n') return std::nullopt;
  std::array<int, 4> numbers{};  // k, L, scoring, weighting
  for (int& number : numbers) {
    const auto word = detail::ParseNumber<int>(detail::TakeWord(line, detail::kBlanks));
    if (!word) return std::nullopt;
    number = *word;
  }
  const auto [branching, depth, scoring, weighting] = numbers;
  return Header{branching, depth, scoring, weighting, bytes};
}

VocabularyTree ParseText(const std::string& path, std::string_view file, const Header& header, int threads) {
  std::string_view body = file.substr(header.bytes);
  while (!body.empty() && (body.back() == '\n' || body.back() == '\r' || body.back() == ' ')) body.remove_suffix(1);
  const std::size_t last_line = body.rfind('\n') + 1;  // 0 when there is only one
  const std::string last(body.substr(last_line));      // ends with a character that may be read, as the others do
  Lines lines(body.substr(0, last_line));
  const std::size_t nodes = lines.Count(threads) + !last.empty();
  if (nodes > body.size() / kShortestLine + 1)
    throw Error(ErrorKind::kDamaged, path, "",
                detail::Concat("has ", nodes, " lines in ", file.size(), " bytes, too short for a node each"));
  NodeTable table(header, nodes, path);
  table.place = [](std::uint32_t node) { return detail::Concat("line ", node + 1); };
  lines.Parse(table, threads);
  const char* problem = ParseLine(last.data(), last.data() + last.size(), table, nodes);
  if (problem != nullptr)
    throw Error(ErrorKind::kDamaged, path, table.place(static_cast<std::uint32_t>(nodes)), problem);
  return LinkNodes(std::move(table));
}

std::uint64_t CountWordsOfText(std::string_view lines) {
  std::uint64_t words = 0;
  while (!lines.empty()) {
    const std::size_t parent = lines.find_first_not_of(' ');
    const std::size_t space = lines.find(' ', parent);
    if (space == lines.npos) break;
    const char* end = static_cast<const char*>(std::memchr(lines.data(), '\n', lines.size()));
    const std::size_t length = end == nullptr ? lines.size() : static_cast<std::size_t>(end - lines.data()) + 1;
    words += space + 2 < length && lines[space + 1] == '1' && lines[space + 2] == ' ';
    lines.remove_prefix(length);
  }
  return words;
}

}  // namespace slamdb::dbow2
