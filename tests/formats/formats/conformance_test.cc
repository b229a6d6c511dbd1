// SPDX-License-Identifier: BSD-3-Clause
// fixtures/conformance: files of every format and layout that is read, each with what it means, for this library and
// for others. SLAMDB_UPDATE_GOLDEN=1 writes all of it anew; fixtures/conformance/README.md says more.
#include <gmock/gmock.h>
#include <sha2.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "tests/formats/formats/forged_layout.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using ::testing::IsSupersetOf;

const fs::path kFixtures = SLAMDB_FIXTURES;
const fs::path kFolder = kFixtures / "conformance";

// An example, and where it says what it means. Paths are relative to kFolder.
struct Case {
  std::string kind, id;  // `format` or `layout`, and which
  std::string title;
  std::string file;   // or folder
  std::string atlas;  // of a store
  std::string meaning;
};

std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const Format& format : Formats()) {
    if (format.read == nullptr) continue;
    const std::string id(format.id);
    Case& one = cases.emplace_back(
        Case{"format", id, std::string(format.title), "../formats/" + id, "", "meaning/" + id + ".ndjson"});
    if (format.needs_path) one.file += "/" + id;  // with files beside it
    if (format.named) one.file = id + ".db", one.atlas = "example";
  }
  for (const Layout& layout : KnownLayouts().subspan(1))
    cases.push_back({"layout", layout.id, detail::Concat(layout.title, ", as written by ", layout.who),
                     "layouts/" + layout.id + ".osa", "", "layouts/" + layout.id + ".ndjson"});
  return cases;
}

void WriteText(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

// As ndjson.
std::string MeaningOf(const Case& one) {
  ReadOptions options{.format = one.kind == "format" ? one.id : "orbslam3", .threads = 1};
  if (one.kind == "layout") options = options.With(Orbslam3ReadOptions{.layout = one.id});
  const Atlas atlas = ReadAtlas(Location((kFolder / one.file).string(), one.atlas), options);
  return EncodeAtlas(atlas, {.format = "ndjson"});
}

// tiny.osa, as a program of that layout would have saved it.
std::string Forged(const std::string& id) {
  Atlas atlas = ReadAtlas((kFixtures / "tiny/tiny.osa").string());
  ForgeLayout(*FindKnownLayout(id), atlas);
  return EncodeAtlas(atlas, {.format = "orbslam3"});
}

std::string Sha256(const std::string& bytes) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
  SHA256Data(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), digits.data());
  return digits.data();
}

// Of every file of an example: one with those that stand beside it under its name (`osmap.keyframes`), or all of a
// folder.
ordered_json HashesOf(const fs::path& path) {
  const bool is_folder = fs::is_directory(kFolder / path);
  const fs::path folder = is_folder ? path : path.parent_path();
  const std::string name = path.filename().string();
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(kFolder / folder)) {
    const fs::path file = fs::relative(entry.path(), kFolder / folder);
    const bool is_part = is_folder || file == name || file.string().starts_with(name + ".");
    if (entry.is_regular_file() && is_part) files.push_back(folder / file);
  }
  std::ranges::sort(files);
  ordered_json hashes = ordered_json::object();
  for (const fs::path& file : files) hashes[file.generic_string()] = Sha256(ReadFile((kFolder / file).string()));
  return hashes;
}

ordered_json EntryOf(const Case& one) {
  ordered_json entry = {{one.kind, one.id}, {"title", one.title}, {"file", one.file}};
  if (!one.atlas.empty()) entry["atlas"] = one.atlas;
  entry["meaning"] = one.meaning;
  entry["sha256"] = HashesOf(one.file);
  entry["sha256"].update(HashesOf(one.meaning));
  return entry;
}

std::string Manifest() {
  ordered_json manifest = {{"files", ordered_json::array()}};
  for (const Case& one : Cases()) manifest["files"].push_back(EntryOf(one));
  return manifest.dump(1) + "\n";
}

// A store records when it was written, so that it is made anew only where it cannot be read.
void MakeStore(const Case& one) {
  const fs::path path = kFolder / one.file;
  try {
    static_cast<void>(MeaningOf(one));
  } catch (const Error&) {
    fs::remove(path);
    WriteAtlas(ReadAtlas((kFixtures / "formats/ndjson").string()), Location(path.string(), one.atlas),
               {.format = one.id});
  }
}

void Update(const Case& one) {
  if (one.kind == "layout") WriteText(kFolder / one.file, Forged(one.id));
  if (!one.atlas.empty()) MakeStore(one);
  WriteText(kFolder / one.meaning, MeaningOf(one));
}

void UpdateAll() {
  for (const Case& one : Cases()) {
    try {
      Update(one);
    } catch (const Error& error) {
      ADD_FAILURE() << one.id << ": " << error.what();
    }
  }
  WriteText(kFolder / "manifest.json", Manifest());
}

class ConformanceFiles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (std::getenv("SLAMDB_UPDATE_GOLDEN") != nullptr) UpdateAll();
  }
  static std::string Golden(const std::string& name) {
    const fs::path path = kFolder / name;
    if (!fs::exists(path)) throw std::runtime_error(path.string() + " is missing; SLAMDB_UPDATE_GOLDEN=1 makes it");
    return ReadFile(path.string());
  }
};

class Conformance : public ConformanceFiles, public ::testing::WithParamInterface<Case> {};

TEST_P(Conformance, OfAForkIsWhatItsProgramSaves) {
  if (GetParam().kind != "layout") GTEST_SKIP() << "its own test makes it";
  EXPECT_TRUE(Golden(GetParam().file) == Forged(GetParam().id)) << GetParam().file << " is not what is written today";
}

TEST_P(Conformance, MeansWhatItSays) {
  const std::string meaning = Golden(GetParam().meaning);
  EXPECT_TRUE(MeaningOf(GetParam()) == meaning)
      << "compare " << GetParam().meaning << " with what `slamdb dump` prints of " << GetParam().file;
  EXPECT_TRUE(EncodeAtlas(DecodeAtlas(meaning, {.format = "ndjson"}), {.format = "ndjson"}) == meaning);
}

INSTANTIATE_TEST_SUITE_P(Files, Conformance, ::testing::ValuesIn(Cases()), [](const auto& instance) {
  std::string name = instance.param.kind + "_" + instance.param.id;
  std::ranges::replace_if(
      name, [](char c) { return c == '-' || c == '.'; }, '_');
  return name;
});

TEST_F(ConformanceFiles, AreListedWithTheirHashes) {
  const std::string manifest = Manifest();
  EXPECT_EQ(Golden("manifest.json"), manifest);
  std::vector<std::string> listed = {"README.md", "manifest.json"}, found;
  const ordered_json parsed = ordered_json::parse(manifest);
  for (const ordered_json& entry : parsed["files"])
    for (const auto& [file, hash] : entry["sha256"].items()) listed.push_back(file);
  for (const auto& entry : fs::recursive_directory_iterator(kFolder))
    if (entry.is_regular_file()) found.push_back(fs::relative(entry.path(), kFolder).generic_string());
  EXPECT_THAT(listed, IsSupersetOf(found)) << "files that nothing lists";
}

}  // namespace
}  // namespace slamdb
