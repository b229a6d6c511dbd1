// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/hidden_passwords.h"

#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "slamdb/base/detail/server.h"

namespace slamdb::detail {
namespace {

struct Hidden {
  std::mutex mutex;
  std::map<std::string, std::string> uris;  // as they were given, by what is shown
};

Hidden& TheHidden() {
  static Hidden hidden;
  return hidden;
}

}  // namespace

std::string HidePassword(std::string word) {
  const std::size_t at = FindUri(word);
  if (at == std::string::npos) return WithoutKeywordPasswords(std::move(word));
  const std::string_view location = std::string_view(word).substr(at);
  std::string uri(location.substr(0, NameBehind(location)));
  std::string shown = WithoutPassword(uri);
  if (shown == uri) return word;
  word.replace(at, uri.size(), shown);
  Hidden& hidden = TheHidden();
  const std::lock_guard lock(hidden.mutex);
  hidden.uris.insert_or_assign(std::move(shown), std::move(uri));
  return word;
}

std::string WithHiddenPassword(const std::string& path) {
  Hidden& hidden = TheHidden();
  const std::lock_guard lock(hidden.mutex);
  const auto found = hidden.uris.find(path);
  return found == hidden.uris.end() ? path : found->second;
}

}  // namespace slamdb::detail
