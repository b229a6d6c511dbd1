// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/times.h"

#include <gmock/gmock.h>

#include "slamdb/base/detail/time_units.h"
#include "tests/base/seconds_of_tables.h"

namespace slamdb::detail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ShiftedDecimal, MovesThePointAndLosesNoDigit) {
  EXPECT_EQ(ShiftedDecimal("1403636579763555584", -9), "1403636579.763555584");
  EXPECT_EQ(ShiftedDecimal("1700000000000000000.0000000000", -9), "1700000000");
  EXPECT_EQ(ShiftedDecimal("5", -9), "0.000000005");
  EXPECT_EQ(ShiftedDecimal("-12.5", -3), "-0.0125");
  EXPECT_EQ(ShiftedDecimal("1.25", 3), "1250");
  EXPECT_EQ(ShiftedDecimal("0.1234567891", 9), "123456789.1");
  EXPECT_EQ(ShiftedDecimal("1.50", 0), "1.50");
  EXPECT_EQ(ShiftedDecimal("1.5e9", 0), "1500000000");
  EXPECT_EQ(ShiftedDecimal("0", -9), "0");
  EXPECT_EQ(ShiftedDecimal("nan", 0), std::nullopt);
  EXPECT_EQ(ShiftedDecimal("1e999999999", 0), std::nullopt);
  EXPECT_EQ(ShiftedDecimal(std::string(1000, '1'), 0), std::nullopt);
  EXPECT_EQ(ShiftedDecimal("x", 3), std::nullopt);
}

TEST(Times, UnitsOfNamesAreHonoured) {
  for (const char* text :
       {"timestamp [ns]\n1250000000\n1500000000\n1750000000\n", "timestamp_us\n1250000\n1500000\n1750000\n",
        "t(ms)\n1250\n1500\n1750\n", "time [s]\n1.25\n1.5\n1.75\n",
        "#timestamp [\xc2\xb5s]\n1250000\n1500000\n1750000\n", "Timestamp-ns\n1250000000\n1500000000\n1750000000\n",
        "nanoseconds\n1250000000\n1500000000\n1750000000\n"}) {
    Notices notices;
    EXPECT_THAT(Seconds(text, notices), ElementsAre("1.25", "1.5", "1.75")) << text;
    EXPECT_THAT(notices.items(), IsEmpty()) << text;
  }
  EXPECT_THAT(Failure("timestamp [ticks]\n1\n2\n"), HasSubstr("found the unit 'ticks'"));
  EXPECT_THAT(Failure("timestamp_min\n1\n2\n"), HasSubstr("found the unit 'min'"));
}

// Of this century, whatever they count; the choice is told.
TEST(Times, UnitsAreToldByMagnitude) {
  for (const char* text :
       {"1700000000000\n1700000000250\n1700000000500\n", "1700000000000000\n1700000000250000\n1700000000500000\n",
        "1700000000000000000\n1700000000250000000\n1700000000500000000\n"}) {
    Notices notices;
    EXPECT_THAT(Seconds(text, notices), ElementsAre("1700000000", "1700000000.25", "1700000000.5")) << text;
    ASSERT_EQ(notices.items().size(), 1U);
    EXPECT_THAT(notices.items()[0].text, HasSubstr("times are taken as "));
  }
  Notices notices;
  EXPECT_THAT(Seconds("1700000000\n1700000000.25\n1700000000.5\n", notices),
              ElementsAre("1700000000", "1700000000.25", "1700000000.5"));
  EXPECT_THAT(notices.items(), IsEmpty());
}

// From the start of a recording: by the steps between them.
TEST(Times, UnitsAreToldBySteps) {
  EXPECT_THAT(Seconds("0\n0.25\n0.5\n"), ElementsAre("0", "0.25", "0.5"));
  EXPECT_THAT(Seconds("0\n250\n500\n"), ElementsAre("0", "0.25", "0.5"));
  EXPECT_THAT(Seconds("0\n250000\n500000\n"), ElementsAre("0", "0.25", "0.5"));
  EXPECT_THAT(Seconds("0\n250000000\n500000000\n"), ElementsAre("0", "0.25", "0.5"));
  EXPECT_THAT(Seconds("0\n1\n2\n"), ElementsAre("0", "1", "2"));
  // Nanoseconds whose numbers could be seconds of this century, were it not for the steps.
  EXPECT_THAT(Seconds("1000000000\n1250000000\n1500000000\n"), ElementsAre("1", "1.25", "1.5"));
  Notices notices;
  EXPECT_THAT(Seconds("0.0\n5.0\n10.0\n", notices), ElementsAre("0.0", "5.0", "10.0"));
  EXPECT_THAT(notices.items().at(0).text, HasSubstr("as they have decimals"));
  // Decimals make no seconds of steps that are none.
  EXPECT_THAT(Seconds("1000.0\n1033.3\n1066.6\n", notices), ElementsAre("1", "1.0333", "1.0666"));
  EXPECT_THAT(notices.items().at(1).text, HasSubstr("times are taken as milliseconds"));
  EXPECT_THAT(Seconds("0.000\n33.333\n66.667\n"), ElementsAre("0", "0.033333", "0.066667"));
  EXPECT_THAT(Seconds("0.5\n33333.8\n66667.1\n"), ElementsAre("0.0000005", "0.0333338", "0.0666671"));
}

TEST(Times, WhatCannotBeToldIsAnErrorWithBothReadings) {
  const std::string error = Failure("0\n5\n10\n");
  EXPECT_THAT(error, HasSubstr("may be seconds or milliseconds"));
  EXPECT_THAT(error, HasSubstr("steps are 5 s"));
  EXPECT_THAT(error, HasSubstr("steps are 0.005 s"));
  EXPECT_THAT(error, HasSubstr("the time unit"));
  EXPECT_THAT(Seconds("0\n5\n10\n", Rules(TimeUnit::kMilliseconds)), ElementsAre("0", "0.005", "0.01"));
  EXPECT_THAT(Failure("time [ns]\n1700000000.0\n1700000000.05\n1700000000.1\n"), HasSubstr("says ns"));
}

TEST(Times, SecondsAndNanosecondsInTwoColumns) {
  EXPECT_THAT(Seconds("header.stamp.sec,header.stamp.nanosec\n1700000000,250000000\n1700000001,5\n"),
              ElementsAre("1700000000.25", "1700000001.000000005"));
  for (const char* names :
       {"sec,nsec", "secs,nsecs", "seconds,nanoseconds", "stamp_sec,stamp_nanosec", "timestamp,nsec",
        "timestamp,nanoseconds", "timestamp_sec,timestamp_nsec", "time_s,time_ns", "time [s],time [ns]", "t,t_nanos",
        "/pose/header/stamp/sec,/pose/header/stamp/nanosec", "__time,nsec"})
    EXPECT_THAT(Seconds(std::string(names) + "\n1700000000,250000000\n1700000000.0,5\n1700000000,7e8\n"),
                ElementsAre("1700000000.25", "1700000000.000000005", "1700000000.7"))
        << names;
  for (const char* names : {"sec,usec", "time_s,time_us", "timestamp,microseconds", "utc,usec"})
    EXPECT_THAT(Seconds(std::string(names) + "\n1700000000,250000\n"), ElementsAre("1700000000.25")) << names;
  EXPECT_THAT(Seconds("sec,ms\n0,0\n0,500\n1,0\n"), ElementsAre("0", "0.5", "1"));
  EXPECT_THAT(Seconds("time,nsec\n2023-11-14T22:13:20Z,5000000\n"), ElementsAre("1700000000.005"));
  EXPECT_THAT(Seconds("timestamp,exposure_ns\n1700000000,7\n"), ElementsAre("1700000000"));
  EXPECT_THAT(Seconds("Time,header.stamp.secs,header.stamp.nsecs\n9,1700000000,1\n"),
              ElementsAre("1700000000.000000001"));
  EXPECT_THAT(Failure("header.stamp.sec,header.stamp.nanosec\n1700000000,1000000000\n"), HasSubstr("line 2"));
  EXPECT_THAT(Failure("header.stamp.sec,header.stamp.nanosec\n1700000000.5,1\n"), HasSubstr("whole seconds"));
  const std::string error = Failure("sec,usec\n1700000000,5\n1700000001,1000000\n");
  EXPECT_THAT(error, HasSubstr("line 3: the columns sec and usec are neither"));
  EXPECT_THAT(error, HasSubstr("found 1700000001 and 1000000"));
  EXPECT_THAT(Failure("timestamp,nsec\n1700000000.25,250000000\n"), HasSubstr("timestamp and nsec"));
  EXPECT_THAT(Failure("timestamp,nsec\n1700000000,\n"), HasSubstr("timestamp and nsec"));
  EXPECT_THAT(Failure("sec,nsec\n1700000000,-1\n"), HasSubstr("sec and nsec"));
}

TEST(Times, TheSameTimeInAFinerUnitIsTaken) {
  Notices notices;
  EXPECT_THAT(Seconds("time_s,time_ns\n1700000000,1700000000250000000\n1700000000,1700000000500000000\n", notices),
              ElementsAre("1700000000.25", "1700000000.5"));
  EXPECT_THAT(notices.items().at(0).text, HasSubstr("those of the column time_ns"));
}

TEST(Times, EqualTimesInMostRowsAreNamed) {
  Notices notices;
  EXPECT_THAT(Seconds("time,frac\n1700000000,1\n1700000000,2\n1700000000,3\n1700000001,0\n", notices),
              ElementsAre("1700000000", "1700000000", "1700000000", "1700000001"));
  EXPECT_THAT(notices.items().at(0).text, HasSubstr("most rows have the time of the row before: 2 of 4"));
}

// What the name says is beyond this century, and another unit is within.
TEST(Times, UnitsOfNamesAreHeldAgainstTheMagnitude) {
  const std::string error = Failure("timestamp_us\n1700000000000000000\n1700000000250000000\n1700000000500000000\n");
  EXPECT_THAT(error, HasSubstr("may be microseconds or nanoseconds (the name of their column says us)"));
  EXPECT_THAT(Failure("time [s]\n1700000000000\n"), HasSubstr("says s"));
}

TEST(Times, StampsWinOverReceipts) {
  Notices notices;
  EXPECT_THAT(Seconds("%time,field.header.stamp\n1700000009000000000,1700000000000000000\n", notices),
              ElementsAre("1700000000"));
  EXPECT_THAT(notices.items().at(0).text, HasSubstr("field.header.stamp, not of the column time"));
}

TEST(Times, DatesAreRead) {
  Notices notices;
  EXPECT_THAT(
      Seconds("time,x\n2023-11-14T22:13:20.25Z,\n2023-11-15T00:13:21+02:00,\n2023-11-14 22:13:22 UTC,\n", notices),
      ElementsAre("1700000000.25", "1700000001", "1700000002"));
  EXPECT_THAT(notices.items(), IsEmpty());
  EXPECT_THAT(Seconds("date,time\n2023/11/14,22:13:20\n", notices), ElementsAre("1700000000"));
  EXPECT_THAT(notices.items().at(0).text, HasSubstr("UTC"));
  EXPECT_THAT(Failure("time\n22:13:20\n"), HasSubstr("tells no day"));
  EXPECT_THAT(Failure("time\n2023-02-30T22:13:20Z\n"), HasSubstr("date and time"));
  EXPECT_THAT(Failure("time\n2023-11-14T22:13:20Z\n5\n"), HasSubstr("as in the rows above"));
}

TEST(Times, WhatIsNoTimeIsNamed) {
  for (const char* text : {"nan\n", "inf\n", "x\n", "1e400\n", "''\n"})
    EXPECT_THAT(Failure(std::string("time\n") + text), HasSubstr("line 2")) << text;
}

}  // namespace
}  // namespace slamdb::detail
