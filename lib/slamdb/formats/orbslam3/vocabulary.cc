// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/vocabulary.h"

#include <array>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <future>
#include <string_view>

#include "slamdb/base/file_stream.h"
#include "slamdb/base/hash.h"

namespace slamdb {
namespace {

constexpr std::array<const char*, 6> kScorings{"L1", "L2", "chi square", "KL", "Bhattacharyya", "dot product"};
constexpr std::array<const char*, 4> kWeightings{"TF-IDF", "TF", "IDF", "binary"};

// The leaves: each line behind the first is `parent is_leaf descriptor weight`.
std::uint64_t CountWords(std::string_view lines) {
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

std::optional<VocabularyShape> ReadShape(std::string_view text) {
  const std::size_t line_end = text.substr(0, 256).find('\n');
  if (line_end == text.npos) return std::nullopt;
  std::array<int, 4> header{};  // k, L, scoring, weighting
  const char* next = text.data();
  const char* const end = text.data() + line_end;
  for (int& value : header) {
    while (next != end && *next == ' ') ++next;
    const auto [parsed, error] = std::from_chars(next, end, value);
    if (error != std::errc()) return std::nullopt;
    next = parsed;
  }
  const auto [branching, depth, scoring, weighting] = header;
  if (branching < 2 || branching > 64 || depth < 1 || depth > 20 || scoring < 0 || weighting < 0 ||
      static_cast<std::size_t>(scoring) >= kScorings.size() ||
      static_cast<std::size_t>(weighting) >= kWeightings.size())
    return std::nullopt;
  return VocabularyShape{branching, depth, kScorings[static_cast<std::size_t>(scoring)],
                         kWeightings[static_cast<std::size_t>(weighting)], CountWords(text.substr(line_end + 1))};
}

}  // namespace

VocabularyFile ReadVocabularyFile(const std::string& path) {
  FileStream file(path);
  file.FillTo(file.size());
  const std::string_view text(file.data(), file.size());
  VocabularyFile vocabulary;
  auto shape = std::async(std::launch::async, [&] { return ReadShape(text); });
  vocabulary.identity.name = std::filesystem::path(path).filename().string();
  vocabulary.identity.checksum = Md5(std::as_bytes(std::span(text)));
  vocabulary.shape = shape.get();
  return vocabulary;
}

std::string VocabularyMismatch(const Vocabulary& of_atlas, const Vocabulary& of_file) {
  if (of_atlas.checksum == of_file.checksum) return {};
  if (of_atlas.checksum.empty()) return "the atlas has no checksum: its writer could not open the vocabulary file";
  if (of_atlas.checksum == kChecksumOfNothing)
    return "the atlas has the checksum of an empty file, as ORB-SLAM3 built with libc++ (macOS) writes it";
  return "the checksum differs: " + of_atlas.checksum + " ('" + of_atlas.name + "') in the atlas, " + of_file.checksum +
         " ('" + of_file.name + "') given";
}

}  // namespace slamdb
