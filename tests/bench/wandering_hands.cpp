// wandering_hands PORT: somebody who is never done, for Monado's remote devices at that port: looks around, takes
// steps, aims and teleports, turns, moves by stick, recentres, shows and hides the overlay, at random, until it is told
// to end (SIGTERM). A service that goes away is waited for. Says at its end what it did. tools/soak --hands uses it.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <thread>

#include "support/remote_hands.h"

namespace probewalk::test {
namespace {

using namespace std::chrono_literals;

std::atomic<bool> is_over{false};

RemotePose pose_of(double yaw_rad, double pitch_rad, float x_m, float y_m, float z_m) {
  const double sy = std::sin(yaw_rad / 2), cy = std::cos(yaw_rad / 2);
  const double sp = std::sin(pitch_rad / 2), cp = std::cos(pitch_rad / 2);
  return {{static_cast<float>(cy * sp), static_cast<float>(sy * cp), static_cast<float>(-sy * sp),
           static_cast<float>(cy * cp)},
          {x_m, y_m, z_m}};
}

struct Done {
  int looks = 0, teleports = 0, turns = 0, moves = 0, recentres = 0, overlays = 0, connections = 0;
};

class Wanderer {
 public:
  explicit Wanderer(std::uint16_t port) : port_(port) {}

  Done wander() {
    while (!is_over) {
      hands_.emplace();
      if (!hands_->connect(port_, 1000ms)) continue;
      ++done_.connections;
      while (!is_over && act()) {
      }
    }
    return done_;
  }

 private:
  // False when the service has gone.
  bool act() {
    RemoteState& state = hands_->state;
    switch (dice_() % 8) {
      case 0:
      case 1: {  // looks around, and steps about within what a room has to offer
        yaw_rad_ += between(-0.7, 0.7);
        x_m_ = std::clamp(x_m_ + between(-0.2, 0.2), -0.6, 0.6);
        z_m_ = std::clamp(z_m_ + between(-0.2, 0.2), -0.6, 0.6);
        state.head = pose_of(yaw_rad_, between(-0.3, 0.2), static_cast<float>(x_m_),
                             static_cast<float>(between(1.4, 1.7)), static_cast<float>(z_m_));
        ++done_.looks;
        return hold(400ms);
      }
      case 2:
      case 3:
      case 4: {  // aims somewhere ahead, sweeps, lets go
        const double yaw_rad = yaw_rad_ + between(-0.6, 0.6);
        for (int k = 0; k < 4; ++k) {
          state.right.pose = pose_of(yaw_rad + 0.05 * k, between(-0.8, 0.0), static_cast<float>(x_m_) + 0.2f, 1.2f,
                                     static_cast<float>(z_m_) - 0.2f);
          state.right.trigger = 1.0f;
          if (!hold(150ms)) return false;
        }
        state.right.trigger = 0.0f;
        ++done_.teleports;
        return hold(600ms);
      }
      case 5:
        state.right.stick[0] = dice_() % 2 == 0 ? 1.0f : -1.0f;
        if (!hold(150ms)) return false;
        state.right.stick[0] = 0.0f;
        ++done_.turns;
        return hold(200ms);
      case 6:
        state.left.stick[0] = static_cast<float>(between(-1.0, 1.0));
        state.left.stick[1] = static_cast<float>(between(-1.0, 1.0));
        if (!hold(700ms)) return false;
        state.left.stick[0] = state.left.stick[1] = 0.0f;
        ++done_.moves;
        return hold(100ms);
      default: {
        const bool is_overlay = dice_() % 2 == 0;  // the menu's button, held
        (is_overlay ? state.right : state.left).b_click = 1;
        if (!hold(is_overlay ? 1200ms : 100ms)) return false;
        state.right.b_click = state.left.b_click = 0;
        ++(is_overlay ? done_.overlays : done_.recentres);
        return hold(300ms);
      }
    }
  }

  bool hold(std::chrono::milliseconds time) {
    if (!hands_->send()) return false;
    const auto end = std::chrono::steady_clock::now() + time;
    while (!is_over && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(10ms);
    return true;
  }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(dice_()) / static_cast<double>(std::mt19937::max());
  }

  std::uint16_t port_;
  std::optional<RemoteHands> hands_;
  std::mt19937 dice_{7};
  double yaw_rad_ = 0.0, x_m_ = 0.0, z_m_ = 0.0;
  Done done_;
};

}  // namespace
}  // namespace probewalk::test

int main(int argc, char** argv) {
  using namespace probewalk::test;
  const int port = argc == 2 ? std::atoi(argv[1]) : 0;
  if (port < 1 || port > 65535) {
    fmt::print(stderr, "usage: wandering_hands PORT\n");
    return 2;
  }
  std::signal(SIGTERM, [](int) { is_over = true; });
  std::signal(SIGINT, [](int) { is_over = true; });
  const Done done = Wanderer(static_cast<std::uint16_t>(port)).wander();
  fmt::print(
      "hands: {} teleports aimed, {} turns, {} moves, {} looks, {} recentrings, {} times the overlay; "
      "connected {} times\n",
      done.teleports, done.turns, done.moves, done.looks, done.recentres, done.overlays, done.connections);
  return done.connections > 0 ? 0 : 1;
}
