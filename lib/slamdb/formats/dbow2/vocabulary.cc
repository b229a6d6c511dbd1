// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/dbow2/vocabulary.h"

#include <array>
#include <filesystem>
#include <future>
#include <string_view>

#include "slamdb/base/detail/file_stream.h"
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/dbow2/detail/encoding.h"

namespace slamdb {
namespace {

using dbow2::Header;

constexpr std::array<const char*, 6> kScorings{"L1", "L2", "chi square", "KL", "Bhattacharyya", "dot product"};
constexpr std::array<const char*, 4> kWeightings{"TF-IDF", "TF", "IDF", "binary"};

bool IsUsable(const std::optional<Header>& header) {
  return header && header->branching >= 2 && header->branching <= 64 && header->depth >= 1 && header->depth <= 20 &&
         header->scoring >= 0 && static_cast<std::size_t>(header->scoring) < kScorings.size() &&
         header->weighting >= 0 && static_cast<std::size_t>(header->weighting) < kWeightings.size();
}

std::optional<VocabularyShape> ReadShape(std::string_view file) {
  const auto header = dbow2::ParseTextHeader(file);
  if (!IsUsable(header)) return std::nullopt;
  return VocabularyShape{header->branching, header->depth, kScorings[static_cast<std::size_t>(header->scoring)],
                         kWeightings[static_cast<std::size_t>(header->weighting)],
                         dbow2::CountWordsOfText(file.substr(header->bytes))};
}

Vocabulary Identify(const std::string& path, std::string_view file) {
  return {std::filesystem::path(path).filename().string(), detail::Md5(std::as_bytes(std::span(file)))};
}

// What people take for a vocabulary that ORB-SLAM3 reads; empty when it is one, or its binary form.
std::string DescribeOther(const std::string& path, std::string_view file) {
  if (IsUsable(dbow2::ParseTextHeader(file)) || IsUsable(dbow2::ParseBinaryHeader(file))) return {};
  const auto recognized = detail::Recognize(Probe::Of({std::as_bytes(std::span(file)), path}));
  if (recognized && recognized->id != "vocabulary") return detail::SentenceOf(*recognized, "a DBoW2 vocabulary");
  return "is no DBoW2 vocabulary: neither text (a first line `k L scoring weighting`) nor its binary form";
}

// A stream is refused by its beginning.
void RefuseStream(const Probe& beginning) {
  const std::string other = DescribeOther(beginning.path, beginning.head);
  if (!other.empty()) throw Error(ErrorKind::kUnsupported, beginning.path, "", other);
}

VocabularyTree ParseTree(const std::string& path, std::string_view file, int threads) {
  if (const auto text = dbow2::ParseTextHeader(file); IsUsable(text))
    return dbow2::ParseText(path, file, *text, threads);
  if (const auto binary = dbow2::ParseBinaryHeader(file); IsUsable(binary))
    return dbow2::ParseBinary(path, file, *binary, threads);
  throw Error(file.empty() ? ErrorKind::kDamaged : ErrorKind::kUnsupported, path, "", DescribeOther(path, file));
}

}  // namespace

VocabularyFile ReadVocabularyFile(const Source& source) {
  detail::FileStream file(source, RefuseStream);
  file.FillTo(file.size());
  const std::string_view bytes(file.data(), file.size());
  auto shape = std::async(std::launch::async, [&] { return ReadShape(bytes); });
  VocabularyFile vocabulary{.identity = Identify(source.path, bytes)};
  vocabulary.other = DescribeOther(source.path, bytes);
  vocabulary.shape = shape.get();
  return vocabulary;
}

LoadedVocabulary LoadVocabulary(const Source& source, int threads) {
  detail::FileStream file(source, RefuseStream);
  file.FillTo(file.size());
  const std::string_view bytes(file.data(), file.size());
  auto identity = std::async(std::launch::async, [&] { return Identify(source.path, bytes); });
  LoadedVocabulary vocabulary{.tree = ParseTree(source.path, bytes, threads)};
  vocabulary.identity = identity.get();
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
