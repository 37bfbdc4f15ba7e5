// A user before an X server's screen: presses keys, moves and presses the mouse (XTEST), and looks at what is shown.
// Talks the protocol over the server's own socket, so that no library is needed for it.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "content/image/image.h"

namespace probewalk::test {

// X keysyms.
inline constexpr std::uint32_t kKeyEscape = 0xff1b, kKeyF1 = 0xffbe, kKeyF2 = 0xffbf, kKeyF12 = 0xffc9;

class XScreen {
 public:
  // Of a server on this machine that wants no authority; throws std::runtime_error when it does not answer as it
  // should.
  explicit XScreen(const std::string& display_number) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = "/tmp/.X11-unix/X" + display_number;
    std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
    socket_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
      throw std::runtime_error("no X server at " + path);
    }
    send({'l', 0, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    const Bytes head = receive(8);
    const Bytes setup = receive(4u * word16(head, 6));
    if (head[0] != 1) throw std::runtime_error("the X server refuses: " + std::string(setup.begin(), setup.end()));
    first_keycode_ = setup.at(26);
    const std::size_t keycodes = setup.at(27) - first_keycode_ + 1u;
    const std::size_t root = 32 + (word16(setup, 16) + 3u) / 4 * 4 + 8u * setup.at(21);
    root_ = word32(setup, root);
    width_ = word16(setup, root + 20);
    height_ = word16(setup, root + 22);

    Bytes ask{98, 0, 4, 0, 5, 0, 0, 0, 'X', 'T', 'E', 'S', 'T', 0, 0, 0};
    send(ask);
    const Bytes extension = reply();
    if (extension[8] != 1) throw std::runtime_error("the X server has no XTEST");
    xtest_ = extension[9];

    send({101, 0, 2, 0, first_keycode_, static_cast<std::uint8_t>(keycodes), 0, 0});
    const Bytes mapping = reply();
    for (std::size_t code = 0; code < keycodes; ++code) {
      keysyms_.push_back(word32(mapping, 32 + 4 * code * mapping[1]));
    }
  }
  ~XScreen() { close(socket_); }
  XScreen(const XScreen&) = delete;
  XScreen& operator=(const XScreen&) = delete;

  // A letter's keysym is its ASCII code.
  void key(std::uint32_t keysym, bool down) {
    for (std::size_t k = 0; k < keysyms_.size(); ++k) {
      if (keysyms_[k] != keysym) continue;
      fake(down ? 2 : 3, static_cast<std::uint8_t>(first_keycode_ + k));
      return;
    }
    throw std::runtime_error("the X server's keyboard lacks a key");
  }
  void hold(std::uint32_t keysym, std::chrono::milliseconds time) {
    key(keysym, true);
    std::this_thread::sleep_for(time);
    key(keysym, false);
  }
  void move_pointer(int x, int y) { fake(6, 0, x, y); }
  void left_button(bool down) { fake(down ? 4 : 5, 1); }

  // All that is on the screen, windows included.
  ImageRgb8 picture() {
    Bytes ask{73, 2, 5, 0};
    put32(ask, root_);
    put32(ask, 0);
    put16(ask, width_);
    put16(ask, height_);
    put32(ask, ~0u);
    send(ask);
    const Bytes pixels = reply();
    ImageRgb8 image{width_, height_, {}};
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_) * height_; ++i) {
      for (const std::size_t c : {2, 1, 0}) image.rgb.push_back(pixels.at(32 + 4 * i + c));
    }
    return image;
  }

 private:
  using Bytes = std::vector<std::uint8_t>;

  static std::uint16_t word16(const Bytes& bytes, std::size_t at) {
    return static_cast<std::uint16_t>(bytes.at(at) | bytes.at(at + 1) << 8);
  }
  static std::uint32_t word32(const Bytes& bytes, std::size_t at) {
    return word16(bytes, at) | static_cast<std::uint32_t>(word16(bytes, at + 2)) << 16;
  }
  static void put16(Bytes& bytes, std::uint32_t value) {
    bytes.push_back(static_cast<std::uint8_t>(value));
    bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  }
  static void put32(Bytes& bytes, std::uint32_t value) {
    put16(bytes, value);
    put16(bytes, value >> 16);
  }

  void send(const Bytes& bytes) {
    if (::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
      throw std::runtime_error("the X server went away");
    }
  }
  Bytes receive(std::size_t size) {
    Bytes bytes(size);
    std::size_t have = 0;
    while (have < size) {
      const ssize_t got = read(socket_, bytes.data() + have, size - have);
      if (got <= 0) throw std::runtime_error("the X server went away");
      have += static_cast<std::size_t>(got);
    }
    return bytes;
  }
  // Events have as many bytes as the first part of a reply, and are of no interest.
  Bytes reply() {
    for (;;) {
      Bytes bytes = receive(32);
      if (bytes[0] == 0) throw std::runtime_error("X error " + std::to_string(bytes[1]));
      if (bytes[0] != 1) continue;
      const Bytes rest = receive(4u * word32(bytes, 4));
      bytes.insert(bytes.end(), rest.begin(), rest.end());
      return bytes;
    }
  }

  // XTestFakeInput, done when this returns.
  void fake(std::uint8_t event, std::uint8_t detail, int x = 0, int y = 0) {
    Bytes ask{xtest_, 2, 9, 0, event, detail, 0, 0};
    put32(ask, 0);      // at once
    put32(ask, root_);  // of a motion
    put32(ask, 0);
    put32(ask, 0);
    put16(ask, static_cast<std::uint32_t>(x));
    put16(ask, static_cast<std::uint32_t>(y));
    put32(ask, 0);
    put32(ask, 0);
    send(ask);
    send({43, 0, 1, 0});  // GetInputFocus: answered after what came before
    reply();
  }

  int socket_ = -1;
  std::uint8_t xtest_ = 0, first_keycode_ = 0;
  std::uint32_t root_ = 0;
  std::uint16_t width_ = 0, height_ = 0;
  std::vector<std::uint32_t> keysyms_;  // from first_keycode_ on, without a modifier
};

}  // namespace probewalk::test
