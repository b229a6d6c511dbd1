// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/detail/server.h"

#include <algorithm>
#include <array>
#include <optional>

namespace slamdb::detail {
namespace {

constexpr std::array<std::string_view, 2> kSchemes = {"postgresql://", "postgres://"};
constexpr std::array<std::string_view, 5> kSecrets = {"password", "sslpassword", "oauth_client_secret",
                                                      "scram_client_key", "scram_server_key"};

// How many bytes the scheme has; 0: it is none of ours.
std::size_t SchemeOf(std::string_view uri) {
  for (const std::string_view scheme : kSchemes) {
    if (uri.starts_with(scheme)) return scheme.size();
  }
  return 0;
}

// True when a host of `host:port,host:port` has a port that is no number.
bool HasOddPort(std::string_view hosts) {
  while (!hosts.empty()) {
    const std::string_view host = hosts.substr(0, hosts.find(','));
    hosts.remove_prefix(std::min(host.size() + 1, hosts.size()));
    const std::size_t bracket = host.rfind(']');  // of an address of IPv6
    const std::size_t colon = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
    if (colon != std::string_view::npos && host.find_first_not_of("0123456789", colon + 1) != std::string_view::npos)
      return true;
  }
  return false;
}

// Where the `@` is that ends `user:password@`; npos: there are no credentials. `rest` is what follows the scheme.
std::size_t EndOfCredentials(std::string_view rest) {
  const std::size_t slash = rest.find('/');
  const std::size_t at = rest.find('@');
  if (at < slash) return rest.substr(0, rest.find_first_of("/?", at)).rfind('@');
  const bool is_odd = at != std::string_view::npos && HasOddPort(rest.substr(0, slash));  // `user:pass/word@host`
  return is_odd ? rest.substr(0, rest.find('?', at)).rfind('@') : std::string_view::npos;
}

std::optional<unsigned> HexDigit(char letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  const char lower = static_cast<char>(letter | 0x20);
  return lower >= 'a' && lower <= 'f' ? std::optional<unsigned>(lower - 'a' + 10) : std::nullopt;
}

std::string PercentDecoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool has_two = text[i] == '%' && i + 2 < text.size();
    const std::optional<unsigned> high = has_two ? HexDigit(text[i + 1]) : std::nullopt;
    const std::optional<unsigned> low = has_two ? HexDigit(text[i + 2]) : std::nullopt;
    if (high && low) i += 2;
    out += high && low ? static_cast<char>(*high << 4U | *low) : text[i];
  }
  return out;
}

// The parameters but the secret ones: `?a=b&password=c` is `?a=b`.
std::string PublicParameters(std::string_view query) {
  std::string out;
  while (!query.empty()) {
    const std::string_view parameter = query.substr(1, query.find('&', 1) - 1);  // behind `?` or `&`
    const std::string key = PercentDecoded(parameter.substr(0, parameter.find('=')));
    if (std::ranges::find(kSecrets, key) == kSecrets.end()) (out += out.empty() ? '?' : '&') += parameter;
    query.remove_prefix(1 + parameter.size());
  }
  return out;
}

}  // namespace

bool IsServer(std::string_view path) { return SchemeOf(path) > 0; }

std::string WithoutPassword(std::string_view uri) {
  const std::size_t scheme = SchemeOf(uri);
  if (scheme == 0) return std::string(uri);
  std::string_view rest = uri.substr(scheme);
  std::string out(uri.substr(0, scheme));
  if (const std::size_t end = EndOfCredentials(rest); end != std::string_view::npos) {
    out += rest.substr(0, std::min(rest.find_first_of(":?"), end));
    rest.remove_prefix(end);
  }
  const std::size_t query = std::min(rest.find('?'), rest.size());
  out += rest.substr(0, query);
  return out + PublicParameters(rest.substr(query));
}

}  // namespace slamdb::detail
