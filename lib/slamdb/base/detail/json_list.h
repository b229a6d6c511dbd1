// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "slamdb/base/detail/json.h"

namespace slamdb::detail {

// A report with a list that may be long, written item by item: the text is that of JsonText(report), without all of it
// in memory. What stands before the list comes first, then the list, then the rest.
// For sources only, as json.h is.
class JsonListWriter {
 public:
  using Sink = std::function<void(std::string_view text)>;

  JsonListWriter(const Json& head, std::string_view list, Sink sink) : sink_(std::move(sink)) {
    sink_(Concat("{\n", Members(head), ",\n", kIndent, Dumped(Json(list)), ": ["));
  }
  void Add(const Json& item) {
    sink_(Concat(is_empty_ ? "\n" : ",\n", Indented(Dumped(item, 2), Concat(kIndent, kIndent))));
    is_empty_ = false;
  }
  // `tail`: an object of the members behind the list.
  void End(const Json& tail = Json::object()) {
    sink_(Concat(is_empty_ ? "]" : Concat("\n", kIndent, "]"), tail.empty() ? "" : Concat(",\n", Members(tail)),
                 "\n}\n"));
  }

 private:
  static constexpr std::string_view kIndent = "  ";

  // No string of JSON has a line feed in it.
  static std::string Indented(std::string_view text, std::string_view by) {
    std::string indented;
    for (std::size_t first = 0; first < text.size();) {
      const std::size_t end = std::min(text.find('\n', first), text.size() - 1) + 1;
      indented.append(by).append(text.substr(first, end - first));
      first = end;
    }
    return indented;
  }
  // Without the braces.
  static std::string Members(const Json& object) {
    const std::string text = Dumped(object, 2);
    return text.substr(2, text.size() - 4);
  }

  Sink sink_;
  bool is_empty_ = true;
};

}  // namespace slamdb::detail
