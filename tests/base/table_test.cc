// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/table.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <clocale>
#include <cmath>
#include <locale>
#include <random>

namespace slamdb::detail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Three numbers and a text that may be missing.
TableKind Kind() {
  return {.columns = {{{"timestamp", "time"}}, {{"x"}}, {{"y"}}, {{"note"}, Column::kOptional}},
          .expected = "3 numbers: timestamp x y"};
}

using Row = std::vector<std::string>;

std::vector<Row> Read(std::string_view text, const TableKind& kind = Kind()) {
  std::vector<Row> rows;
  Table table(text, kind);
  while (table.Next()) {
    rows.emplace_back();
    for (std::size_t column = 0; column < kind.columns.size(); ++column) rows.back().push_back(table.Text(column));
  }
  return rows;
}

Error Failure(std::string_view text, const TableKind& kind = Kind()) {
  try {
    Table table(text, kind);
    while (table.Next())
      for (std::size_t column = 0; column < 3; ++column) table.Get<double>(column);
  } catch (const Error& error) {
    return error;
  }
  return Error(ErrorKind::kInternal, "no error");
}

TEST(Table, ReadsEveryDialect) {
  const std::vector<Row> expected = {{"1.5", "2", "3", ""}, {"2.5", "-4", "+5", ""}};
  for (const char* text : {
           "1.5 2 3\n2.5 -4 +5\n",
           "1.5  2\t3\r\n 2.5\t\t-4 +5",
           "1.5\t2\t3\n2.5\t-4\t+5\n",
           "1.5,2,3\n2.5,-4,+5\n",
           "1.5; 2; 3\n2.5 ;-4 ;+5\n",
           "\xef\xbb\xbf"
           "1.5,2,3\r\n2.5,-4,+5\r\n",
           "\"1.5\",\"2\",\"3\"\n\"2.5\", \"-4\" ,\"+5\"",
           "# a comment of four words\n\n1.5 2 3\n% another\n2.5 -4 +5\n\n",
           "timestamp,x,y\n1.5,2,3\n2.5,-4,+5\n",
           "Time;Y [m];X (m)\n1.5;3;2\n2.5;+5;-4\n",
           "#time x_m y_m\n1.5 2 3\n2.5 -4 +5\n",
           "%time,id,x,y\n1.5,0,2,3\n2.5,1,-4,+5\n",
           "# the path of a robot\n# timestamp y x\n1.5 3 2\n2.5 +5 -4\n",
           "# time [s] x [m] y [m]\n1.5 2 3\n2.5 -4 +5\n",
           "timestamp x y\n1.5,2,3\n2.5,-4,+5\n",
           "timestamp,x,y\n1.5 2 3\n2.5 -4 +5\n",
           "# timestamp,x,y\n1.5;2;3\n2.5;-4;+5\n",
           "timestamp,x,y\n1.5,2,3,\n2.5,-4,+5,\n,,,\n",
       })
    EXPECT_EQ(Read(text), expected) << text;
}

TEST(Table, IsEmptyWithoutRows) {
  for (const char* text : {"", "\n\r\n", "# nothing\n", "timestamp,x,y\n", "# timestamp x y"})
    EXPECT_TRUE(Read(text).empty()) << text;
}

TEST(Table, KeepsEmptyCells) {
  EXPECT_EQ(Read("time,note,x,y\n1,,2,3\n"), (std::vector<Row>{{"1", "2", "3", ""}}));
  EXPECT_EQ(Read("time\tnote\tx\ty\n1\t\t2\t3\n"), (std::vector<Row>{{"1", "2", "3", ""}}));
}

TEST(Table, ReadsWhatIsQuoted) {
  EXPECT_EQ(Read("note,time,x,y\n\"a, \"\"b\"\"\nc\",1,2,3\n"), (std::vector<Row>{{"1", "2", "3", "a, \"b\"\nc"}}));
  EXPECT_EQ(Read("note time x y\n\"a b\" 1 2 3\n"), (std::vector<Row>{{"1", "2", "3", "a b"}}));
  // Inches, and a quote that nothing closes.
  EXPECT_EQ(Read("note,time,x,y\n\"5\" pipe,1,2,3\n\"open,4,5,6\n"),
            (std::vector<Row>{{"1", "2", "3", "\"5\" pipe"}, {"4", "5", "6", "\"open"}}));
}

TEST(Table, CountsLinesOfRowsThatSpanSeveral) {
  Table table("note,time,x,y\n\"a\nb\",1,2,3\n\n# c\n,4,5,6\n", Kind());
  ASSERT_TRUE(table.Next());
  EXPECT_EQ(table.line(), 2U);
  EXPECT_EQ(table.row(), "\"a\nb\",1,2,3");
  ASSERT_TRUE(table.Next());
  EXPECT_EQ(table.line(), 6U);
}

TEST(Table, HandsOverCommentsWhereTheyStand) {
  Table table("# map 1\ntimestamp x y\n# map 2\n1 2 3\n4 5 6\n# map 3\n#\n", Kind());
  ASSERT_TRUE(table.Next());
  EXPECT_THAT(table.comments(), ElementsAre("# map 1", "# map 2"));
  ASSERT_TRUE(table.Next());
  EXPECT_TRUE(table.comments().empty());
  EXPECT_FALSE(table.Next());
  EXPECT_THAT(table.comments(), ElementsAre("# map 3", "#"));
}

TEST(Table, TellsNamesAndUnits) {
  Table table("timestamp_ns, X [ft] ,y\n1,2,3\n", Kind());
  EXPECT_EQ(table.NameOf(0)->name, "timestamp");
  EXPECT_EQ(table.NameOf(0)->unit, "ns");
  EXPECT_EQ(table.NameOf(1)->text, "x [ft]");
  EXPECT_EQ(table.NameOf(1)->unit, "ft");
  EXPECT_EQ(table.NameOf(2)->unit, "");
  EXPECT_FALSE(table.Has(3));
  EXPECT_EQ(table.names().size(), 3U);
  EXPECT_EQ(Table("1 2 3", Kind()).NameOf(0), nullptr);
}

TEST(ColumnName, SplitsOffTheUnit) {
  const auto parts = [](std::string_view text) {
    const ColumnName name(text);
    return name.name + "|" + name.unit;
  };
  EXPECT_EQ(parts("Latitude [rad]"), "latitude|rad");
  EXPECT_EQ(parts("altitude_ft"), "altitude|ft");
  EXPECT_EQ(parts("alt(m)"), "alt|m");
  EXPECT_EQ(parts("q_RS_w []"), "q_rs_w|");
  EXPECT_EQ(parts("v_RS_R_x [m s^-1]"), "v_rs_r_x|m s^-1");
  EXPECT_EQ(parts("first_x"), "first_x|");
  EXPECT_EQ(parts("lat_std"), "lat_std|");
  EXPECT_EQ(parts("m"), "m|");
  EXPECT_EQ(parts("_s"), "_s|");
  EXPECT_EQ(parts("[m]"), "[m]|");
}

TEST(Table, ExactNamesWinOverBeginnings) {
  TableKind kind = Kind();
  EXPECT_EQ(Failure("x_std,x_wgs84,time,y\n9,2,1,3\n", kind).place(), "line 1");
  kind.name_beginnings = true;
  EXPECT_EQ(Read("x_std,time_since_start,x,time,y\n9,9,2,1,3\n", kind), (std::vector<Row>{{"1", "2", "3", ""}}));
  EXPECT_EQ(Read("x_wgs84,time,y\n2,1,3\n", kind), (std::vector<Row>{{"1", "2", "3", ""}}));
  EXPECT_EQ(Read("time,timestamp,x,y\n9,1,2,3\n", kind), (std::vector<Row>{{"1", "2", "3", ""}}));
  for (const char* other : {"xx", "x_std", "x_ref", "x_since_start"})
    EXPECT_EQ(Failure(std::string(other) + ",time,y\n2,1,3\n", kind).place(), "line 1") << other;
}

TEST(Table, TakesOneWholeGroup) {
  const TableKind kind = {.columns = {{{"a"}, 0}, {{"b"}, 0}, {{"c"}, 1}, {{"d"}, 1}, {{"e"}, 1}}, .expected = "pairs"};
  EXPECT_EQ(Read("c,b,a\n3,2,1\n", kind), (std::vector<Row>{{"1", "2", "", "", ""}}));
  EXPECT_EQ(Read("e,d,c,b,a\n5,4,3,2,1\n", kind), (std::vector<Row>{{"1", "2", "3", "4", "5"}}));
  EXPECT_EQ(Read("1,2\n", kind), (std::vector<Row>{{"1", "2", "", "", ""}}));
  EXPECT_EQ(Read("1,2,3\n", kind), (std::vector<Row>{{"", "", "1", "2", "3"}}));
  EXPECT_EQ(Failure("a,c,d\n1,2,3\n", kind).problem(), "expected pairs, found `a,c,d`, in which no column is named b");
}

TEST(Table, CommentsOfOtherWordsNameNothing) {
  // The names stand in prose, where no cells are.
  EXPECT_EQ(Read("# columns: timestamp x y\n1 2 3\n"), (std::vector<Row>{{"1", "2", "3", ""}}));
  EXPECT_EQ(Read("# x is x, y is y, time is time\n1 2 3\n"), (std::vector<Row>{{"1", "2", "3", ""}}));
}

TEST(Table, NamesLineAndColumnOfWhatIsWrong) {
  EXPECT_STREQ(Failure("1 2 3\n# c\n\n4 5\n").what(), "line 4: expected 3 numbers: timestamp x y, found `4 5`");
  EXPECT_STREQ(Failure("1 2 3 4\n").what(), "line 1: expected 3 numbers: timestamp x y, found `1 2 3 4`");
  EXPECT_STREQ(Failure("when,where\n").what(), "line 1: expected 3 numbers: timestamp x y, found `when,where`");
  EXPECT_STREQ(Failure("1 2 x3\n").what(), "line 1: expected a number, found 'x3' in column y");
  EXPECT_STREQ(Failure("time,y,x\n1,2,\n").what(), "line 2: expected a number, found '' in column x");
  EXPECT_STREQ(Failure("time,y,x\n1,2\n").what(), "line 2: expected 3 cells, found 2");
  EXPECT_STREQ(Failure("time,y,x\n1,2,3,4\n").what(), "line 2: expected 3 cells, found 4");
  EXPECT_STREQ(Failure("# c\nx,y,time,x\n1,2,3,4\n").what(), "line 2: columns 1 and 4 are both named x");
  EXPECT_EQ(Failure("1 2\n").kind(), ErrorKind::kDamaged);
  EXPECT_EQ(Failure("\xff\xfe"
                    "1")
                .kind(),
            ErrorKind::kUnsupported);
  TableKind named = Kind();
  named.by_position = false;
  EXPECT_EQ(Failure("1 2 3\n", named).place(), "line 1");
}

TEST(Table, MoreCellsOnlyWhereTheyAreExpected) {
  TableKind kind = Kind();
  kind.more_cells = true;
  EXPECT_EQ(Read("1 2 3 ok\n4 5 6\n", kind), (std::vector<Row>{{"1", "2", "3", ""}, {"4", "5", "6", ""}}));
  EXPECT_EQ(Read("time,x,y\n1,2,3,4\n", kind), (std::vector<Row>{{"1", "2", "3", ""}}));
}

TEST(GlanceAtTable, TellsWhatTheFirstLinesAre) {
  EXPECT_TRUE(GlanceAtTable("# hello\ntimestamp,y,x\n", Kind()).named);
  EXPECT_TRUE(GlanceAtTable("#timestamp, y, x\n1, 2", Kind()).named == false);  // the row is cut off before its end
  const TableGlance numbers = GlanceAtTable("\xef\xbb\xbf# hello\n1 2 3 4\n5", Kind());
  EXPECT_FALSE(numbers.named);
  EXPECT_EQ(numbers.numbers, 4U);
  EXPECT_EQ(numbers.separator, ' ');
  EXPECT_EQ(GlanceAtTable("1,2\n", Kind()).separator, ',');
  EXPECT_EQ(GlanceAtTable("1,b\n", Kind()).numbers, 0U);
  EXPECT_EQ(GlanceAtTable("\xff\xfe"
                          "1",
                          Kind())
                .numbers,
            0U);
  EXPECT_EQ(GlanceAtTable("", Kind()).numbers, 0U);
}

// A writer of every dialect, to be read back.
class Dialect {
 public:
  explicit Dialect(std::mt19937_64& random) : random_(random) {}

  std::string Write(const std::vector<std::array<double, 2>>& numbers, const std::vector<std::int64_t>& times) {
    std::string text = Chance() ? "\xef\xbb\xbf" : "";
    if (Chance()) text += "# words of someone who made this" + end_;
    if (names_) text += Names() + end_;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (Chance()) text += Chance() ? end_ : "% 1, 2, 3" + end_;
      std::string time, x, y;
      AppendNumber(time, times[i]);
      AppendNumber(x, numbers[i][0]);
      AppendNumber(y, numbers[i][1]);
      text += Join({Dressed(time), Dressed(x), Dressed(y), Note()}) + (i + 1 < times.size() || Chance() ? end_ : "");
    }
    return text;
  }

 private:
  bool Chance() { return random_() % 2 == 0; }

  std::string Dressed(std::string number) {
    if (number[0] != '-' && Chance()) number = "+" + number;
    return Chance() ? '"' + number + '"' : number;
  }

  std::string Note() { return separator_.find_first_of(",;\t") == std::string::npos ? "\"a b\"" : "\"a,;\t\"\"b\""; }

  std::string Names() {
    const std::string time = Chance() ? "timestamp" : "Time [s]", x = Chance() ? "X" : "x_m",
                      y = Chance() ? "y" : "Y(m)";
    return (Chance() ? "#" : "") + Join({time, x, y, "note"});
  }

  std::string Join(const std::vector<std::string>& cells) {
    std::string line;
    for (const std::size_t place : order_) line += (line.empty() ? "" : separator_) + cells[place];
    return line;
  }

  std::mt19937_64& random_;
  const std::string end_ = Chance() ? "\n" : "\r\n";
  const std::string separator_ = std::array{",", ";", "\t", " ", "  ", ", ", " ; ", " \t "}[random_() % 8];
  const bool names_ = Chance();
  const std::vector<std::size_t> order_ = [this] {
    std::vector<std::size_t> order = {0, 1, 2, 3};
    if (names_) std::shuffle(order.begin(), order.end(), random_);
    if (!names_) order.pop_back();
    return order;
  }();
};

void ReadBackEveryDialect() {
  std::mt19937_64 random(11);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::array<double, 2>> numbers(1 + random() % 5);
    std::vector<std::int64_t> times(numbers.size());
    for (std::int64_t& time : times) time = static_cast<std::int64_t>(random());
    for (auto& pair : numbers)
      for (double& number : pair) do
          number = std::bit_cast<double>(random());
        while (!std::isfinite(number));
    const std::string text = Dialect(random).Write(numbers, times);
    Table table(text, Kind());
    for (std::size_t i = 0; i < times.size(); ++i) {
      ASSERT_TRUE(table.Next()) << text;
      ASSERT_EQ(table.Get<std::int64_t>(0), times[i]) << text;
      ASSERT_EQ(table.Get<double>(1), numbers[i][0]) << text;
      ASSERT_EQ(table.Get<double>(2), numbers[i][1]) << text;
      ASSERT_THAT(table.Text(3), ::testing::AnyOf("", "a b", "a,;\t\"b")) << text;
      ASSERT_EQ(table.Text(3).empty(), !table.Has(3)) << text;
    }
    ASSERT_FALSE(table.Next()) << text;
  }
}

TEST(Table, ReadsBackWhatAnyDialectWrites) { ReadBackEveryDialect(); }

TEST(Table, ReadsBackInALocaleOfCommas) {
  struct Commas : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Commas));
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "pt_BR.UTF-8"})
    if (std::setlocale(LC_ALL, name) != nullptr) break;  // where one is installed
  ReadBackEveryDialect();
  std::locale::global(before);
  std::setlocale(LC_ALL, "C");
}

}  // namespace
}  // namespace slamdb::detail
