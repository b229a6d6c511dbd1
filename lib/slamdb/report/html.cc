// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/report/detail/html.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/markup.h"

namespace slamdb::report {

Html& Html::Escaped(const std::string& text) {
  text_ += detail::EscapedMarkup(text);
  return *this;
}

Html& Html::Drawn(std::string_view bytes) {
  text_ += bytes;
  return *this;
}

std::string Page(const std::string& title, const std::string& body, std::string_view script) {
  const std::string scripts = script.empty() ? "'none'" : detail::PolicySource(script);
  std::string page = detail::Concat(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src ",
      detail::PolicySource(kStyle), "; script-src ", scripts,
      "; base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
      detail::EscapedMarkup(title), "</title>\n<style>", kStyle, "</style>\n</head>\n<body>\n", body);
  if (!script.empty()) page += detail::Concat("<script>", script, "</script>\n");
  return page + "</body>\n</html>\n";
}

}  // namespace slamdb::report
