// A real nginx on loopback, as this user, with everything that it writes in a folder of its own.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

namespace probewalk::test {

// Empty: not installed.
inline std::string find_nginx() {
  for (const char* path : {"/usr/sbin/nginx", "/usr/local/sbin/nginx", "/usr/bin/nginx"}) {
    if (access(path, X_OK) == 0) return path;
  }
  return {};
}

// What nobody listens on at this moment.
inline int free_port() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  if (probe < 0 || bind(probe, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("no free port on loopback");
  }
  close(probe);
  return ntohs(address.sin_port);
}

// Directives of nginx's configuration.
struct NginxOptions {
  std::string http = {};    // beside the server, such as split_clients
  std::string server = {};  // its locations, and whatever else
  std::string listen = {};  // behind the port: "ssl"
};

class NginxServer {
 public:
  NginxServer(std::filesystem::path folder, const NginxOptions& options)
      : folder_(std::move(folder)), port_(free_port()) {
    namespace fs = std::filesystem;
    fs::create_directories(folder_ / "temp");
    const std::string temp = (folder_ / "temp").string();
    // One process: it needs no other user, and stands still or dies as a whole.
    std::ofstream(folder_ / "nginx.conf")
        << "daemon off;\nmaster_process off;\nworker_processes 1;\npid " << (folder_ / "nginx.pid").string()
        << ";\nerror_log " << (folder_ / "error.log").string() << ";\nevents { worker_connections 256; }\nhttp {\n"
        << "log_format brief '$status $server_protocol $uri $http_range $body_bytes_sent';\naccess_log "
        << log().string() << " brief;\nclient_body_temp_path " << temp << "/body;\nproxy_temp_path " << temp
        << "/proxy;\nfastcgi_temp_path " << temp << "/fastcgi;\nuwsgi_temp_path " << temp << "/uwsgi;\nscgi_temp_path "
        << temp << "/scgi;\n" << options.http << "\nserver {\nlisten 127.0.0.1:" << port_ << " " << options.listen
        << ";\n" << options.server << "\n}\n}\n";
    start();
  }
  ~NginxServer() { kill(); }
  NginxServer(const NginxServer&) = delete;
  NginxServer& operator=(const NginxServer&) = delete;

  int port() const { return port_; }
  std::string url(const std::string& path) const { return "http://127.0.0.1:" + std::to_string(port_) + path; }
  std::filesystem::path log() const { return folder_ / "access.log"; }
  std::string log_text() const { return text_of(log()); }

  // On the same port as before.
  void start() {
    const std::string program = find_nginx(), prefix = folder_.string(), config = (folder_ / "nginx.conf").string();
    process_ = fork();
    if (process_ < 0) throw std::runtime_error("fork failed");
    if (process_ == 0) {
      const int out = open((folder_ / "nginx.out").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
      dup2(out, 1);
      dup2(out, 2);
      execl(program.c_str(), program.c_str(), "-p", prefix.c_str(), "-c", config.c_str(), nullptr);
      _exit(127);
    }
    for (int k = 0; k < 500 && !answers(); ++k) {
      if (waitpid(process_, nullptr, WNOHANG) != 0) {
        process_ = -1;
        throw std::runtime_error("nginx did not start: " + text_of(folder_ / "nginx.out") +
                                 text_of(folder_ / "error.log"));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  // The hard way: whatever is under way breaks off.
  void kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  // It is there, and says nothing any more.
  void stand_still() { ::kill(process_, SIGSTOP); }
  void go_on() { ::kill(process_, SIGCONT); }

 private:
  static std::string text_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  bool answers() const {
    const int client = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    const bool connected = connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    close(client);
    return connected;
  }

  std::filesystem::path folder_;
  int port_;
  pid_t process_ = -1;
};

}  // namespace probewalk::test
