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

// Likewise, with what either gave up.
struct GivenUpLines {
  const char* what;
  RevisionChain first, second;
  State state;
  std::size_t missing = 0;
};

RevisionChain ChainOf(const Links& given_up, const Links& links) { return {.links = links, .given_up = given_up}; }

TEST(Chains, AreComparedAsIfNothingHadBeenGivenUp) {
  const std::vector<GivenUpLines> all = {
      {"one went on, and gave up what the other has", ChainOf({}, {{1, 10}}),
       ChainOf({{1, 10}, {2, 20}}, {{3, 30}, {4, 40}}), State::kFirstBehind, 0},
      {"of what the other lacks a part can be read", ChainOf({}, {{1, 10}, {2, 20}}),
       ChainOf({{2, 20}, {4, 40}}, {{1, 10}, {3, 30}, {5, 50}}), State::kFirstBehind, 1},
      {"both went on", ChainOf({}, {{1, 10}, {2, 21}}), ChainOf({{1, 10}, {2, 20}}, {{3, 30}}), State::kDiverged, 0},
      {"both went on, what both have is given up in one", ChainOf({{2, 20}}, {{1, 10}, {3, 31}}),
       ChainOf({}, {{1, 10}, {2, 20}, {3, 30}}), State::kDiverged, 1},
      {"both went on, and gave up what both had", ChainOf({{1, 10}}, {{2, 21}}), ChainOf({{1, 10}}, {{2, 20}}),
       State::kDiverged, 0},
      {"restored there, and given up what that was", ChainOf({}, {{1, 10}, {2, 20}, {3, 30}}),
       ChainOf({{1, 10}, {2, 20}, {3, 30}}, {{4, 10}}), State::kFirstBehind, 0},
      {"restored there, gone on here", ChainOf({}, {{1, 10}, {2, 20}, {3, 30}}), ChainOf({{1, 10}, {2, 20}}, {{3, 10}}),
       State::kDiverged, 0},
      {"other numbers", ChainOf({}, {{7, 10}}), ChainOf({{1, 10}}, {{2, 20}}), State::kFirstBehind, 0},
  };
  for (const GivenUpLines& lines : all) {
    EXPECT_TRUE(DependsOnGivenUp(lines.first, lines.second)) << lines.what;
    const Compared compared = Compare(lines.first, lines.second);
    EXPECT_EQ(compared.state, lines.state) << lines.what;
    EXPECT_EQ(compared.missing, lines.missing) << lines.what;
    const State turned = Compare(lines.second, lines.first).state;
    EXPECT_EQ(turned == State::kDiverged, lines.state == State::kDiverged) << lines.what;
    EXPECT_EQ(turned == State::kSecondBehind, lines.state == State::kFirstBehind) << lines.what;
  }
}

std::vector<std::uint64_t> NumbersAlone(const RevisionChain& chain, const RevisionChain& other) {
  std::vector<std::uint64_t> numbers;
  for (const RevisionChain::Link& link : LinksAlone(chain, other)) numbers.push_back(link.number);
  return numbers;
}

TEST(Chains, TellWhatOneAloneHas) {
  using Numbers = std::vector<std::uint64_t>;
  const RevisionChain chain{.links = {{1, 10}, {2, 20}, {3, 30}}};
  EXPECT_EQ(NumbersAlone(chain, chain), Numbers());
  EXPECT_EQ(NumbersAlone(chain, {.links = {{1, 30}}}), Numbers({1, 2}));
  EXPECT_EQ(NumbersAlone({.links = {{1, 30}}}, chain), Numbers());
  EXPECT_EQ(NumbersAlone(chain, ChainOf({{2, 20}}, {{3, 30}})), Numbers({1}));
  // What was merged is in what both have, and what comes before that is not.
  const Links merged = {{3, 31}, {4, 40, 30}};
  EXPECT_EQ(NumbersAlone({.links = {{1, 10}, {2, 20}, {3, 30}, {4, 40, 30}}}, {.links = merged}), Numbers());
  EXPECT_EQ(NumbersAlone({.links = {{1, 10}, {2, 20}, {3, 30}, {4, 40, 30}}}, {.links = {{2, 20}, {4, 40, 30}}}),
            Numbers({1}));
  EXPECT_EQ(NumbersAlone({.links = merged}, {.links = {{1, 10}, {2, 20}, {3, 30}, {4, 40, 30}}}), Numbers());
  // What was taken back by restoring what both have is in neither.
  EXPECT_EQ(NumbersAlone({.links = {{1, 10}, {2, 20}, {3, 10, 10}}}, {.links = {{1, 10}, {2, 30}, {3, 10, 10}}}),
            Numbers({2}));
  EXPECT_EQ(NumbersAlone({.links = {{1, 10}, {2, 20}, {3, 30}, {4, 20, 20}}}, {.links = {{1, 20}}}), Numbers({1, 3}));
  EXPECT_EQ(NumbersAlone({.links = {{1, 10}, {2, 20}, {3, 10, 10}, {4, 30}, {5, 40, 30}}},
                         {.links = {{1, 10}, {2, 31}, {3, 40, 30}}}),
            Numbers({2}));
  // Of a merge with another atlas nothing is told.
  EXPECT_EQ(NumbersAlone({.links = {{1, 10}, {2, 20, 99}}}, {.links = {{1, 20, 99}}}), Numbers({1}));
}

TEST(Chains, OfWhichOneIsTheBeginningOfTheOtherNeedNoLog) {
  const RevisionChain none, one{.links = {{3, 30}}}, two{.links = {{3, 30}, {4, 40}}}, other{.links = {{3, 31}}};
  EXPECT_FALSE(DependsOnGivenUp(none, two));
  EXPECT_FALSE(DependsOnGivenUp(one, two));
  EXPECT_FALSE(DependsOnGivenUp(two, one));
  EXPECT_FALSE(DependsOnGivenUp(two, two));
  EXPECT_TRUE(DependsOnGivenUp(two, other));
}

}  // namespace
}  // namespace slamdb::detail
