// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/postgresql_server.h"

#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tests/support/server_process.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

// Where the newest server's programs are; empty: there is none. Debian keeps them out of PATH.
fs::path Programs() {
  fs::path newest;
  int newest_version = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/usr/lib/postgresql", ignored)) {
    const int version = std::atoi(entry.path().filename().c_str());
    if (version <= newest_version || !fs::exists(entry.path() / "bin/initdb")) continue;
    newest_version = version;
    newest = entry.path() / "bin";
  }
  const auto in_path = {"/usr/bin", "/usr/local/bin"};
  const auto* found = std::ranges::find_if(in_path, [](const char* f) { return fs::exists(fs::path(f) / "initdb"); });
  return newest.empty() && found != in_path.end() ? fs::path(*found) : newest;
}

std::vector<pid_t> ChildrenOf(pid_t process) {
  const std::string number = std::to_string(process);
  std::ifstream list("/proc/" + number + "/task/" + number + "/children");
  return {std::istream_iterator<pid_t>(list), {}};
}

std::string PercentEncoded(std::string_view text) {
  std::ostringstream out;
  for (const unsigned char byte : text) out << '%' << std::hex << byte / 16 << byte % 16;
  return out.str();
}

}  // namespace

bool PostgresqlServer::IsInstalled() { return !Programs().empty(); }

PostgresqlServer& PostgresqlServer::Shared() {
  static PostgresqlServer server;
  return server;
}

PostgresqlServer::PostgresqlServer(std::string_view settings) {
  MakeFolder();
  std::ofstream(folder_ / "password") << kPassword;
  Run({Programs() / "initdb", "--pgdata=" + (folder_ / "data").string(), "--username=" + std::string(kUser),
       "--pwfile=" + (folder_ / "password").string(), "--auth-local=trust", "--auth-host=scram-sha-256",
       "--encoding=UTF8", "--locale=C", "--no-sync"});
  Configure(settings);
  Start();
}

PostgresqlServer::PostgresqlServer(const Follow& follow) {
  MakeFolder();
  Run({Programs() / "pg_basebackup", "--pgdata=" + (folder_ / "data").string(), "--host=" + follow.primary.folder(),
       "--port=" + std::to_string(follow.primary.port()), "--username=" + std::string(kUser), "--write-recovery-conf",
       "--checkpoint=fast", "--no-sync"});
  Configure({});
  Start();
}

void PostgresqlServer::MakeFolder() {
  folder_ = MakeServerFolder();
  port_ = FreePort();
}

// What stands later in the file counts.
void PostgresqlServer::Configure(std::string_view settings) const {
  std::ofstream(folder_ / "data/postgresql.conf", std::ios::app)
      << "listen_addresses = '127.0.0.1'\nport = " << port_ << "\nunix_socket_directories = '" << folder_.string()
      << "'\nfsync = off\nshared_buffers = 16MB\nautovacuum = off\n"
      << settings << "\n";
}

PostgresqlServer::~PostgresqlServer() {
  End(SIGQUIT);
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void PostgresqlServer::Run(const std::vector<std::string>& command) const { RunForServer(command, folder_ / "log"); }

// The eighth line of the file that it keeps while it runs says so.
bool PostgresqlServer::IsReady() const {
  std::ifstream file(folder_ / "data/postmaster.pid");
  std::string line;
  for (int i = 0; i < 8; ++i) std::getline(file, line);
  return file && line.starts_with("ready");
}

// Once more when it ends at once: what was killed leaves memory that is still in use for a moment.
void PostgresqlServer::Start() {
  constexpr int kTries = 50;
  std::error_code ignored;
  for (int i = 0; i < kTries && process_ == 0; ++i) {
    fs::remove(folder_ / "data/postmaster.pid", ignored);
    process_ = LaunchServer({Programs() / "postgres", "-D", folder_ / "data"}, folder_ / "log");
    while (!IsReady() && process_ != 0) {
      std::this_thread::sleep_for(milliseconds(10));
      if (::waitpid(process_, nullptr, WNOHANG) == process_) process_ = 0;
    }
    if (process_ == 0) std::this_thread::sleep_for(milliseconds(100));
  }
  if (process_ == 0) throw std::runtime_error("the server does not start: see " + (folder_ / "log").string());
}

void PostgresqlServer::End(int signal) {
  if (process_ == 0) return;
  ::kill(process_, signal);
  ::waitpid(process_, nullptr, 0);
  process_ = 0;
}

void PostgresqlServer::Stop() { End(SIGINT); }

void PostgresqlServer::Kill() {
  if (process_ == 0) return;
  ::kill(process_, SIGSTOP);  // so that it makes no more
  const std::vector<pid_t> children = ChildrenOf(process_);
  End(SIGKILL);
  for (const pid_t child : children) ::kill(child, SIGKILL);
}

std::string PostgresqlServer::MakeDatabase() {
  const std::string name = "test" + std::to_string(++databases_);
  Run({Programs() / "createdb", "--host=" + folder_.string(), "--port=" + std::to_string(port_),
       "--username=" + std::string(kUser), name});
  return name;
}

std::string PostgresqlServer::Uri(std::string_view database) const {
  return "postgresql://" + std::string(kUser) + "@/" + std::string(database) + "?host=" + folder_.string() +
         "&port=" + std::to_string(port_);
}

std::string PostgresqlServer::TcpUri(std::string_view database, std::string_view password) const {
  return "postgresql://" + std::string(kUser) + ":" + PercentEncoded(password) + "@127.0.0.1:" + std::to_string(port_) +
         "/" + std::string(database);
}

}  // namespace slamdb
