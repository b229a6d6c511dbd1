// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/plot/detail/svg.h"

#include <map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/markup.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::plot {
namespace {

using detail::Concat;

// `12.50` of 12.4999: the shortest text of at most two decimals.
std::string Rounded(double number) {
  std::string text = detail::Fixed(number, 2);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

// What a path consists of, letters and numbers, without the `M x y ` that Cairo puts behind every `Z`.
std::string RoundedPath(std::string_view path) {
  std::string rounded;
  std::vector<std::string_view> words;
  for (std::string_view word = detail::TakeWord(path, " "); !word.empty(); word = detail::TakeWord(path, " "))
    words.push_back(word);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool repeated = words[i] == "M" && (i + 3 >= words.size() || words[i + 3] == "M");
    if (repeated) {
      i += 2;
      continue;
    }
    const auto number = detail::ParseNumber<double>(words[i]);
    if (!rounded.empty()) rounded += ' ';
    rounded += number ? Rounded(*number) : std::string(words[i]);
  }
  return rounded;
}

class Tidying {
 public:
  explicit Tidying(std::string_view prefix) : prefix_(prefix) {}

  // The inside of a tag: its name and attributes.
  std::string Tag(std::string_view tag) {
    std::string out(tag.substr(0, tag.find_first_of(" \n")));
    tag.remove_prefix(out.size());
    for (std::size_t equals = tag.find("=\""); equals != std::string_view::npos; equals = tag.find("=\"")) {
      const std::size_t end = tag.find('"', equals + 2);
      Attribute(detail::Trimmed(tag.substr(0, equals)), tag.substr(equals + 2, end - equals - 2), out);
      tag.remove_prefix(end + 1);
    }
    return out.append(detail::Trimmed(tag));
  }

 private:
  void Attribute(std::string_view name, std::string_view value, std::string& out) {
    if (name == "style") {
      for (const std::string_view item : detail::Split(value, ';')) {
        const std::size_t colon = item.find(':');
        if (colon != std::string_view::npos)
          Attribute(detail::Trimmed(item.substr(0, colon)), detail::Trimmed(item.substr(colon + 1)), out);
      }
      return;
    }
    constexpr std::string_view kUrl = "url(#";
    std::string written(value);
    if (name == "id")
      written = NewId(value);
    else if (value.starts_with('#'))
      written = Concat("#", NewId(value.substr(1)));
    else if (value.starts_with(kUrl))
      written = Concat(kUrl, NewId(value.substr(kUrl.size(), value.size() - kUrl.size() - 1)), ")");
    else if (name == "d")
      written = RoundedPath(value);
    else if (const auto number = detail::ParseNumber<double>(value); number && name != "version")
      written = Rounded(*number);
    out += Concat(" ", name, "=\"", written, "\"");
  }

  std::string NewId(std::string_view old) {
    const auto [place, is_new] = ids_.try_emplace(std::string(old), ids_.size());
    return Concat(prefix_, place->second);
  }

  std::string prefix_;
  std::map<std::string, std::size_t, std::less<>> ids_;
};

}  // namespace

std::string TidySvg(std::string_view svg, std::string_view prefix, std::string_view title,
                    std::string_view description) {
  Tidying tidying(prefix);
  std::string out;
  out.reserve(svg.size());
  while (!svg.empty()) {
    const std::size_t begin = svg.find('<'), end = svg.find('>', begin);
    if (end == std::string_view::npos) break;
    const std::string_view tag = svg.substr(begin + 1, end - begin - 1);
    const bool is_root = tag.starts_with("svg ");
    out += Concat("<", tag.starts_with('?') ? std::string(tag) : tidying.Tag(tag), is_root ? " role=\"img\">" : ">");
    if (!tag.starts_with("g ") && !tag.starts_with("use ")) out += '\n';
    if (is_root) {
      out += Concat("<title>", detail::EscapedMarkup(title), "</title>\n");
      if (!description.empty()) out += Concat("<desc>", detail::EscapedMarkup(description), "</desc>\n");
    }
    svg.remove_prefix(end + 1);
  }
  return out;
}

}  // namespace slamdb::plot
