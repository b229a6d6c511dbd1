// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/pgbouncer.h"

#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "tests/support/server_process.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "/usr/sbin/pgbouncer";

}  // namespace

bool PgBouncer::IsInstalled() { return fs::exists(kProgram); }

PgBouncer::PgBouncer(const PostgresqlServer& server, int connections, std::string_view settings)
    : folder_(MakeServerFolder()), port_(FreePort()) {
  std::ofstream(folder_ / "users") << '"' << PostgresqlServer::kUser << "\" \"\"\n";
  std::ofstream(folder_ / "settings") << "[databases]\n* = host=" << server.folder() << " port=" << server.port()
                                      << "\n[pgbouncer]\nlisten_addr =\nlisten_port = " << port_
                                      << "\nunix_socket_dir = " << folder_.string()
                                      << "\nauth_type = trust\nauth_file = " << (folder_ / "users").string()
                                      << "\npool_mode = transaction\ndefault_pool_size = " << connections
                                      << "\nmax_client_conn = 100\n"
                                      << settings << "\n";
  process_ = LaunchServer({kProgram, folder_ / "settings"}, folder_ / "log");
  constexpr int kTries = 500;
  for (int i = 0; i < kTries && !Answers(); ++i) {
    if (::waitpid(process_, nullptr, WNOHANG) == process_)
      throw std::runtime_error("pgbouncer does not start: see " + (folder_ / "log").string());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

PgBouncer::~PgBouncer() {
  ::kill(process_, SIGKILL);
  ::waitpid(process_, nullptr, 0);
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

// It makes the socket first, and listens a moment later.
bool PgBouncer::Answers() const {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  (folder_ / (".s.PGSQL." + std::to_string(port_))).string().copy(address.sun_path, sizeof address.sun_path - 1);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool answers = ::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(socket);
  return answers;
}

std::string PgBouncer::Uri(std::string_view database) const {
  return "postgresql://" + std::string(PostgresqlServer::kUser) + "@/" + std::string(database) +
         "?host=" + folder_.string() + "&port=" + std::to_string(port_);
}

}  // namespace slamdb
