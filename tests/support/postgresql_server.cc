// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/postgresql_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <grp.h>
#include <netinet/in.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

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

// Whom root lends the server to, as it does not run for root; null: it is not needed.
const passwd* OtherUser() {
  if (::geteuid() != 0) return nullptr;
  const passwd* user = ::getpwnam("postgres");
  return user != nullptr ? user : ::getpwnam("nobody");
}

// In a child process, which ends with its parent.
void Become(const passwd* user) {
  if (user != nullptr && (::setgroups(0, nullptr) != 0 || ::setgid(user->pw_gid) != 0 || ::setuid(user->pw_uid) != 0))
    ::_exit(126);
  ::prctl(PR_SET_PDEATHSIG, SIGQUIT);
}

int FreePort() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  const bool bound = ::bind(socket, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  ::close(socket);
  if (!bound) throw std::runtime_error("no port is free on 127.0.0.1");
  return ntohs(address.sin_port);
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
  std::string name = "/tmp/slamdb_postgresql.XXXXXX";  // the path of a socket has at most 107 bytes
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder: " + name);
  folder_ = name;
  if (const passwd* user = OtherUser(); user != nullptr && ::chown(name.c_str(), user->pw_uid, user->pw_gid) != 0)
    throw std::runtime_error("cannot give away " + name);
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

// Its output goes into a file of the folder, for those who keep it to look at.
pid_t PostgresqlServer::Launch(const std::vector<std::string>& command) const {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  const std::string log = folder_ / "log";
  const passwd* user = OtherUser();
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  Become(user);
  if (::chdir("/") == 0) ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

void PostgresqlServer::Run(const std::vector<std::string>& command) const {
  int status = -1;
  ::waitpid(Launch(command), &status, 0);
  if (status == 0) return;
  std::ifstream log(folder_ / "log");
  throw std::runtime_error(command[0] + ": " + std::string(std::istreambuf_iterator<char>(log), {}));
}

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
    process_ = Launch({Programs() / "postgres", "-D", folder_ / "data"});
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
