// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

// What every page is made of, as it was built in; all empty where there was no esbuild.
namespace slamdb::view {

extern const std::string_view
    kPageTemplate;                         // page/page.html, with {{TITLE}} {{CSP}} {{STYLE}} {{DATA}} {{SCRIPT}} in it
extern const std::string_view kPageStyle;  // page/page.css
extern const std::string_view kPageScript;  // page/main.ts and what it imports

}  // namespace slamdb::view
