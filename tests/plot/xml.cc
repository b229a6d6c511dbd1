// SPDX-License-Identifier: BSD-3-Clause
#include "tests/plot/xml.h"

#include <regex>
#include <vector>

namespace slamdb::testing {
namespace {

std::string ProblemOfText(std::string_view text) {
  static const std::regex entity("&(amp|lt|gt|quot|apos|#[0-9]+|#x[0-9a-fA-F]+);.*");
  for (std::size_t at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
    const std::string rest(text.substr(at, 12));
    if (!std::regex_match(rest, entity)) return "no entity: " + rest;
  }
  for (const char letter : text)
    if (static_cast<unsigned char>(letter) < 32 && letter != '\n' && letter != '\t') return "a control character";
  return text.find('<') == std::string_view::npos ? "" : "< in a text";
}

// The inside of a tag behind its name.
std::string ProblemOfAttributes(std::string_view rest) {
  while (true) {
    rest.remove_prefix(std::min(rest.find_first_not_of(" \n"), rest.size()));
    if (rest.empty()) return {};
    const std::size_t equals = rest.find("=\"");
    if (equals == std::string_view::npos) return "no attribute: " + std::string(rest);
    if (rest.substr(0, equals).find_first_of(" \"'<>&") != std::string_view::npos)
      return "no name: " + std::string(rest.substr(0, equals));
    const std::size_t end = rest.find('"', equals + 2);
    if (end == std::string_view::npos) return "an open quote";
    if (const std::string problem = ProblemOfText(rest.substr(equals + 2, end - equals - 2)); !problem.empty())
      return problem;
    rest.remove_prefix(end + 1);
  }
}

}  // namespace

std::string ProblemOfXml(std::string_view text) {
  std::vector<std::string> open;
  bool done = false;
  constexpr std::string_view kBegin = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  if (!text.starts_with(kBegin)) return "no beginning";
  text.remove_prefix(kBegin.size());
  while (!text.empty()) {
    const std::size_t begin = text.find('<');
    const std::string_view before = text.substr(0, begin);
    if (const std::string problem = ProblemOfText(before); !problem.empty()) return problem;
    if (open.empty() && before.find_first_not_of(" \n") != std::string_view::npos) return "text outside";
    if (begin == std::string_view::npos) break;
    const std::size_t end = text.find('>', begin);
    if (end == std::string_view::npos) return "an open tag";
    std::string_view tag = text.substr(begin + 1, end - begin - 1);
    text.remove_prefix(end + 1);
    if (done) return "a second root";
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return "closes what is not open: " + std::string(tag);
      open.pop_back();
      done = open.empty();
      continue;
    }
    const bool closed = tag.ends_with('/');
    if (closed) tag.remove_suffix(1);
    const std::string name(tag.substr(0, tag.find_first_of(" \n")));
    if (const std::string problem = ProblemOfAttributes(tag.substr(name.size())); !problem.empty()) return problem;
    if (!closed) open.push_back(name);
  }
  return open.empty() && done ? "" : "is not closed";
}

}  // namespace slamdb::testing
