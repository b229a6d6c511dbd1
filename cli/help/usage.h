// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// What is said about command lines that are wrong: one wording for one situation, whatever found it.
namespace slamdb::cli {

// The word of `known` that `word` is most likely a typing mistake of, or empty.
std::string DidYouMean(std::string_view word, const std::vector<std::string>& known);

// "; did you mean 'info'?", or nothing.
std::string MeantInstead(std::string_view word, const std::vector<std::string>& known);

// What is wrong, and the command line to try next.
struct UsageProblem {
  std::string problem, next;
};

// Of a first word that is no verb. `words` is the whole command line without the program. Words of other tools
// (`validate`, `ls`, `cp`) are answered with the verb that does it here.
UsageProblem ProblemOfVerb(const CLI::App& program, std::span<const std::string> words);

// Of what CLI11 found in the options of `verb`. `words` is the whole command line, and `rest` what of it nothing takes.
UsageProblem ProblemOf(const CLI::App& verb, const CLI::ParseError& error, std::span<const std::string> words,
                       const std::vector<std::string>& rest);

// Of an output among the inputs of a verb that wants -o before it: `view lab.osa lab.html`.
std::optional<UsageProblem> ProblemOfOutput(CLI::App& verb, std::span<const std::string> words);

// A problem that a verb finds itself, with the line to try next.
struct WrongUsage : std::runtime_error {
  explicit WrongUsage(UsageProblem found) : std::runtime_error(found.problem), problem(std::move(found)) {}
  UsageProblem problem;
};

// The file beside it that the name of one that is not there is most likely a typing mistake of; empty where there is
// none, or not one alone.
std::string FileMeant(const std::string& path);

}  // namespace slamdb::cli
