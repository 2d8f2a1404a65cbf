// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/isolated_reader.hpp"

#include "partpose/core/error.hpp"
#include "partpose/io/bytes.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace partpose {

namespace {

constexpr char parts_follow = 'P', error_follows = 'E', end_mark = '.';

void store_text(std::string& bytes, const std::string& text) {
  store(bytes, static_cast<std::uint64_t>(text.size()));
  bytes += text;
}

template <typename T>
void store_items(std::string& bytes, const std::vector<T>& items) {
  store(bytes, static_cast<std::uint64_t>(items.size()));
  bytes.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T));
}

/// Walks a message; the child is our own program, so that a whole message (it ends in end_mark) is a right one.
class Message {
 public:
  explicit Message(const std::string& bytes) : bytes_(bytes) {}

  std::string text() {
    const auto size = count();
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  template <typename T>
  std::vector<T> items() {
    std::vector<T> items(count());
    std::memcpy(static_cast<void*>(items.data()), bytes_.data() + at_, items.size() * sizeof(T));
    at_ += items.size() * sizeof(T);
    return items;
  }
  std::size_t count() {
    at_ += sizeof(std::uint64_t);
    return load<std::uint64_t>(bytes_, at_ - sizeof(std::uint64_t));
  }

 private:
  const std::string& bytes_;
  std::size_t at_ = 1;
};

std::string message_of(const std::function<std::vector<NamedMesh>()>& read) {
  std::string bytes(1, parts_follow);
  try {
    const auto parts = read();
    store(bytes, static_cast<std::uint64_t>(parts.size()));
    for (const auto& part : parts) {
      store_text(bytes, part.name);
      store_text(bytes, part.unit);
      store_items(bytes, part.mesh.vertices);
      store_items(bytes, part.mesh.triangles);
    }
  } catch (const Error& error) {
    bytes = error_follows;
    store_text(bytes, error.what());
  }
  return bytes + end_mark;
}

/// A damaged file may send a library round in circles: far more time than any whole file of this size takes.
rlim_t most_cpu_s(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto bytes = std::filesystem::file_size(path, ignored);
  constexpr rlim_t at_least_s = 10, for_each_mb_s = 5;
  return at_least_s + (ignored ? 0 : for_each_mb_s * static_cast<rlim_t>(bytes >> 20));
}

/// The memory that the child may use beside what the process has mapped already: a small file that unpacks without end
/// must not take all that the machine has.
rlim_t most_bytes(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto file_bytes = std::filesystem::file_size(path, ignored);
  unsigned long pages = 0;
  if (std::FILE* own = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(own, "%lu", &pages) != 1) pages = 0;
    std::fclose(own);
  }
  if (pages == 0) return RLIM_INFINITY;
  constexpr rlim_t at_least = rlim_t{2} << 30, for_each_byte = 200;
  return static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + at_least +
         (ignored ? 0 : for_each_byte * static_cast<rlim_t>(file_bytes));
}

[[noreturn]] void be_the_child(int to_parent, rlim_t cpu_s, rlim_t memory_bytes,
                               const std::function<std::vector<NamedMesh>()>& read) {
  for (const int signal_number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGXCPU, SIGINT, SIGTERM})
    signal(signal_number, SIG_DFL);
  const rlimit no_core_file{0, 0};
  setrlimit(RLIMIT_CORE, &no_core_file);
  const rlimit time{cpu_s, cpu_s + 1};
  setrlimit(RLIMIT_CPU, &time);
  const rlimit memory{memory_bytes, memory_bytes};
  setrlimit(RLIMIT_AS, &memory);
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  int exit_code = 0;
  try {
    const std::string bytes = message_of(read);
    for (std::size_t sent = 0; sent < bytes.size();) {
      const auto now = write(to_parent, bytes.data() + sent, bytes.size() - sent);
      if (now < 0 && errno != EINTR) break;
      if (now > 0) sent += static_cast<std::size_t>(now);
    }
  } catch (...) {  // out of memory: the message stays incomplete
    exit_code = 1;
  }
  _exit(exit_code);
}

}  // namespace

std::vector<NamedMesh> read_isolated(const std::filesystem::path& path, const char* library,
                                     const std::function<std::vector<NamedMesh>()>& read_it) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw Error("{}: no pipe to a reader: {}", path.string(), std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) {
    const int reason = errno;
    close(ends[0]);
    close(ends[1]);
    throw Error("{}: no process for a reader: {}", path.string(), std::strerror(reason));
  }
  if (child == 0) {
    close(ends[0]);
    be_the_child(ends[1], most_cpu_s(path), most_bytes(path), read_it);
  }
  close(ends[1]);
  std::string bytes;
  std::array<char, 1 << 16> buffer;
  while (true) {
    const auto now = read(ends[0], buffer.data(), buffer.size());
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) break;
    bytes.append(buffer.data(), static_cast<std::size_t>(now));
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (bytes.empty() || bytes.back() != end_mark || (WIFSIGNALED(status) && WTERMSIG(status) != 0))
    throw Error("{}: {} {} on it: the file is damaged or too large", path.string(), library,
                !WIFSIGNALED(status)          ? "gave up"
                : WTERMSIG(status) == SIGXCPU ? "does not come to an end"
                                              : "crashed");
  Message message(bytes);
  if (bytes[0] == error_follows) throw Error(message.text());
  std::vector<NamedMesh> parts(message.count());
  for (auto& part : parts) {
    part.name = message.text();
    part.unit = message.text();
    part.mesh.vertices = message.items<Eigen::Vector3f>();
    part.mesh.triangles = message.items<std::array<int, 3>>();
    part.file = path;
  }
  return parts;
}

}  // namespace partpose
