// A line between a client and a server on loopback that is as slow, as long and as bad as a test wants it: bytes arrive
// late, share one rate, break off or stand still.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <list>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace probewalk::test {

struct LinkOptions {
  double latency_s = 0.0;         // there and back
  double rate_bytes_s = 0.0;      // towards the client, of all connections together; 0 = unlimited
  std::size_t resets_after = 0;   // bytes towards the client, then the connection is reset; 0 = never
};

class SlowLink {
 public:
  SlowLink(int server_port, const LinkOptions& options, int own_port = 0)
      : server_port_(server_port), options_(options), socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    const int yes = 1;
    setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    sockaddr_in address = loopback(own_port);
    socklen_t size = sizeof(address);
    if (socket_ < 0 || bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(socket_, 64) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      throw std::runtime_error("no socket on loopback");
    }
    port_ = ntohs(address.sin_port);
    acceptor_ = std::jthread([this] { accept_all(); });
  }
  ~SlowLink() {
    stop_ = true;
    shutdown(socket_, SHUT_RDWR);
    acceptor_.join();
    close(socket_);
    for (const auto& each : connections_) each->shut();
  }
  SlowLink(const SlowLink&) = delete;
  SlowLink& operator=(const SlowLink&) = delete;

  int port() const { return port_; }
  // While frozen, nothing comes through; nothing is lost.
  void freeze(bool frozen) { frozen_ = frozen; }
  std::size_t bytes_to_client() const { return bytes_to_client_; }
  int resets() const { return resets_; }

 private:
  using Clock = std::chrono::steady_clock;

  struct Piece {
    Clock::time_point due;
    std::vector<char> bytes;
  };
  // One direction of one connection: what has been read waits for its time.
  struct Lane {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<Piece> pieces;
    std::size_t waiting_bytes = 0;
    bool has_ended = false;
  };
  struct Connection {
    int client = -1, server = -1;
    Lane up, down;
    std::vector<std::jthread> threads;

    void shut() {
      shutdown(client, SHUT_RDWR);
      shutdown(server, SHUT_RDWR);
      for (Lane* lane : {&up, &down}) {
        const std::lock_guard lock(lane->mutex);
        lane->has_ended = true;
        lane->changed.notify_all();
      }
    }
    ~Connection() {
      threads.clear();
      if (client >= 0) close(client);
      if (server >= 0) close(server);
    }
  };

  static sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    return address;
  }

  void accept_all() {
    while (!stop_) {
      const int client = accept(socket_, nullptr, nullptr);
      if (client < 0) return;
      const int yes = 1;
      setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
      auto made = std::make_unique<Connection>();
      made->client = client;
      made->server = socket(AF_INET, SOCK_STREAM, 0);
      const sockaddr_in address = loopback(server_port_);
      if (connect(made->server, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) continue;
      setsockopt(made->server, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
      Connection& c = *made;
      connections_.push_back(std::move(made));
      c.threads.emplace_back([this, &c] { read_all(c.client, c.up); });
      c.threads.emplace_back([this, &c] { write_all(c, c.server, c.up, false); });
      c.threads.emplace_back([this, &c] { read_all(c.server, c.down); });
      c.threads.emplace_back([this, &c] { write_all(c, c.client, c.down, true); });
    }
  }

  void read_all(int from, Lane& lane) {
    constexpr std::size_t kMostWaiting_bytes = 4u << 20;
    const auto delay = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.latency_s / 2));
    std::vector<char> buffer(16384);
    while (true) {
      const ssize_t got = recv(from, buffer.data(), buffer.size(), 0);
      std::unique_lock lock(lane.mutex);
      if (got <= 0) {
        lane.has_ended = true;
        lane.changed.notify_all();
        return;
      }
      lane.pieces.push_back({Clock::now() + delay, {buffer.begin(), buffer.begin() + got}});
      lane.waiting_bytes += static_cast<std::size_t>(got);
      lane.changed.notify_all();
      lane.changed.wait(lock, [&] { return lane.waiting_bytes < kMostWaiting_bytes || lane.has_ended; });
    }
  }

  void write_all(Connection& c, int to, Lane& lane, bool to_client) {
    std::size_t sent_bytes = 0;
    while (true) {
      Piece piece;
      {
        std::unique_lock lock(lane.mutex);
        lane.changed.wait(lock, [&] { return !lane.pieces.empty() || lane.has_ended; });
        if (lane.pieces.empty()) break;
        piece = std::move(lane.pieces.front());
        lane.pieces.pop_front();
        lane.waiting_bytes -= piece.bytes.size();
        lane.changed.notify_all();
      }
      std::this_thread::sleep_until(to_client ? std::max(piece.due, turn_of(piece.bytes.size())) : piece.due);
      while (frozen_ && !stop_) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      if (to_client && options_.resets_after > 0 && sent_bytes + piece.bytes.size() > options_.resets_after) {
        const linger at_once{1, 0};
        setsockopt(to, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
        // A socket that a thread still reads from is not closed by close(): only dissolving its connection resets it.
        const sockaddr nowhere{AF_UNSPEC, {}};
        connect(to, &nowhere, sizeof(nowhere));
        ++resets_;
        c.shut();
        return;
      }
      if (!send_all(to, piece.bytes)) break;
      sent_bytes += piece.bytes.size();
      if (to_client) bytes_to_client_ += piece.bytes.size();
    }
    c.shut();
  }

  // When the shared line has time for so many bytes.
  Clock::time_point turn_of(std::size_t bytes) {
    if (options_.rate_bytes_s <= 0.0) return Clock::time_point::min();
    const std::lock_guard lock(rate_mutex_);
    line_free_at_ = std::max(line_free_at_, Clock::now()) +
                    std::chrono::duration_cast<Clock::duration>(
                        std::chrono::duration<double>(static_cast<double>(bytes) / options_.rate_bytes_s));
    return line_free_at_;
  }

  static bool send_all(int to, const std::vector<char>& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t sent = send(to, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (sent <= 0) return false;
      done += static_cast<std::size_t>(sent);
    }
    return true;
  }

  int server_port_;
  LinkOptions options_;
  int socket_;
  int port_ = 0;
  std::atomic<bool> stop_{false}, frozen_{false};
  std::atomic<std::size_t> bytes_to_client_{0};
  std::atomic<int> resets_{0};
  std::mutex rate_mutex_;
  Clock::time_point line_free_at_{};
  std::jthread acceptor_;
  std::list<std::unique_ptr<Connection>> connections_;  // of the acceptor alone, until it has ended
};

}  // namespace probewalk::test
