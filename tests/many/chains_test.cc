// SPDX-License-Identifier: BSD-3-Clause
// How the revisions of one atlas in two stores lie to each other.
#include "slamdb/many/detail/chains.h"

#include <gtest/gtest.h>

namespace slamdb::detail {
namespace {

using State = Compared::State;
using Links = std::vector<RevisionChain::Link>;

// {number, hash, from}: of the first and the second store, what they are to each other, and from where links miss.
struct Lines {
  const char* what;
  Links first, second;
  State state;
  std::size_t missing = 0;
};

const std::vector<Lines>& AllLines() {
  static const std::vector<Lines> lines = {
      {"neither is there", {}, {}, State::kSame},
      {"one is not there", {{1, 10}}, {}, State::kSecondBehind, 0},
      {"the same", {{1, 10}, {2, 20}}, {{1, 10}, {2, 20}}, State::kSame},
      {"one went on", {{1, 10}, {2, 20}, {3, 30}}, {{1, 10}}, State::kSecondBehind, 1},
      {"both went on", {{1, 10}, {2, 20}}, {{1, 10}, {2, 21}, {3, 31}}, State::kDiverged, 1},
      {"nothing in common", {{1, 10}}, {{1, 11}}, State::kDiverged, 0},
      {"less of the history is left", {{1, 10}, {2, 20}, {3, 30}}, {{3, 30}}, State::kSame},
      {"and went on", {{1, 10}, {2, 20}, {3, 30}}, {{3, 30}, {4, 40}}, State::kFirstBehind, 1},
      {"other numbers", {{1, 10}, {2, 20}}, {{4, 10}, {5, 20}, {6, 30}}, State::kFirstBehind, 2},
      {"other numbers, and both went on", {{1, 10}, {2, 20}}, {{4, 10}, {6, 30}}, State::kDiverged, 1},
      {"one content, made twice", {{1, 10}, {2, 20}}, {{1, 11}, {2, 21}, {3, 20}}, State::kSame},
      {"a restored one is new", {{1, 10}, {2, 20}, {3, 10}}, {{1, 10}, {2, 20}}, State::kSecondBehind, 2},
      {"restored here, gone on there", {{1, 10}, {2, 20}, {3, 10}}, {{1, 10}, {2, 20}, {3, 30}}, State::kDiverged, 2},
      {"restored in both", {{1, 10}, {2, 20}, {3, 10}}, {{1, 10}, {2, 20}, {3, 10}}, State::kSame},
      {"restored in both, in other ways",
       {{1, 10}, {2, 20}, {3, 30}, {4, 10}},
       {{1, 10}, {2, 20}, {3, 30}, {4, 20}},
       State::kDiverged,
       3},
      {"restored, of other numbers", {{4, 10}, {5, 20}, {6, 10}}, {{1, 10}, {2, 20}, {3, 30}}, State::kDiverged, 2},
      {"restored twice",
       {{1, 10}, {2, 20}, {3, 10}, {4, 20}, {5, 10}},
       {{1, 10}, {2, 20}, {3, 10}},
       State::kSecondBehind,
       3},
      {"merged there", {{1, 10}, {2, 20}}, {{1, 10}, {2, 21}, {3, 31, 20}}, State::kFirstBehind, 2},
      {"restored here, an old copy merged there",
       {{1, 10}, {2, 20}, {3, 10}},
       {{1, 10}, {2, 20}, {3, 30, 10}},
       State::kDiverged,
       2},
      {"merged there, and gone on here",
       {{1, 10}, {2, 20}, {3, 30}},
       {{1, 10}, {2, 21}, {3, 31, 20}},
       State::kDiverged,
       1},
  };
  return lines;
}

TEST(Chains, AreOneLineUpToTheLastThatBothHave) {
  for (const Lines& lines : AllLines()) {
    const Compared compared = Compare({.links = lines.first}, {.links = lines.second});
    EXPECT_EQ(compared.state, lines.state) << lines.what;
    EXPECT_EQ(compared.missing, lines.missing) << lines.what;
  }
}

// The other way round; of those that diverged the links of the other are meant then.
TEST(Chains, AreComparedAlikeFromBothSides) {
  for (const Lines& lines : AllLines()) {
    const Compared compared = Compare({.links = lines.second}, {.links = lines.first});
    const State turned = lines.state == State::kFirstBehind    ? State::kSecondBehind
                         : lines.state == State::kSecondBehind ? State::kFirstBehind
                                                               : lines.state;
    EXPECT_EQ(compared.state, turned) << lines.what;
    if (turned != State::kDiverged) {
      EXPECT_EQ(compared.missing, lines.missing) << lines.what;
    }
  }
}

}  // namespace
}  // namespace slamdb::detail
