// SPDX-License-Identifier: BSD-3-Clause
#include "cli/page_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <utility>
#include <vector>

#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

constexpr std::size_t kMostRequestBytes = 16 << 10, kMostClients = 32;
constexpr auto kPatience = std::chrono::seconds(10);  // for a request, and for whoever takes nothing of its answer
constexpr int kWaitMilliseconds = 200;

std::string Head(std::string_view status, std::size_t length, std::string_view type) {
  std::string head = "HTTP/1.1 ";
  head.append(status).append("\r\nContent-Type: ").append(type).append("; charset=utf-8\r\nContent-Length: ");
  head += std::to_string(length);
  head +=
      "\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n"
      "Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n";
  return head;
}

PageServer::Answer Refusal(std::string_view status, std::string_view more = {}) {
  const std::string text = std::string(status) + "\n";
  return {Head(status, text.size(), "text/plain") + std::string(more) + "\r\n" + text, false};
}

char Lower(char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter; }

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char letter) { return Lower(letter); });
  return lower;
}

// The value of the one header `Host`; nothing when there is none, or more than one.
std::optional<std::string> HostOf(std::string_view headers) {
  std::optional<std::string> host;
  while (!headers.empty()) {
    const std::string_view line = detail::TakeLine(headers);
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || Lower(line.substr(0, colon)) != "host") continue;
    if (host) return std::nullopt;
    host = Lower(detail::Trimmed(line.substr(colon + 1)));
  }
  return host;
}

void SetNonBlocking(int socket) { ::fcntl(socket, F_SETFL, ::fcntl(socket, F_GETFL) | O_NONBLOCK); }

}  // namespace

PageServer::PageServer(std::string page, std::uint16_t port) : page_(std::move(page)) {
  const std::string name = "127.0.0.1:" + std::to_string(port);
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (listener_ < 0) throw SystemError(name, "cannot make a socket");
  const int yes = 1;
  ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  SetNonBlocking(listener_);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  auto* const where = reinterpret_cast<sockaddr*>(&address);
  if (::bind(listener_, where, length) != 0 || ::listen(listener_, 16) != 0 ||
      ::getsockname(listener_, where, &length) != 0) {
    const Error error = SystemError(name, "cannot listen");
    ::close(listener_);
    throw error;
  }
  port_ = ntohs(address.sin_port);
}

PageServer::~PageServer() {
  for (const Client& client : clients_) ::close(client.socket);
  ::close(listener_);
}

PageServer::Answer PageServer::AnswerTo(std::string_view request) const {
  std::string_view line = detail::TakeLine(request);
  const std::string_view method = detail::TakeWord(line, " "), target = detail::TakeWord(line, " ");
  const std::string_view version = detail::TakeWord(line, " ");
  if (target.empty() || !detail::Trimmed(line).empty() || (version != "HTTP/1.1" && version != "HTTP/1.0"))
    return Refusal("400 Bad Request");
  const std::optional<std::string> host = HostOf(request);
  const std::string mine = ":" + std::to_string(port_);
  if (!host) return Refusal("400 Bad Request");
  if (*host != "127.0.0.1" + mine && *host != "localhost" + mine) return Refusal("421 Misdirected Request");
  if (method != "GET" && method != "HEAD") return Refusal("405 Method Not Allowed", "Allow: GET, HEAD\r\n");
  if (target.substr(0, target.find('?')) != "/") return Refusal("404 Not Found");
  return {Head("200 OK", page_.size(), "text/html") + "\r\n", method == "GET"};
}

void PageServer::Run(const std::function<bool()>& stop) {
  while (!stop()) {
    std::vector<pollfd> waiting = {{listener_, POLLIN, 0}};
    if (clients_.size() >= kMostClients) waiting[0].events = 0;
    for (const Client& client : clients_)
      waiting.push_back({client.socket, static_cast<short>(client.answered ? POLLOUT : POLLIN), 0});
    if (::poll(waiting.data(), waiting.size(), kWaitMilliseconds) > 0) {
      std::size_t i = 1;
      for (Client& client : clients_) {
        if (waiting[i++].revents == 0) continue;
        client.answered ? Send(client) : Receive(client);
      }
      if (waiting[0].revents != 0) Accept();
    }
    DropFinished();
  }
}

void PageServer::Accept() {
  const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (socket >= 0) clients_.push_back({.socket = socket});
}

void PageServer::Receive(Client& client) {
  char bytes[4096];
  const ssize_t got = ::recv(client.socket, bytes, sizeof(bytes), 0);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (got <= 0) {
    client.done = true;
    return;
  }
  client.request.append(bytes, static_cast<std::size_t>(got));
  const std::size_t end = client.request.find("\r\n\r\n");
  if (end != std::string::npos)
    client.answer = AnswerTo(std::string_view(client.request).substr(0, end + 2));
  else if (client.request.size() > kMostRequestBytes)
    client.answer = Refusal("431 Request Header Fields Too Large");
  else
    return;
  client.answered = true;
  client.begun = Clock::now();
}

void PageServer::Send(Client& client) {
  const std::string& head = client.answer.head;
  const std::size_t whole = head.size() + (client.answer.with_page ? page_.size() : 0);
  std::string_view rest = client.sent < head.size() ? std::string_view(head).substr(client.sent)
                                                    : std::string_view(page_).substr(client.sent - head.size());
  const ssize_t sent = ::send(client.socket, rest.data(), rest.size(), MSG_NOSIGNAL);
  if (sent < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (sent < 0) {
    client.done = true;
    return;
  }
  client.sent += static_cast<std::size_t>(sent);
  client.begun = Clock::now();
  client.done = client.sent == whole;
  if (client.done) ::shutdown(client.socket, SHUT_WR);
}

void PageServer::DropFinished() {
  const Clock::time_point now = Clock::now();
  clients_.remove_if([now](const Client& client) {
    const bool finished = client.done || now - client.begun > kPatience;
    if (finished) ::close(client.socket);
    return finished;
  });
}

}  // namespace slamdb::cli
