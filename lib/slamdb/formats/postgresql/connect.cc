// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/connect.h"

#include <libpq-fe.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hidden_passwords.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/postgresql/detail/handles.h"
#include "slamdb/formats/rows/detail/provenance.h"

namespace slamdb::postgresql {
namespace {

using Clock = std::chrono::steady_clock;
using Settings = std::map<std::string, std::string>;

struct FreeOptions {
  void operator()(PQconninfoOption* options) const { PQconninfoFree(options); }
};
using OptionsHandle = std::unique_ptr<PQconninfoOption, FreeOptions>;

// What libpq reads in a URI, but for passwords.
Settings PublicSettings(const PQconninfoOption* option) {
  Settings settings;
  for (; option->keyword != nullptr; ++option) {
    const bool is_secret = std::string_view(option->dispchar) == "*";
    if (option->val != nullptr && !is_secret) settings[option->keyword] = option->val;
  }
  return settings;
}

// nullopt, and in `problem` why, where it reads none. What it says may quote a password.
std::optional<Settings> SettingsOf(const std::string& uri, std::string& problem) {
  char* message = nullptr;
  const OptionsHandle options(PQconninfoParse(uri.c_str(), &message));
  if (message != nullptr) problem = message;
  PQfreemem(message);
  return options ? std::optional(PublicSettings(options.get())) : std::nullopt;
}

// A password with letters that URIs want encoded makes libpq take parts of it for the host or the like, which errors
// would then show. So it must read the same with and without password.
void CheckUri(const std::string& uri, const std::string& path) {
  std::string problem, ignored;
  const std::optional<Settings> settings = SettingsOf(uri, ignored), public_settings = SettingsOf(path, problem);
  if (settings && settings == public_settings) return;
  if (public_settings && uri.find('@') == std::string::npos)
    problem = "its port is no number; a password stands before @ and the host";
  else if (public_settings)
    problem = "in its password, percent-encode what is neither letter nor digit: %40 for @, %2F for /, %3A for :";
  throw Error(
      ErrorKind::kUsage, path, "",
      detail::Concat("not a URI that libpq reads (", detail::Visible(problem.substr(0, problem.find('\n'))), ")"));
}

// Seconds that each server has to answer; as libpq reads its own setting, where there is one: none below 2 s, and 0 is
// for ever.
double TimeoutOf(PGconn* connection, double otherwise) {
  const OptionsHandle options(PQconninfo(connection));
  const Settings settings = options ? PublicSettings(options.get()) : Settings();
  const auto found = settings.find("connect_timeout");
  if (found == settings.end() || found->second.empty()) return otherwise;
  const int seconds = std::atoi(found->second.c_str());
  return seconds <= 0 ? std::numeric_limits<double>::infinity() : std::max(seconds, 2);
}

// True when libpq can go on with what it wants; false after a moment.
bool IsReady(PGconn* connection, PostgresPollingStatusType wanted) {
  constexpr int kMoment = 100;  // milliseconds
  pollfd socket{PQsocket(connection), static_cast<short>(wanted == PGRES_POLLING_READING ? POLLIN : POLLOUT), 0};
  return socket.fd < 0 || ::poll(&socket, 1, kMoment) > 0;
}

// Which of several servers, or of several addresses of one, it is at.
std::string AddressOf(PGconn* connection) {
  return detail::Concat(PQhost(connection), " ", PQhostaddr(connection), " ", PQport(connection));
}

// Why a connection failed, besides what libpq says.
struct Failures {
  bool is_late = false;  // some server did not answer in time
  bool is_tls = false;   // the last one offers no TLS as it is asked for, or is not trusted
};

// Connects, however that ends.
Failures Finish(PGconn* connection, const ConnectionOptions& options) {
  const double timeout = TimeoutOf(connection, options.timeout);
  Failures failures;
  std::string address;
  Clock::time_point start;
  for (auto wanted = PGRES_POLLING_WRITING; wanted != PGRES_POLLING_OK && wanted != PGRES_POLLING_FAILED;) {
    if (options.progress) options.progress("connecting", 0);
    const std::string before = std::exchange(address, AddressOf(connection));
    if (before != address) start = Clock::now();
    const bool is_ready = IsReady(connection, wanted);
    if (!is_ready && std::chrono::duration<double>(Clock::now() - start).count() < timeout) continue;
    if (!is_ready) {
      ::shutdown(PQsocket(connection), SHUT_RDWR);  // libpq goes on to the next address, as if this had been refused
      failures.is_late = true;
      start = Clock::now();
    }
    failures.is_tls = is_ready && PQstatus(connection) == CONNECTION_SSL_STARTUP;
    wanted = PQconnectPoll(connection);
  }
  return failures;
}

// `FATAL:  28P01: no such user` is taken apart, since what follows is in the language of the server.
struct Refusal {
  std::string state;    // empty: it does not come from a server
  std::string message;  // without what is for developers of PostgreSQL
};

bool IsState(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z'); });
}

Refusal RefusalOf(std::string_view verbose) {
  constexpr std::string_view kLocation = "\nLOCATION:  ";
  constexpr std::size_t kStateSize = 5;
  Refusal refusal;
  refusal.message = verbose;
  for (std::size_t at = 0; (at = refusal.message.find(kLocation, at)) != std::string::npos;)
    refusal.message.erase(at, std::min(refusal.message.find('\n', at + 1), refusal.message.size()) - at);
  for (std::size_t at = 0; (at = refusal.message.find(":  ", at)) != std::string::npos; ++at) {
    const std::string state = refusal.message.substr(at + 3, kStateSize);
    if (state.size() != kStateSize || !IsState(state) || refusal.message.compare(at + 8, 2, ": ") != 0) continue;
    if (refusal.state.empty()) refusal.state = state;
    refusal.message.erase(at + 3, kStateSize + 2);
  }
  return refusal;
}

[[noreturn]] void ThrowRefusal(PGconn* connection, const std::string& path, const Failures& failures, double timeout) {
  const Refusal refusal = RefusalOf(PQerrorMessage(connection));
  const bool wants_password = PQconnectionNeedsPassword(connection) == 1;
  const std::string state = refusal.state.empty() && wants_password ? "28P01" : refusal.state;
  if (!state.empty()) throw ErrorOfState(path, "", state, refusal.message);
  if (failures.is_tls) throw ErrorOfState(path, "", "TLS00", refusal.message);
  throw NoServer(
      path, failures.is_late ? detail::Concat("nothing within ", timeout, " s: ", refusal.message) : refusal.message);
}

}  // namespace

pg_conn* Connect(const std::string& uri, const std::string& path, const ConnectionOptions& options) {
  CheckUri(uri, path);
  const std::string name = rows::ToolName() + " " + rows::Who();
  const std::array<const char*, 4> keywords = {"dbname", "fallback_application_name", "client_encoding", nullptr};
  const std::array<const char*, 4> values = {uri.c_str(), name.c_str(), "UTF8", nullptr};
  std::unique_ptr<PGconn, FinishConnection> connection(PQconnectStartParams(keywords.data(), values.data(), 1));
  if (!connection) throw std::bad_alloc();
  PQsetErrorVerbosity(connection.get(), PQERRORS_VERBOSE);  // with states
  PQsetNoticeProcessor(
      connection.get(), [](void*, const char*) {}, nullptr);
  const Failures failures =
      PQstatus(connection.get()) != CONNECTION_BAD ? Finish(connection.get(), options) : Failures();
  if (PQstatus(connection.get()) != CONNECTION_OK)
    ThrowRefusal(connection.get(), path, failures, TimeoutOf(connection.get(), options.timeout));
  PQsetErrorVerbosity(connection.get(), PQERRORS_DEFAULT);
  return connection.release();
}

std::map<std::string, std::string> ParametersOf(const Connection& connection, const std::string& uri) {
  Settings parameters;
  const OptionsHandle options(PQconninfoParse(detail::WithHiddenPassword(uri).c_str(), nullptr));
  for (const PQconninfoOption* option = options.get(); option != nullptr && option->keyword != nullptr; ++option)
    if (option->val != nullptr && *option->val != 0) parameters[option->keyword] = option->val;
  pg_conn* handle = connection.handle();
  const auto add = [&](const char* name, const char* value) {
    if (value != nullptr && *value != 0) parameters.emplace(name, value);
  };
  add("host", PQhost(handle));
  add("port", PQport(handle));
  add("dbname", PQdb(handle));
  add("user", PQuser(handle));
  return parameters;
}

}  // namespace slamdb::postgresql
