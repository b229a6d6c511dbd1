// SPDX-License-Identifier: BSD-3-Clause
// Connecting, and everything that may come between.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <stdexcept>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "tests/support/error_of.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::postgresql {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

// What connecting throws; with a server that is refused nothing of a password is ever said.
Error Refusal(const std::string& uri, const ConnectionOptions& options = {}) {
  const Error error = ErrorOf([&] { Connection connection(uri, options); });
  for (const char* secret : {"S3cret", "S3%", "%53", "wrong", "%77"})
    EXPECT_THAT(error.what(), Not(HasSubstr(secret))) << uri;
  return error;
}

// Says nothing: takes connections, or as many alone as `queue` has room for, and no packet after that.
class SilentServer {
 public:
  explicit SilentServer(int queue = 8) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(socket_, queue) != 0 ||
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("no port is free");
    port_ = ntohs(address.sin_port);
  }
  ~SilentServer() { ::close(socket_); }
  SilentServer(const SilentServer&) = delete;
  SilentServer& operator=(const SilentServer&) = delete;
  int port() const { return port_; }

 private:
  int socket_;
  int port_ = 0;
};

class ConnectTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
  }
  PostgresqlServer& server_ = PostgresqlServer::Shared();
};

TEST(Connect, WithoutAServerThereIsNone) {
  for (const char* uri : {"postgresql://u:S3cret@127.0.0.1:1/db", "postgresql:///db?host=/nowhere&password=S3cret",
                          "postgresql://u:S3cret@host.invalid/db"}) {
    const Error error = Refusal(uri);
    EXPECT_EQ(error.kind(), ErrorKind::kNotFound) << error.what();
    EXPECT_THAT(error.problem(), HasSubstr("no server answers"));
  }
}

TEST(Connect, WhatIsNoUriIsRefusedWithoutItsPassword) {
  for (const char* uri :
       {"postgresql://u:S3cret@h/db?nonsense=1", "postgresql://u:S3cret%zz@h/db", "postgresql://u:S3cret/x@h/db",
        "postgresql://u:S3@S3cret@h/db", "postgresql://[::1/db", "postgresql://h?password=S3cret%zz",
        "postgresql://h?password=S3cret@y", "postgresql://h?password=S3cret&password", "postgresql://h/db?a", "a.db"}) {
    const Error error = Refusal(uri);
    EXPECT_EQ(error.kind(), ErrorKind::kUsage) << error.what();
  }
  EXPECT_THAT(Refusal("postgresql://u:S3cret/x@h/db").problem(), HasSubstr("%2F for /"));
  EXPECT_THAT(Refusal("postgresql://h/db?nonsense=1").problem(), HasSubstr("nonsense"));
}

TEST(Connect, AServerThatSaysNothingIsNotWaitedForForEver) {
  const SilentServer silent;
  const std::string uri = "postgresql://u:S3cret@127.0.0.1:" + std::to_string(silent.port()) + "/db";
  const Error error = Refusal(uri, {.timeout = 0.2, .progress = {}});
  EXPECT_EQ(error.kind(), ErrorKind::kNotFound);
  EXPECT_THAT(error.problem(), HasSubstr("nothing within 0.2 s"));
}

TEST(Connect, ProgressEndsIt) {
  const SilentServer silent;
  const std::string uri = "postgresql://u@127.0.0.1:" + std::to_string(silent.port()) + "/db?connect_timeout=0";
  int calls = 0;
  const Progress stop = [&](std::string_view, double) {
    if (++calls == 3) throw std::runtime_error("enough");
  };
  EXPECT_THROW(Connection(uri, {.timeout = 5, .progress = stop}), std::runtime_error);
}

TEST_F(ConnectTest, ThroughSocketAndLoopback) {
  const std::string name = server_.MakeDatabase();
  EXPECT_EQ(Connection(server_.Uri(name)).Query("SELECT current_database()")[0].Text(0), name);
  const std::string uri = server_.TcpUri(name);
  Connection connection(uri);
  EXPECT_EQ(connection.Integer("SELECT inet_server_port()"), server_.port());
  EXPECT_EQ(connection.path(), "postgresql://keeper@127.0.0.1:" + std::to_string(server_.port()) + "/" + name);
}

TEST_F(ConnectTest, PasswordsAsParametersWorkToo) {
  const std::string plain = server_.TcpUri("postgres"), encoded = plain.substr(20, plain.find('@') - 20);
  const std::string uri = "postgresql://keeper@127.0.0.1:" + std::to_string(server_.port()) + "/postgres";
  ASSERT_EQ(plain.substr(0, 20), "postgresql://keeper:");
  EXPECT_EQ(Connection(uri + "?password=" + encoded).path(), uri);
}

TEST_F(ConnectTest, AWrongPasswordIsNotLetIn) {
  for (const std::string& uri : {server_.TcpUri("postgres", "wrong"), server_.TcpUri("postgres", "S3cret"),
                                 "postgresql://keeper@127.0.0.1:" + std::to_string(server_.port()) + "/postgres"}) {
    const Error error = Refusal(uri);
    EXPECT_EQ(error.kind(), ErrorKind::kPermission) << error.what();
    EXPECT_THAT(error.problem(), HasSubstr("check user and password: .pgpass, PGPASSWORD or a service file"));
    EXPECT_THAT(error.problem(), Not(HasSubstr("LOCATION")));
  }
}

TEST_F(ConnectTest, NoSuchDatabaseAndNoSuchUser) {
  const Error database = Refusal(server_.Uri("missing"));
  EXPECT_EQ(database.kind(), ErrorKind::kNotFound);
  EXPECT_THAT(database.problem(), HasSubstr("no such database"));
  EXPECT_THAT(database.problem(), HasSubstr("\"missing\" does not exist): createdb makes one"));
  const Error user = Refusal(server_.Uri("postgres") + "&user=stranger");
  EXPECT_EQ(user.kind(), ErrorKind::kPermission);
  EXPECT_THAT(user.problem(), HasSubstr("stranger"));
}

TEST_F(ConnectTest, TheFirstServerThatAnswersIsTaken) {
  const std::string port = std::to_string(server_.port()), name = server_.MakeDatabase();
  const std::string uri = server_.TcpUri(name);
  std::string several = uri;
  several.replace(uri.find("127.0.0.1:"), 10 + port.size(), "127.0.0.1:1,127.0.0.1:" + port);
  EXPECT_EQ(Connection(several).Integer("SELECT inet_server_port()"), server_.port());
}

TEST_F(ConnectTest, AServerThatNothingIsHeardOfIsPassedOver) {
  const SilentServer silent(0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(silent.port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::array<int, 3> full{};
  for (int& one : full) {
    one = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    ::connect(one, reinterpret_cast<sockaddr*>(&address), sizeof(address));
  }
  const std::string port = std::to_string(server_.port());
  std::string several = server_.TcpUri("postgres");
  several.replace(several.find("127.0.0.1:"), 10 + port.size(),
                  "127.0.0.1:" + std::to_string(silent.port()) + ",127.0.0.1:" + port);
  EXPECT_EQ(Connection(several, {.timeout = 0.3, .progress = {}}).Integer("SELECT inet_server_port()"), server_.port());
  for (const int one : full) ::close(one);
}

TEST_F(ConnectTest, NoticesOfTheServerAreNotPrinted) {
  Connection connection(server_.Uri(server_.MakeDatabase()));
  ::testing::internal::CaptureStderr();
  connection.Execute("DROP TABLE IF EXISTS missing");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace slamdb::postgresql
