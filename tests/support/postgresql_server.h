// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace slamdb {

// A PostgreSQL server of its own for one test program: its own files in a temporary folder, its own socket and port.
// Everything is gone with it. Started by root it runs as the user postgres, or as nobody.
//
// Its superuser is kUser, who needs no password through the socket, and kPassword through 127.0.0.1.
class PostgresqlServer {
 public:
  static constexpr std::string_view kUser = "keeper";
  static constexpr std::string_view kPassword = "S3cret/@:%";

  // Tests do without it, by name: if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
  static bool IsInstalled();
  // The one of this program, started when it is first asked for.
  static PostgresqlServer& Shared();

  // Makes the files, and starts. `settings` go into postgresql.conf, a line each.
  explicit PostgresqlServer(std::string_view settings = {});
  // A standby of another one, which follows it: to be read until `SELECT pg_promote()`, and to be written then.
  struct Follow {
    const PostgresqlServer& primary;
  };
  explicit PostgresqlServer(const Follow& follow);
  ~PostgresqlServer();
  PostgresqlServer(const PostgresqlServer&) = delete;
  PostgresqlServer& operator=(const PostgresqlServer&) = delete;

  void Start();
  void Stop();  // as an administrator does
  void Kill();  // as a power cut does: all of its processes, at once
  void Restart() {
    Stop();
    Start();
  }

  // Makes an empty database of a name that none has had, and gives the name.
  std::string MakeDatabase();
  // Through the socket.
  std::string Uri(std::string_view database) const;
  // Through 127.0.0.1; the password percent-encoded.
  std::string TcpUri(std::string_view database, std::string_view password = kPassword) const;
  int port() const { return port_; }
  std::string folder() const { return folder_.string(); }  // with the socket in it

 private:
  void MakeFolder();
  void Configure(std::string_view settings) const;
  void Run(const std::vector<std::string>& command) const;
  bool IsReady() const;
  void End(int signal);

  std::filesystem::path folder_;
  int port_ = 0;
  int databases_ = 0;
  pid_t process_ = 0;  // 0: it does not run
};

}  // namespace slamdb
