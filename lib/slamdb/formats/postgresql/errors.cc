// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/errors.h"

#include <algorithm>
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/visible.h"

namespace slamdb::postgresql {
namespace {

// What states mean, the first whose beginning fits.
struct Meaning {
  std::string_view state;
  ErrorKind kind;
  std::string_view before, behind;  // the message
  bool is_worth_retrying = false;
};

constexpr std::string_view kTryAgain = "): try again; what was being saved is there whole, or not at all";
constexpr std::string_view kLetIn = "): check user and password: .pgpass, PGPASSWORD or a service file";
constexpr std::string_view kAtWork = "): try again when it is done";

constexpr std::array kMeanings = {
    Meaning{"08001", ErrorKind::kLocked, "another server, which has the partition, does not answer (",
            "): its atlases wait for it, 'slamdb fleet status' tells more", true},
    Meaning{"08P01", ErrorKind::kLocked, "the server, or a pool in front of the server, ended the connection (",
            "): check user, password and database, or try again; what was being saved is there whole, or not at all",
            true},
    Meaning{"08", ErrorKind::kLocked, "the connection to the server was lost (", kTryAgain, true},
    Meaning{"0A", ErrorKind::kUnsupported, "", ""},
    Meaning{"22", ErrorKind::kNotPossible, "", ""},
    Meaning{"23514", ErrorKind::kNotPossible, "", ""},
    Meaning{"23", ErrorKind::kDamaged, "", ""},
    Meaning{"25006", ErrorKind::kPermission, "the server is a standby, which is read only, or lets nobody write (",
            "): name the primary, or add ?target_session_attrs=read-write"},
    Meaning{"28", ErrorKind::kPermission, "the server does not let this user in (", kLetIn},
    Meaning{"3D000", ErrorKind::kNotFound, "no such database (",
            "): createdb makes one; an atlas is named behind a #, as in postgresql:///DATABASE#NAME"},
    Meaning{"3F000", ErrorKind::kNotFound, "", ""},
    Meaning{"40003", ErrorKind::kLocked, "the connection to the server was lost (", kTryAgain, true},
    Meaning{"40", ErrorKind::kLocked, "another program is at work on it (", kTryAgain, true},
    Meaning{"42501", ErrorKind::kPermission, "the server does not let this user do that (",
            "): its owner can GRANT it"},
    Meaning{"42P01", ErrorKind::kNotFound, "", ""},
    Meaning{"42P04", ErrorKind::kAlreadyExists, "", ""},
    Meaning{"42P06", ErrorKind::kAlreadyExists, "", ""},
    Meaning{"42P07", ErrorKind::kAlreadyExists, "", ""},
    Meaning{"42", ErrorKind::kInternal, "", ""},
    Meaning{"53100", ErrorKind::kOutOfResources, "the server's disk is full (",
            "): what is stored is as it was before this change: try again when there is room"},
    Meaning{"53300", ErrorKind::kOutOfResources, "the server has as many connections as it takes (",
            "): try again, or raise max_connections", true},
    Meaning{"53", ErrorKind::kOutOfResources, "the server has too little left (",
            "): what is stored is as it was before this change"},
    Meaning{"54", ErrorKind::kOutOfResources, "larger than the server allows (", ")"},
    Meaning{"55P03", ErrorKind::kLocked, "another program is at work on it (", kAtWork, true},
    Meaning{"57014", ErrorKind::kNotPossible, "the server ended it (",
            "): somebody cancelled it, or statement_timeout is too short"},
    Meaning{"57P03", ErrorKind::kLocked, "the server takes no connections now (", "): try again", true},
    Meaning{"57P", ErrorKind::kLocked, "the server ended the connection (", kTryAgain, true},
    Meaning{"58", ErrorKind::kDamaged, "the server cannot read or write its files (", "): its log says more"},
    // No state of a server's: what libpq says of its certificate, or that it has none.
    Meaning{"TLS00", ErrorKind::kPermission, "no TLS connection as sslmode asks for (",
            "): the server has to have ssl = on and a certificate with the host's name in it, and sslrootcert to name "
            "the file of the one that signed it"},
    Meaning{"XX001", ErrorKind::kDamaged, "the server's database is damaged (", "): restore a backup"},
    Meaning{"XX002", ErrorKind::kDamaged, "an index of the server's is damaged (", "): REINDEX makes it anew"},
    Meaning{"", ErrorKind::kNotPossible, "", ""},
};

const Meaning& MeaningOf(std::string_view state) {
  return *std::ranges::find_if(kMeanings, [&](const Meaning& meaning) { return state.starts_with(meaning.state); });
}

// One line: what libpq has on several, the later ones indented.
std::string OneLine(std::string_view message) {
  std::string line;
  while (!message.empty()) {
    const std::string_view part = message.substr(0, message.find('\n'));
    message.remove_prefix(std::min(part.size() + 1, message.size()));
    const std::size_t first = part.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) continue;
    line += detail::Concat(line.empty() ? "" : "; ", part.substr(first));
  }
  return detail::Visible(line);
}

}  // namespace

ServerError ErrorOfState(const std::string& path, const std::string& place, std::string_view state,
                         std::string_view message) {
  const Meaning& meaning = MeaningOf(state);
  const std::string problem = detail::Concat(meaning.before, OneLine(message), meaning.behind);
  return {Error(meaning.kind, path, place, problem), std::string(state)};
}

ServerError ConnectionLost(const std::string& path, const std::string& place, std::string_view message) {
  return ErrorOfState(path, place, "08006", message.empty() ? "it does not answer" : message);
}

ServerError NoServer(const std::string& path, std::string_view message) {
  return {Error(ErrorKind::kNotFound, path, "",
                detail::Concat("no server answers (", OneLine(message),
                               "): check host and port, or the service's name, and that it runs and listens there")),
          ""};
}

bool IsWorthRetrying(const Error& error) {
  const auto* server = dynamic_cast<const ServerError*>(&error);
  return server != nullptr && (server->is_unreachable() || MeaningOf(server->state()).is_worth_retrying);
}

}  // namespace slamdb::postgresql
