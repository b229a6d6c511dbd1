// SPDX-License-Identifier: BSD-3-Clause
// Text that was cut inside of its last line: a shorter number is a number, too, and only the line's end is missing.
#include <gmock/gmock.h>

#include <cctype>
#include <filesystem>

#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWarning = "the last line has no end of line: the file may be cut there";

bool Warns(const Notices& notices, const std::string& path) {
  return std::ranges::any_of(notices.items(), [&](const Notice& notice) {
    return notice.kind == Notice::Kind::kWarning && notice.text == path + ": " + kWarning;
  });
}

bool ReadingWarns(const std::string& input, const std::string& cut) {
  Notices notices;
  static_cast<void>(ReadAtlas(input, {}, &notices));
  return Warns(notices, cut);
}

Atlas SomeAtlas() { return SynthesizeAtlas({.keyframes = 8, .points = 120, .features = 100}); }

// Takes one digit off the end of the last line that ends with two, and what stands behind.
std::string CutInANumber(std::string text) {
  const auto is_digit = [](char letter) { return std::isdigit(static_cast<unsigned char>(letter)) != 0; };
  while (text.size() > 2 &&
         !(text.back() == '\n' && is_digit(text[text.size() - 2]) && is_digit(text[text.size() - 3])))
    text.pop_back();
  return text.substr(0, text.size() - 2);
}

struct Case {
  std::string format, output, cut;  // `cut`: the file in it, or beside it, that is cut; empty: it itself
};

TEST(OpenEnd, IsSaidByEveryReaderOfLines) {
  const Atlas atlas = SomeAtlas();
  for (const Case& each :
       {Case{"tum", "a.tum", ""}, Case{"kitti", "a.kitti", ""}, Case{"kitti", "b.kitti", "b.kitti.times"},
        Case{"euroc", "a.euroc.csv", ""}, Case{"g2o", "a.g2o", ""}, Case{"xyz", "a.xyz", ""}, Case{"ply", "a.ply", ""},
        Case{"pcd", "a.pcd", ""}, Case{"colmap-text", "model", "model/points3D.txt"}}) {
    SCOPED_TRACE(each.output + " " + each.cut);
    const TemporaryFolder folder;
    const std::string output = folder.Path(each.output), cut = each.cut.empty() ? output : folder.Path(each.cut);
    WriteAtlas(atlas, output, WriteOptions{.format = each.format}.With(PointCloudOptions{.binary = false}));
    EXPECT_FALSE(ReadingWarns(output, cut));
    const std::string whole = ReadFile(cut), shorter = CutInANumber(whole);
    ASSERT_LT(shorter.size(), whole.size());
    fs::remove(cut);
    folder.Make(fs::path(cut).lexically_relative(folder.Path("")).string(), shorter);
    EXPECT_TRUE(ReadingWarns(output, cut)) << "a shorter number";
    fs::remove(cut);
    folder.Make(fs::path(cut).lexically_relative(folder.Path("")).string(), whole.substr(0, whole.size() - 1));
    EXPECT_TRUE(ReadingWarns(output, cut)) << "a last line that is whole but for its end";
  }
}

}  // namespace
}  // namespace slamdb
