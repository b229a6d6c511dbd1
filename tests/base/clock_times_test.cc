// SPDX-License-Identifier: BSD-3-Clause
// Times of day as numbers, through the reader of times.
#include "slamdb/base/detail/clock_times.h"

#include <gmock/gmock.h>

#include <limits>

#include "slamdb/base/detail/date_times.h"
#include "tests/base/seconds_of_tables.h"

namespace slamdb::detail {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ClockTimes, AreToldByTheJumpAtTheMinute) {
  Notices notices;
  EXPECT_THAT(Seconds("time\n190259.25\n190259.75\n190300.25\n190300.75\n", notices),
              ElementsAre("68579.25", "68579.75", "68580.25", "68580.75"));
  EXPECT_THAT(notices.items().at(0).text, AllOf(HasSubstr("hhmmss"), HasSubstr("190259.25"), HasSubstr("midnight")));
  EXPECT_THAT(Seconds("235958\n235959\n000000\n000001\n"), ElementsAre("86398", "86399", "86400", "86401"));
}

TEST(ClockTimes, AreToldByALeadingZero) {
  EXPECT_THAT(Seconds("093015.0\n093015.5\n093016.0\n"), ElementsAre("34215.0", "34215.5", "34216.0"));
}

TEST(ClockTimes, SecondsStaySeconds) {
  Notices notices;
  // Within a minute both have the same steps; beyond, seconds go on to 60 and more.
  for (const char* text : {"time\n190210.5\n190211.0\n190211.5\n", "time\n158.5\n159.5\n160.5\n161.5\n",
                           "time\n0\n1\n2\n", "time [s]\n190259.5\n190300.0\n190300.5\n"}) {
    const std::string first = text;
    EXPECT_THAT(first, HasSubstr("\n" + Seconds(text, notices).at(0) + "\n"));
  }
  EXPECT_THAT(Seconds("190259.25\n190259.75\n190300.25\n", notices, Rules(TimeUnit::kSeconds)),
              ElementsAre("190259.25", "190259.75", "190300.25"));
  EXPECT_THAT(notices.items(), IsEmpty());
}

TEST(ClockTimes, StandBesideADate) {
  for (const char* date : {"20140624", "24062014", "2014-06-24", "2014/06/24"})
    EXPECT_THAT(Seconds(std::string("date,time\n") + date + ",190259.764\n"), ElementsAre("1403636579.764")) << date;
  EXPECT_THAT(Seconds("date,time\n240699,190259\n"), ElementsAre("930250979"));
  EXPECT_THAT(Seconds("date [yymmdd],time\n140624,190259\n"), ElementsAre("1403636579"));
  EXPECT_THAT(Seconds("date [ddmmyy],time\n50624,190259\n"), ElementsAre("1717614179"));  // 05 June 2024
  EXPECT_THAT(Seconds("date,time\n20140624,235959\n20140625,0\n"), ElementsAre("1403654399", "1403654400"));
  EXPECT_THAT(Seconds("date,time\n240614,1403636579.5\n"), ElementsAre("1403636579.5"));
}

TEST(ClockTimes, DatesOfTwoReadingsAreAnError) {
  EXPECT_THAT(Failure("date,time\n240614,190259.764\n"),
              AllOf(HasSubstr("2014-06-24 (ddmmyy)"), HasSubstr("2024-06-14 (yymmdd)"), HasSubstr("date [ddmmyy]")));
  EXPECT_THAT(Failure("date,time\n321399,190259.764\n"), HasSubstr("found '321399'"));
  EXPECT_THAT(Failure("date,time\n20140624,68579.764\n"), HasSubstr("hhmmss or 22:13:20 beside its date"));
}

TEST(DateTimeText, HasTheDigitsOfTheSeconds) {
  EXPECT_EQ(DateTimeText(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(DateTimeText(1403636579.763555), "2014-06-24T19:02:59.763555Z");
  EXPECT_EQ(DateTimeText(951782400), "2000-02-29T00:00:00Z");
  EXPECT_EQ(DateTimeText(-0.25), "1969-12-31T23:59:59.75Z");
  EXPECT_EQ(DateTimeText(253402300799.0), "9999-12-31T23:59:59Z");
  EXPECT_EQ(DateTimeText(-62135596800.0), "0001-01-01T00:00:00Z");
}

TEST(DateTimeText, IsNoneWhereTheYearHasNotFourDigits) {
  for (const double seconds : {253402300800.0, -62135596801.0, 1.4e18, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(DateTimeText(seconds), std::nullopt) << seconds;
}

}  // namespace
}  // namespace slamdb::detail
