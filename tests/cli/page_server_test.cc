// SPDX-License-Identifier: BSD-3-Clause
// The server of `slamdb view --serve`, over sockets.
#include "cli/page_server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>
#include <vector>

#include "slamdb/base/error.h"
#include "tests/support/kind_of.h"

namespace slamdb::testing {
namespace {

using cli::PageServer;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Connection {
 public:
  explicit Connection(std::uint16_t port, std::uint32_t address = INADDR_LOOPBACK)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(port);
    where.sin_addr.s_addr = htonl(address);
    connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&where), sizeof(where)) == 0;
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool connected() const { return connected_; }
  void Send(const std::string& text) { ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL); }
  std::string ReadAll() {
    std::string text;
    char bytes[65536];
    for (ssize_t got; (got = ::recv(socket_, bytes, sizeof(bytes), 0)) > 0;)
      text.append(bytes, static_cast<std::size_t>(got));
    return text;
  }

 private:
  int socket_;
  bool connected_ = false;
};

class PageServerTest : public ::testing::Test {
 protected:
  PageServerTest() : server_(page_, 0), thread_([this] { server_.Run([this] { return stop_.load(); }); }) {}
  ~PageServerTest() override {
    stop_ = true;
    thread_.join();
  }

  std::string Host() const { return "Host: 127.0.0.1:" + std::to_string(server_.port()) + "\r\n"; }
  std::string Ask(const std::string& request) {
    Connection connection(server_.port());
    connection.Send(request);
    return connection.ReadAll();
  }

  const std::string page_ = "<!DOCTYPE html>" + std::string(3'000'000, 'x') + "end";
  std::atomic<bool> stop_ = false;
  PageServer server_;
  std::thread thread_;
};

TEST_F(PageServerTest, GivesThePage) {
  for (const std::string target : {"/", "/?a=b"}) {
    const std::string answer = Ask("GET " + target + " HTTP/1.1\r\n" + Host() + "\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
    EXPECT_THAT(answer, HasSubstr("Content-Length: " + std::to_string(page_.size()) + "\r\n"));
    EXPECT_THAT(answer, HasSubstr("Content-Type: text/html; charset=utf-8\r\n"));
    EXPECT_TRUE(answer.ends_with("\r\n\r\n" + page_));
  }
  EXPECT_THAT(Ask("GET / HTTP/1.1\r\nhOsT:  LocalHost:" + std::to_string(server_.port()) + "  \r\n\r\n"),
              StartsWith("HTTP/1.1 200"));
}

TEST_F(PageServerTest, HeadHasNoBody) {
  const std::string answer = Ask("HEAD / HTTP/1.1\r\n" + Host() + "\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("Content-Length: " + std::to_string(page_.size()) + "\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\n"));
}

TEST_F(PageServerTest, HasOnePageAndTwoMethods) {
  for (const std::string target : {"/favicon.ico", "/../etc/passwd", "//", "http://evil/"})
    EXPECT_THAT(Ask("GET " + target + " HTTP/1.1\r\n" + Host() + "\r\n"), StartsWith("HTTP/1.1 404 ")) << target;
  const std::string answer = Ask("POST / HTTP/1.1\r\n" + Host() + "\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(answer, HasSubstr("\r\nAllow: GET, HEAD\r\n"));
}

TEST_F(PageServerTest, RefusesNamesThatLeadHere) {
  const std::string port = std::to_string(server_.port());
  for (const std::string& host :
       std::vector<std::string>{"evil.example:" + port, "127.0.0.1", "127.0.0.1:1", "localhost.evil:" + port, ""}) {
    const std::string answer = Ask("GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 421 ")) << host;
    EXPECT_THAT(answer, Not(HasSubstr("xxx")));
  }
  EXPECT_THAT(Ask("GET / HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(Ask("GET / HTTP/1.1\r\n" + Host() + Host() + "\r\n"), StartsWith("HTTP/1.1 400 "));
}

TEST_F(PageServerTest, RefusesWhatIsNoRequest) {
  for (const std::string& request :
       {std::string("GET\r\n\r\n"), "GET / HTTP/9.9\r\n" + Host() + "\r\n", "GET / x HTTP/1.1\r\n" + Host() + "\r\n",
        std::string("\x16\x03\x01\0\xff\r\n\r\n", 9), std::string("\r\n\r\n")})
    EXPECT_THAT(Ask(request), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(Ask("GET / HTTP/1.1\r\nX: " + std::string(20000, 'y')), StartsWith("HTTP/1.1 431 "));
}

TEST_F(PageServerTest, SlowAndSilentClientsHoldUpNobody) {
  Connection silent(server_.port()), half(server_.port()), deaf(server_.port());
  half.Send("GET / HT");
  deaf.Send("GET / HTTP/1.1\r\n" + Host() + "\r\n");  // and takes nothing of the answer
  EXPECT_THAT(Ask("GET / HTTP/1.1\r\n" + Host() + "\r\n"), StartsWith("HTTP/1.1 200 "));
  half.Send("TP/1.1\r\n" + Host() + "\r\n");
  EXPECT_TRUE(half.ReadAll().ends_with(page_));
}

TEST_F(PageServerTest, ClientsThatGoAwayDoNoHarm) {
  for (int i = 0; i < 50; ++i) {
    Connection gone(server_.port());
    gone.Send("GET / HTTP/1.1\r\n" + Host() + "\r\n");
  }
  EXPECT_THAT(Ask("HEAD / HTTP/1.1\r\n" + Host() + "\r\n"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(PageServerTest, ListensOnThisMachineAlone) {
  EXPECT_THAT(server_.url(), StartsWith("http://127.0.0.1:"));
  EXPECT_FALSE(Connection(server_.port(), 0x7f000002).connected()) << "127.0.0.2";
}

TEST_F(PageServerTest, APortThatIsTakenIsAnError) {
  EXPECT_TRUE(KindOf([&] { PageServer second("", server_.port()); }).has_value());
}

}  // namespace
}  // namespace slamdb::testing
