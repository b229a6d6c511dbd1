// SPDX-License-Identifier: BSD-3-Clause
// Connections by TLS, to a server with a certificate of its own making.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "tests/support/error_of.h"
#include "tests/support/postgresql_server.h"
#include "tests/support/server_process.h"

namespace slamdb::postgresql {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kOpenssl = "/usr/bin/openssl";

// A server that takes TLS, with a certificate of `localhost` that it signed itself: FOLDER/server.crt; and another one
// of that name, FOLDER/other.crt.
class TlsServer : public PostgresqlServer {
 public:
  TlsServer() {
    MakeCertificate("server");
    MakeCertificate("other");
    std::ofstream(folder() + "/data/postgresql.conf", std::ios::app)
        << "ssl = on\nssl_cert_file = '" << Certificate("server") << "'\nssl_key_file = '" << folder()
        << "/server.key'\n";
    Restart();
  }
  std::string Certificate(const std::string& name) const { return folder() + "/" + name + ".crt"; }
  std::string UriOf(const std::string& host, const std::string& parameters) const {
    std::string uri = TcpUri("postgres");
    uri.replace(uri.find("127.0.0.1"), 9, host);
    return uri + "?hostaddr=127.0.0.1&" + parameters;
  }

 private:
  void MakeCertificate(const std::string& name) const {
    RunForServer({kOpenssl, "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
                  "-keyout", folder() + "/" + name + ".key", "-out", Certificate(name), "-days", "2", "-subj",
                  "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"},
                 folder() + "/log");
  }
};

class ConnectTls : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
    if (!std::filesystem::exists(kOpenssl)) GTEST_SKIP() << "openssl is not installed";
  }
  static TlsServer& Server() {
    static TlsServer server;
    return server;
  }
  static bool IsEncrypted(const std::string& uri) {
    return Connection(uri).Integer("SELECT ssl::integer FROM pg_stat_ssl WHERE pid = pg_backend_pid()") != 0;
  }
  static Error Refusal(const std::string& uri) {
    const Error error = ErrorOf([&] { Connection connection(uri); });
    for (const char* secret : {"S3cret", "%53", "%73"}) EXPECT_THAT(error.what(), Not(HasSubstr(secret)));
    return error;
  }
};

TEST_F(ConnectTls, ACertificateThatIsTrustedIsTaken) {
  const std::string root = "&sslrootcert=" + Server().Certificate("server");
  EXPECT_TRUE(IsEncrypted(Server().UriOf("localhost", "sslmode=verify-full" + root)));
  EXPECT_TRUE(IsEncrypted(Server().UriOf("elsewhere", "sslmode=verify-ca" + root)));
  EXPECT_TRUE(IsEncrypted(Server().UriOf("elsewhere", "sslmode=require")));
  EXPECT_FALSE(IsEncrypted(Server().UriOf("localhost", "sslmode=disable")));
}

TEST_F(ConnectTls, WhatIsNotTrustedIsRefusedAndNotTriedAgain) {
  struct Case {
    std::string uri;
    const char* says;
  };
  const std::string trusted = "&sslrootcert=" + Server().Certificate("server");
  for (const Case& one :
       {Case{Server().UriOf("localhost", "sslmode=verify-full&sslrootcert=" + Server().Certificate("other")),
             "certificate verify failed"},
        Case{Server().UriOf("elsewhere", "sslmode=verify-full" + trusted), "does not match host name"},
        Case{Server().UriOf("localhost", "sslmode=verify-full&sslrootcert=/nowhere.crt"), "does not exist"}}) {
    const Error error = Refusal(one.uri);
    EXPECT_EQ(error.kind(), ErrorKind::kPermission) << error.what();
    EXPECT_THAT(error.problem(), HasSubstr(one.says));
    EXPECT_THAT(error.problem(), HasSubstr("sslrootcert"));
    EXPECT_FALSE(IsWorthRetrying(error));
  }
}

TEST_F(ConnectTls, AServerWithoutItIsRefusedWhereItIsAskedFor) {
  const Error error = Refusal(PostgresqlServer::Shared().TcpUri("postgres") + "?sslmode=require");
  EXPECT_EQ(error.kind(), ErrorKind::kPermission) << error.what();
  EXPECT_THAT(error.problem(), HasSubstr("ssl = on"));
}

TEST_F(ConnectTls, AWrongPasswordIsNotTakenForAWrongCertificate) {
  std::string uri = Server().TcpUri("postgres", "wrong") + "?sslmode=require";
  EXPECT_THAT(Refusal(uri).problem(), HasSubstr("check user and password"));
}

}  // namespace
}  // namespace slamdb::postgresql
