// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace slamdb::plot {

// The SVG that Cairo wrote, made fit to be kept and to stand in a page with others:
//   ids are counted from 0 within the picture, behind `prefix`; Cairo's count all pictures of the process
//   styles are attributes, which a content security policy allows
//   numbers of paths have two decimals, and pictures a name and a description for those who cannot see them
std::string TidySvg(std::string_view svg, std::string_view prefix, std::string_view title,
                    std::string_view description);

}  // namespace slamdb::plot
