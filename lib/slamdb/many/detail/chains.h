// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/formats/rows/revisions.h"

// How the revisions of one atlas in two stores lie to each other, by their hashes.
namespace slamdb::detail {

struct Compared {
  enum class State {
    kSame,          // their newest is the same
    kFirstBehind,   // the second has it, and newer ones: its links from `missing` on
    kSecondBehind,  // likewise
    kDiverged,      // each has newer ones than the last that both have: those of the first from `missing` on
  };
  State state = State::kSame;
  std::size_t missing = 0;
};

// An atlas without links is not there: it is behind. Both are one line up to the last link of one number and hash, and
// from there to the last of one hash; what was restored since is new, though its hash is old. Where both went on, one
// is behind all the same when the other was made of its newest besides what was before
// (RevisionChain::Link::from_hash). What was given up counts as if it were there, but for what is `missing`.
Compared Compare(const RevisionChain& first, const RevisionChain& second);

// Whether what either gave up may make a difference. It does not where one is the beginning of the other.
bool DependsOnGivenUp(const RevisionChain& first, const RevisionChain& second);

// The number that a revision of another store has in this one: its own, where the hash is the same, or that of the last
// one with its hash; 0: none.
std::uint64_t NumberOf(const RevisionChain& chain, const RevisionChain::Link& link);
// Of the revision of that number; 0: there is none.
std::uint64_t HashOf(const RevisionChain& chain, std::uint64_t number);

// What of a chain the other neither has nor had, oldest first, without what both have a merge of.
std::vector<RevisionChain::Link> LinksAlone(const RevisionChain& chain, const RevisionChain& other);

// Of those of a page, which are by name; nullptr: there is none of that name.
RevisionChain* FindChain(std::vector<RevisionChain>& chains, const std::string& name);
// Takes the chain of that name out of those of a page; one without links where there is none.
RevisionChain TakeChain(std::vector<RevisionChain>& chains, const std::string& name);

}  // namespace slamdb::detail
