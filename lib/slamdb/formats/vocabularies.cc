// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/vocabularies.h"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"

namespace slamdb {
namespace {

using nlohmann::ordered_json;

bool IsAtlas(const HeldSource& held, const ReadOptions& read) {
  return !read.format.empty() || FindFormatOfInput(held) != nullptr ||
         std::filesystem::is_directory(held.source().path);
}

ordered_json JsonOf(const ShownVocabulary& shown) {
  const Vocabulary& vocabulary = shown.vocabulary;
  ordered_json json = {{"input", shown.input},
                       {"kind", shown.file ? "vocabulary" : "atlas"},
                       {"vocabulary", {{"name", vocabulary.name}, {"checksum", vocabulary.checksum}}}};
  if (const auto& shape = shown.file ? shown.file->shape : std::nullopt)
    json["shape"] = {{"words", shape->words},
                     {"branching", shape->branching},
                     {"depth", shape->depth},
                     {"weighting", shape->weighting},
                     {"scoring", shape->scoring}};
  return json;
}

void Require(const std::string& problem) {
  if (!problem.empty()) throw Error(ErrorKind::kUsage, problem);
}

}  // namespace

ShownVocabulary ShowVocabulary(const std::string& path, const ReadOptions& options, Notices& notices) {
  ReadOptions read = options;
  read.needs = Content::kBagOfWords;
  read.features = FeatureColumns::kNone;
  const Location location(path);
  const HeldSource held({location.path, location.name}, [](const Probe& beginning) {
    detail::RefuseOther(beginning, "an atlas or a vocabulary", {"archive", "gzip", "vocabulary", "binary-vocabulary"});
  });
  if (IsAtlas(held, read)) return {.input = path, .vocabulary = ReadAtlas(held, read, &notices).vocabulary, .file = {}};
  const VocabularyFile file = ReadVocabularyFile(held.source());
  if (file.identity.checksum == kChecksumOfNothing) throw Error(ErrorKind::kDamaged, path, "", "is empty");
  return {.input = path, .vocabulary = file.identity, .file = file};
}

std::string ToJson(std::span<const ShownVocabulary> shown) {
  ordered_json json = detail::ReportHead("vocabulary");
  json["inputs"] = ordered_json::array();
  for (const ShownVocabulary& each : shown) json["inputs"].push_back(JsonOf(each));
  return detail::JsonText(json);
}

Vocabulary ReadVocabularyIdentity(const std::string& path) {
  const VocabularyFile file = ReadVocabularyFile(path);
  if (!file.other.empty()) throw Error(ErrorKind::kUnsupported, path, "", file.other);
  return file.identity;
}

std::string WhyNoVocabularyName(const std::string& name) {
  const std::string_view problem = detail::ProblemOfName(name);
  return problem.empty() ? std::string() : "the name " + std::string(problem);
}

std::string WhyNoChecksum(const std::string& checksum) {
  if (checksum.size() == 32 && checksum.find_first_not_of("0123456789abcdef") == std::string::npos) return {};
  return "expected 32 hexadecimal digits in lower case, found '" + checksum + "'";
}

void StampVocabulary(Atlas& atlas, const StampOptions& options) {
  if (options.vocabulary.empty() && options.name.empty() && options.checksum.empty())
    throw Error(ErrorKind::kUsage,
                "nothing to do: give StampOptions::vocabulary, or StampOptions::name and "
                "StampOptions::checksum");
  if (!options.name.empty()) Require(WhyNoVocabularyName(options.name));
  if (!options.checksum.empty()) Require(WhyNoChecksum(options.checksum));
  Vocabulary wanted = atlas.vocabulary;
  if (!options.vocabulary.empty()) {
    const VocabularyFile file = ReadVocabularyFile(options.vocabulary);
    if (!file.other.empty() && !options.force)
      throw Error(ErrorKind::kUnsupported, options.vocabulary, "",
                  file.other + " (StampOptions::force stamps it all the same)");
    wanted = file.identity;
  }
  if (!options.name.empty()) wanted.name = options.name;
  if (!options.checksum.empty()) wanted.checksum = options.checksum;
  atlas.vocabulary = wanted;
}

}  // namespace slamdb
