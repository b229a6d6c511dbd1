// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/markup.h"

#include <gtest/gtest.h>

namespace slamdb::detail {
namespace {

TEST(Markup, IsEscapedInTextsAndAttributes) {
  EXPECT_EQ(EscapedMarkup("a<b>&\"'c"), "a&lt;b&gt;&amp;&quot;&#39;c");
  EXPECT_EQ(EscapedMarkup("\x1b\n\xff"), "\\e\\n\\xff");
}

TEST(Markup, EncodesAsRfc4648Does) {
  const auto encoded = [](std::string_view text) { return Base64(std::as_bytes(std::span(text))); };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe"), "//4=");
  EXPECT_EQ(encoded("\xfb\xef\xbe\xff"), "++++/w==");
}

TEST(Markup, NamesAnInlineTextByItsSha256) {
  EXPECT_EQ(PolicySource(""), "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='");
}

}  // namespace
}  // namespace slamdb::detail
