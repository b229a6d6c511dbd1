// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/visible.h"

#include <gmock/gmock.h>

#include <string>

namespace slamdb::detail {
namespace {

using std::string_literals::operator""s;

TEST(Visible, EscapesWhatSteersATerminal) {
  EXPECT_EQ(Visible("\x1b[31mHACK\x07"), "\\e[31mHACK\\x07");
  EXPECT_EQ(Visible("a\nslamdb: error: b\r\t"), "a\\nslamdb: error: b\\r\\t");
  EXPECT_EQ(Visible("\0\x08\x7f"s), "\\x00\\x08\\x7f");
  EXPECT_EQ(Visible("\xc2\x9b"
                    "31m"),
            "\\u009b31m");
}

TEST(Visible, EscapesWhatHidesOrTurns) {
  EXPECT_EQ(Visible("lab\xe2\x80\xae"
                    "aso.\xe2\x80\x8b"),
            "lab\\u202easo.\\u200b");
  EXPECT_EQ(Visible("\xef\xbb\xbf\xc2\xad\xe2\x81\xa6\xe2\x80\xa8"), "\\ufeff\\u00ad\\u2066\\u2028");
  EXPECT_EQ(Visible("\xf3\xa0\x81\x81"), "\\U000e0041");
}

TEST(Visible, EscapesWhatIsNoUtf8) {
  EXPECT_EQ(Visible("\x9b"
                    "31m \xff \xc3"),
            "\\x9b31m \\xff \\xc3");
  EXPECT_EQ(Visible("\xc0\x9b \xed\xa0\x80 \xf4\x90\x80\x80 \xe2\x82"),
            "\\xc0\\x9b \\xed\\xa0\\x80 \\xf4\\x90\\x80\\x80 \\xe2\\x82");
}

TEST(Visible, LeavesWhatPeopleRead) {
  const std::string text = "Größe 地图 C:\\maps\\a.osa 🗺 e\xcc\x81";
  EXPECT_EQ(Visible(text), text);
  EXPECT_EQ(VisibleText(text + "\n\tb\x1b"), text + "\n\tb\\e");
}

TEST(ProblemOfName, SaysWhyNot) {
  EXPECT_EQ(ProblemOfName("Labor 2, 地图.txt"), "");
  EXPECT_EQ(ProblemOfName(""), "is empty");
  EXPECT_EQ(ProblemOfName(std::string(255, 'a')), "");
  EXPECT_EQ(ProblemOfName(std::string(256, 'a')), "has more than 255 bytes");
  EXPECT_NE(ProblemOfName("a\nb"), "");
  EXPECT_NE(ProblemOfName("a\xe2\x80\xae"), "");
}

}  // namespace
}  // namespace slamdb::detail
