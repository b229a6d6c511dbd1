// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/report.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <memory>
#include <stdexcept>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/many/check.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class OfManyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 50, .features = 80});
    WriteAtlas(atlas, folder_ / "map.osa");
    folder_.Make("broken.osa", "no archive");
    named_ = {folder_.path().string()};
    found_ = FindAtlases(named_);
    found_.atlases.push_back({.location = Location("mine"), .atlas = std::make_shared<const Atlas>(atlas)});
    named_.push_back("mine");
  }
  std::string Pages() const { return folder_ / "pages"; }

  TemporaryFolder folder_;
  std::vector<std::string> named_;
  AtlasInputs found_;
};

TEST_F(OfManyTest, WhatIsInMemoryIsCheckedAsWhatIsRead) {
  const auto outcomes = CheckAtlases(found_, {});
  ASSERT_THAT(outcomes, SizeIs(3));
  EXPECT_THAT(outcomes[0].error, HasSubstr("broken.osa"));
  EXPECT_EQ(outcomes[1].error, "");
  EXPECT_EQ(outcomes[2].path, "mine");
  EXPECT_EQ(ToJson(std::vector<CheckedFile>{{.report = outcomes[1].result}}),
            ToJson(std::vector<CheckedFile>{{.report = outcomes[2].result}}));
}

TEST_F(OfManyTest, OptionsThatFitNoAtlasAreAnErrorAndNotOneOfTheAtlas) {
  const CheckOptions wrong{.ignore = {"no-such-rule"}};
  EXPECT_EQ(ErrorOf([&] { (void)CheckAtlases(found_, {.check = wrong}); }).kind(), ErrorKind::kUsage);
  EXPECT_EQ(ErrorOf([&] { (void)WriteReports(named_, found_, {.check = wrong, .output = Pages()}); }).kind(),
            ErrorKind::kUsage);
  EXPECT_FALSE(std::filesystem::exists(Pages()));
  EXPECT_EQ(ErrorOf([&] { (void)CheckAtlases({}, {}); }).kind(), ErrorKind::kNotFound);
}

TEST_F(OfManyTest, ProgressTellsHowManyAreDoneAndEndsTheWork) {
  std::vector<std::string> stages;
  ReadOptions read{.threads = 1};
  read.progress = [&](std::string_view stage, double) { stages.emplace_back(stage); };
  (void)CheckAtlases(found_, {.read = read});
  ASSERT_THAT(stages, ::testing::Not(IsEmpty()));
  EXPECT_EQ(stages.back(), "3 of 3");
  read.progress = [](std::string_view, double) { throw std::runtime_error("enough"); };
  EXPECT_THROW((void)CheckAtlases(found_, {.read = read}), std::runtime_error);
}

TEST_F(OfManyTest, PagesAppearTogetherWithTheirIndex) {
  EXPECT_THAT(WhyNotReportTo(folder_ / "all.html", /*one_atlas=*/false), HasSubstr("need a folder"));
  const Reports reports = WriteReports(named_, found_, {.output = Pages()});
  EXPECT_EQ(reports.written, Pages() + "/index.html");
  EXPECT_FALSE(reports.ok());
  EXPECT_EQ(reports.outcomes[0].result.checked.failure, reports.outcomes[0].error);
  EXPECT_THAT(reports.page, HasSubstr("broken.osa"));
  for (const char* page : {"map.html", "mine.html", "index.html"})
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(Pages()) / page)) << page;
  EXPECT_EQ(ErrorOf([&] { (void)WriteReports(named_, found_, {.output = Pages()}); }).kind(),
            ErrorKind::kAlreadyExists);
}

TEST_F(OfManyTest, OneAtlasHasAPageAlone) {
  const std::vector<std::string> named{folder_ / "map.osa"};
  const AtlasInputs found = FindAtlases(named);
  EXPECT_TRUE(IsOneAtlas(named, found));
  EXPECT_FALSE(IsOneAtlas(named_, found_));
  const Reports unwritten = WriteReports(named, found, {});
  EXPECT_EQ(unwritten.written, "");
  EXPECT_TRUE(unwritten.ok());
  const Reports reports = WriteReports(named, found, {.output = folder_ / "map.html"});
  EXPECT_EQ(reports.page, unwritten.page);
  EXPECT_THAT(reports.page, HasSubstr("map.osa"));
  EXPECT_EQ(std::filesystem::file_size(folder_ / "map.html"), reports.page.size());
}

}  // namespace
}  // namespace slamdb
