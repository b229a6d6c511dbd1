// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "slamdb/formats/layouts/from_source.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

// Any bytes as the sources of a fork: a layout comes of them, with questions. Where that is a whole one, its text is
// read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const SourceText source{"fork.h", std::string(reinterpret_cast<const char*>(data), size)};
  const DerivedLayout derived = DeriveLayout(std::span(&source, 1));
  for (const LayoutClass& of : derived.layout.classes)
    for (const LayoutMember& member : of.members)
      if (member.type != "?") (void)ParseLayoutType(member.type);  // what it knows, a layout can say
  fuzz::MayRefuse([&] {
    const Layout parsed = ParseLayout(LayoutText(derived.layout));
    fuzz::Require(SameBytes(ParseLayout(LayoutText(parsed)), parsed), "a layout survives its text");
  });
  return 0;
}
