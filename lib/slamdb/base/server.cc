// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/server.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

constexpr std::array<std::string_view, 2> kSchemes = {"postgresql://", "postgres://"};
// What the names of parameters with a secret contain, also mistyped: `password`, `sslpassword`, `pasword`.
constexpr std::array<std::string_view, 5> kSecrets = {"passw", "pasw", "pwd", "secret", "_key"};

constexpr std::array<std::string_view, 2> kWords = {"postgresql:", "postgres:"};  // that schemes begin with
constexpr std::string_view kDefaultPort = ":5432";

// Of which one is known to be a letter or a colon.
bool IsSameLetter(char one, char other) { return (one | 0x20) == (other | 0x20); }

// As in `postgressql://` and `pg://`.
std::size_t OtherSchemeOf(std::string_view uri) {
  constexpr std::string_view kBehind = "://";
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const std::size_t size = static_cast<std::size_t>(std::ranges::find_if_not(uri, is_letter) - uri.begin());
  return size > 0 && uri.substr(size).starts_with(kBehind) ? size + kBehind.size() : 0;
}

// How many bytes the scheme has, also one that is mistyped: in other letters, or with too few slashes; 0: it is none.
std::size_t SchemeOf(std::string_view uri) {
  for (const std::string_view word : kWords)
    if (std::ranges::equal(uri.substr(0, word.size()), word, IsSameLetter))
      return std::min(uri.find_first_not_of('/', word.size()), std::min(uri.size(), word.size() + 2));
  return OtherSchemeOf(uri);
}

// As IPv6 has it where somebody forgot its brackets.
bool IsAddress(std::string_view host) {
  constexpr std::string_view kOfAddresses = "0123456789abcdefABCDEF:.[";
  return host.find_first_not_of(kOfAddresses) == std::string_view::npos && host.find(':') != host.rfind(':');
}

// Where the `:` is of the first host of `host:port,host:port` whose port is no number; npos: there is none. What stands
// behind a backslash does not count: JSON has line feeds as `\n`.
std::size_t OddPortOf(std::string_view hosts) {
  for (std::size_t begin = 0; begin < hosts.size();) {
    const std::string_view host = hosts.substr(begin, hosts.find(',', begin) - begin);
    const std::size_t bracket = host.rfind(']');  // of an address of IPv6
    const std::size_t colon = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
    const std::size_t odd = colon == std::string_view::npos ? colon : host.find_first_not_of("0123456789", colon + 1);
    if (odd != std::string_view::npos && host[odd] != '\\' && !IsAddress(host)) return begin + colon;
    begin += host.size() + 1;
  }
  return std::string_view::npos;
}

// Where the `@` is that ends `user:password@`; npos: there are no credentials. `rest` is what follows the scheme.
std::size_t EndOfCredentials(std::string_view rest) {
  const std::size_t slash = rest.find('/');
  const std::size_t at = rest.find('@');
  if (at < slash) return rest.substr(0, rest.find_first_of("/?", at)).rfind('@');
  const bool is_odd = at != std::string_view::npos &&
                      OddPortOf(rest.substr(0, slash)) != std::string_view::npos;  // `user:pass/word@host`
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

bool IsSecret(std::string parameter) {
  std::ranges::transform(parameter, parameter.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (parameter == "sslkey") return false;  // a file
  return std::ranges::any_of(kSecrets,
                             [&](std::string_view word) { return parameter.find(word) != std::string::npos; });
}

// The parameters but the secret ones: `?a=b&password=c` is `?a=b`.
std::string PublicParameters(std::string_view query) {
  std::string out;
  while (!query.empty()) {
    const std::string_view parameter = query.substr(1, query.find('&', 1) - 1);  // behind `?` or `&`
    if (!IsSecret(PercentDecoded(parameter.substr(0, parameter.find('=')))))
      (out += out.empty() ? '?' : '&') += parameter;
    query.remove_prefix(1 + parameter.size());
  }
  return out;
}

// What a URI is made of, as it stands there.
struct Parts {
  std::string_view user, hosts, database, query;
};

Parts PartsOf(std::string_view uri) {
  std::string_view rest = uri.substr(SchemeOf(uri));
  Parts parts;
  const std::size_t query = std::min(rest.find('?'), rest.size());
  parts.query = rest.substr(query);
  if (const std::size_t end = EndOfCredentials(rest); end != std::string_view::npos) {
    parts.user = rest.substr(0, std::min(rest.find(':'), end));
    rest.remove_prefix(end + 1);
  }
  rest.remove_suffix(parts.query.size());
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  parts.hosts = rest.substr(0, slash);
  parts.database = rest.substr(std::min(slash + 1, rest.size()));
  return parts;
}

// The last of a name in a query, as libpq takes it.
std::optional<std::string> Parameter(std::string_view query, std::string_view name) {
  std::optional<std::string> found;
  while (!query.empty()) {
    const std::string_view parameter = query.substr(1, query.find('&', 1) - 1);
    const std::size_t is = std::min(parameter.find('='), parameter.size());
    if (PercentDecoded(parameter.substr(0, is)) == name)
      found = PercentDecoded(parameter.substr(std::min(is + 1, parameter.size())));
    query.remove_prefix(1 + parameter.size());
  }
  return found;
}

// `a,b:1` is `a:5432,b:1`.
std::string WithPorts(std::string_view hosts) {
  std::string out;
  for (const std::string_view host : Split(hosts, ',')) {
    if (!out.empty()) out += ',';
    const std::size_t bracket = host.rfind(']');
    const bool has_port = host.find(':', bracket == std::string_view::npos ? 0 : bracket) != std::string_view::npos;
    for (const char letter : host) out += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    out += has_port ? "" : kDefaultPort;
  }
  return out;
}

}  // namespace

bool IsServer(std::string_view path) {
  return std::ranges::any_of(kSchemes, [&](std::string_view scheme) { return path.starts_with(scheme); });
}

std::size_t FindUri(std::string_view text, std::size_t from) {
  const auto is_letter = [&](std::size_t at) { return std::isalpha(static_cast<unsigned char>(text[at])) != 0; };
  for (; from < text.size(); ++from)
    if (is_letter(from) && (from == 0 || !is_letter(from - 1)) && SchemeOf(text.substr(from)) > 0) return from;
  return std::string_view::npos;
}

std::size_t NameBehind(std::string_view uri) {
  const std::size_t hash = uri.rfind('#'), begin = SchemeOf(uri);
  const std::size_t slash = uri.find('/', begin), colon = uri.find(':', begin), at = uri.find('@', begin);
  const bool is_among_hosts = colon < hash && hash < slash && uri.find('@', hash) != std::string_view::npos;
  const bool is_of_password = is_among_hosts && (at > hash || slash != std::string_view::npos);  // names have no slash
  return is_of_password ? std::string_view::npos : hash;
}

std::string WithoutPassword(std::string_view uri) {
  const std::size_t scheme = SchemeOf(uri);
  if (scheme == 0) return std::string(uri);
  std::string_view rest = uri.substr(scheme);
  std::string out(uri.substr(0, scheme));
  if (const std::size_t end = EndOfCredentials(rest); end != std::string_view::npos) {
    out += rest.substr(0, std::min(rest.find_first_of(":?"), end));
    rest.remove_prefix(end);
  } else if (const std::string_view hosts = rest.substr(0, rest.find_first_of("/?"));
             OddPortOf(hosts) != std::string_view::npos) {  // `user:password`, whose `@host` was forgotten
    out += hosts.substr(0, OddPortOf(hosts));
    rest.remove_prefix(hosts.size());
  }
  const std::size_t query = std::min(rest.find('?'), rest.size());
  out += rest.substr(0, query);
  return out + PublicParameters(rest.substr(query));
}

namespace {

// Whether that is what libpq takes besides URIs: `host=lab dbname=maps`.
bool IsOfKeywords(std::string_view words) {
  constexpr std::array kKeywords = {"host", "hostaddr", "port", "dbname", "user", "service", "sslmode"};
  return std::ranges::any_of(kKeywords, [&](std::string_view keyword) {
    for (std::size_t at = words.find(keyword); at != std::string_view::npos; at = words.find(keyword, at + 1)) {
      const std::size_t behind = words.find_first_not_of(' ', at + keyword.size());
      const bool begins = at == 0 || words[at - 1] == ' ' || words[at - 1] == '=';
      if (begins && behind != std::string_view::npos && words[behind] == '=') return true;
    }
    return false;
  });
}

// Behind a value that begins there: `'a \'b\' c'`, or up to a blank that is not `\ `.
std::size_t EndOfValue(std::string_view words, std::size_t at) {
  const bool is_quoted = at < words.size() && words[at] == '\'';
  for (at += is_quoted ? 1 : 0; at < words.size(); ++at) {
    if (words[at] == (is_quoted ? '\'' : ' ')) return at + (is_quoted ? 1 : 0);
    if (words[at] == '\\') ++at;
  }
  return words.size();
}

}  // namespace

std::string WithoutKeywordPasswords(std::string words) {
  constexpr std::string_view kWord = "password";
  if (!IsOfKeywords(words)) return words;
  for (std::size_t at = words.find(kWord); at != std::string::npos; at = words.find(kWord, at)) {
    at = std::min(words.find_first_not_of(' ', at + kWord.size()), words.size());
    if (at == words.size() || words[at] != '=') continue;
    at = std::min(words.find_first_not_of(' ', at + 1), words.size());
    words.replace(at, EndOfValue(words, at) - at, "...");
  }
  return words;
}

std::string WithoutPasswords(std::string text) {
  constexpr std::string_view kEnds = " \t\r\n\"", kPunctuation = "'\"`,;.:)\\";
  for (std::size_t at = FindUri(text); at != std::string::npos; at = FindUri(text, at + 1)) {
    std::string_view uri = std::string_view(text).substr(at);
    uri = uri.substr(0, uri.find_first_of(kEnds));
    uri = uri.substr(0, uri.find_last_not_of(kPunctuation) + 1);
    const std::size_t name = std::min(NameBehind(uri), uri.size());
    text.replace(at, name, WithoutPassword(uri.substr(0, name)));
  }
  return text;
}

std::string NameOfDatabase(std::string_view uri) {
  const Parts parts = PartsOf(uri);
  std::string name = Parameter(parts.query, "dbname").value_or(PercentDecoded(parts.database));
  return name.empty() ? Parameter(parts.query, "user").value_or(PercentDecoded(parts.user)) : name;
}

std::string DatabaseOfServer(std::string_view uri) {
  const Parts parts = PartsOf(uri);
  std::string hosts = Parameter(parts.query, "host").value_or(std::string(parts.hosts));
  if (const auto port = Parameter(parts.query, "port")) hosts += ":" + *port;
  return WithPorts(hosts) + "/" + NameOfDatabase(uri);
}

void RefuseMistypedServer(const std::string& path) {
  const std::size_t scheme = SchemeOf(path);
  std::error_code missing;
  if ((scheme == 0 && !IsOfKeywords(path)) || IsServer(path) || std::filesystem::exists(path, missing)) return;
  throw Error(ErrorKind::kUsage, path, "",
              Concat("is neither a file nor the URI of a server, which begins with postgresql:// and reads "
                     "postgresql://USER@HOST/DATABASE#NAME, or postgresql:///DATABASE#NAME of one on this machine"));
}

void RequireFile(const std::string& path) {
  if (IsServer(path))
    throw Error(ErrorKind::kUsage, path, "", "is a database of a server, where a file is expected; name a file");
}

void RefuseOnServer(const std::string& path, std::string_view instead) {
  if (IsServer(path))
    throw Error(ErrorKind::kNotPossible, path, "",
                Concat("is a database of a server, and no file of SQLite: ", instead));
}

}  // namespace slamdb::detail
