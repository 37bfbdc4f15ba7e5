// Moves the head and hands of Monado's "remote" devices (a headset and two Valve Index controllers) from a test: their
// state goes to the service over a socket, whole, whenever it changes. The layout is that of Monado's driver of 24.0 to
// 25.1; connect() refuses a service whose resting state is not what it should be.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <thread>

namespace probewalk::test {

struct RemotePose {
  float orientation_xyzw[4] = {0, 0, 0, 1};
  float position_m[3] = {0, 0, 0};
};

struct RemoteController {
  RemotePose pose;
  float linear_velocity[3], angular_velocity[3];
  float hand_curl[5];
  float trigger, squeeze, squeeze_force;
  float stick[2];
  float pad_force;
  float pad[2];
  std::uint8_t hand_tracking_active, active;
  std::uint8_t system_click, system_touch, a_click, a_touch, b_click, b_touch, trigger_click, trigger_touch,
      stick_click, stick_touch, pad_touch;
  std::uint8_t padding[3];
};

struct RemoteState {
  char header[8];
  struct {
    float fov[4];
    RemotePose pose;
    std::uint32_t padding;
  } views[2];
  RemotePose head;
  std::uint8_t has_views;
  std::uint8_t padding[3];
  RemoteController left, right;
};
static_assert(sizeof(RemoteController) == 120 && sizeof(RemoteState) == 376);

class RemoteHands {
 public:
  RemoteHands() = default;
  ~RemoteHands() {
    if (socket_ >= 0) close(socket_);
  }
  RemoteHands(const RemoteHands&) = delete;
  RemoteHands& operator=(const RemoteHands&) = delete;

  // A port that nobody listens on, below those that a system hands out by itself: to a port of theirs, a connection
  // that nobody awaits may find its own other end.
  static std::uint16_t free_port() {
    for (int tries = 0; tries < 1000; ++tries) {
      const auto port = static_cast<std::uint16_t>(20000 + (getpid() + 7919 * tries) % 12000);
      const int probe = ::socket(AF_INET, SOCK_STREAM, 0);
      const sockaddr_in address = here(port);
      const bool is_free = bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
      close(probe);
      if (is_free) return port;
    }
    return 0;
  }

  // Tries for `patience`; false when nobody answers in that time, or somebody who talks otherwise.
  bool connect(std::uint16_t port, std::chrono::milliseconds patience) {
    const auto until = std::chrono::steady_clock::now() + patience;
    do {
      socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
      const timeval answer_within{2, 0};
      setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &answer_within, sizeof(answer_within));
      const sockaddr_in address = here(port);
      // It greets with the resting state and the present one.
      if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 && read_state() &&
          read_state()) {
        return state.head.position_m[1] == 1.6f && state.right.active == 1;
      }
      close(socket_);
      socket_ = -1;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    } while (std::chrono::steady_clock::now() < until);
    return false;
  }

  // Sends `state`. The service keeps it.
  bool send() const { return ::send(socket_, &state, sizeof(state), MSG_NOSIGNAL) == sizeof(state); }

  RemoteState state{};

 private:
  static sockaddr_in here(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }
  bool read_state() {
    std::size_t have = 0;
    while (have < sizeof(state)) {
      const ssize_t got = read(socket_, reinterpret_cast<char*>(&state) + have, sizeof(state) - have);
      if (got <= 0) return false;
      have += static_cast<std::size_t>(got);
    }
    return true;
  }

  int socket_ = -1;
};

}  // namespace probewalk::test
