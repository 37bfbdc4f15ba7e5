// A web server on loopback that does what a test tells it to, faults included.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace probewalk::test {

struct HttpRequest {
  std::string path;
  std::size_t range_from = 0;  // of "Range: bytes=N-"; 0 = none
};

struct HttpReply {
  int status = 200;
  std::string body;                              // from range_from on where status is 206
  std::size_t breaks_after = std::string::npos;  // bytes of the body, then the connection is cut
  double stalls_s = 0.0;                         // before the body
};

class HttpServer {
 public:
  using Handler = std::function<HttpReply(const HttpRequest&)>;

  explicit HttpServer(Handler handler) : handler_(std::move(handler)), socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    if (socket_ < 0 || bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(socket_, 64) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      throw std::runtime_error("no socket on loopback");
    }
    port_ = ntohs(address.sin_port);
    acceptor_ = std::thread([this] { accept_all(); });
  }
  ~HttpServer() {
    stop_ = true;
    shutdown(socket_, SHUT_RDWR);
    close(socket_);
    acceptor_.join();
    for (std::thread& each : connections_) each.join();
  }
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }
  int requests() const { return requests_; }

 private:
  void accept_all() {
    while (!stop_) {
      const int connection = accept(socket_, nullptr, nullptr);
      if (connection < 0) return;
      connections_.emplace_back([this, connection] { serve(connection); });
    }
  }

  // One request a connection: plain, and every fault is that request's alone.
  void serve(int connection) {
    std::string text;
    char buffer[4096];
    while (text.find("\r\n\r\n") == std::string::npos) {
      const ssize_t got = recv(connection, buffer, sizeof(buffer), 0);
      if (got <= 0) break;
      text.append(buffer, static_cast<std::size_t>(got));
    }
    const std::size_t from = text.find(' '), to = text.find(' ', from + 1);
    if (to != std::string::npos) {
      ++requests_;
      HttpRequest request{text.substr(from + 1, to - from - 1), 0};
      if (const std::size_t at = text.find("bytes="); at != std::string::npos)
        request.range_from = std::stoul(text.substr(at + 6));
      HttpReply reply = handler_(request);
      std::string head = "HTTP/1.1 " + std::to_string(reply.status) +
                         " Test\r\nConnection: close\r\nContent-Length: " + std::to_string(reply.body.size()) +
                         "\r\n\r\n";
      send_all(connection, head);
      for (int k = 0; k < static_cast<int>(reply.stalls_s * 100.0) && !stop_; ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      if (reply.breaks_after < reply.body.size()) {
        send_all(connection, reply.body.substr(0, reply.breaks_after));
        const linger reset{1, 0};  // closing sends a reset, once what was sent has had time to arrive
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        setsockopt(connection, SOL_SOCKET, SO_LINGER, &reset, sizeof(reset));
      } else {
        send_all(connection, reply.body);
      }
    }
    close(connection);
  }
  static void send_all(int connection, const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t sent = send(connection, text.data() + done, text.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) return;
      done += static_cast<std::size_t>(sent);
    }
  }

  Handler handler_;
  int socket_;
  int port_ = 0;
  std::atomic<bool> stop_{false};
  std::atomic<int> requests_{0};
  std::thread acceptor_;
  std::vector<std::thread> connections_;  // of the acceptor alone, until it has ended
};

}  // namespace probewalk::test
