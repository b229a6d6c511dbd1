// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <string_view>

namespace slamdb::cli {

// One page over HTTP, for browsers on this machine alone: it listens on 127.0.0.1, and answers only those who call it
// so
// (`Host`), so that no page of another site reads it through a name that leads here.
//
// Not thread-safe.
class PageServer {
 public:
  // Listens; port 0: one that is free. Throws Error when the port is taken, or not for this user.
  PageServer(std::string page, std::uint16_t port);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  std::uint16_t port() const { return port_; }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_) + "/"; }

  // Answers until `stop` says so, which is asked several times a second.
  void Run(const std::function<bool()>& stop);

  // What is answered to a request, of which these are the lines up to the empty one.
  struct Answer {
    std::string head;
    bool with_page = false;  // the page follows
  };
  Answer AnswerTo(std::string_view request) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Client {
    int socket;
    Clock::time_point begun = Clock::now();
    std::string request = {};
    Answer answer = {};
    std::size_t sent = 0;
    bool answered = false, done = false;
  };

  void Accept();
  void Receive(Client& client);
  void Send(Client& client);
  void DropFinished();

  std::string page_;
  std::uint16_t port_ = 0;
  int listener_ = -1;
  std::list<Client> clients_;
};

}  // namespace slamdb::cli
