// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/file.hpp"

#include "partpose/core/error.hpp"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <fstream>
#include <system_error>

namespace partpose {

namespace {

std::atomic<int> being_written = 0;
static_assert(std::atomic<int>::is_always_lock_free);

struct CountAsBeingWritten {
  CountAsBeingWritten() { ++being_written; }
  ~CountAsBeingWritten() { --being_written; }
};

/// A hidden name in the same folder (a rename across file systems is not atomic) that no other writer uses.
std::filesystem::path temporary_name_beside(const std::filesystem::path& path) {
  static std::atomic<unsigned> counter = 0;
  return path.parent_path() / fmt::format(".{}.{}-{}.tmp", path.filename().string(), getpid(), counter++);
}

}  // namespace

void check_is_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) throw Error("{}: no such file", path.string());
  if (error) throw Error("{}: cannot be read: {}", path.string(), error.message());
  if (std::filesystem::is_directory(status)) throw Error("{}: is a folder, a file is needed", path.string());
  if (!std::filesystem::is_regular_file(status)) throw Error("{}: is not a regular file", path.string());
}

std::string read_file(const std::filesystem::path& path) {
  check_is_file(path);
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();  // of the opened file: by its path it may be another one by now
  if (size < 0) throw Error("{}: cannot be read: {}", path.string(), std::generic_category().message(errno));
  if (size == 0) throw Error("{}: byte 0: the file is empty", path.string());
  std::string bytes(static_cast<std::size_t>(size), '\0');
  stream.seekg(0);
  stream.read(bytes.data(), size);
  if (!stream) throw Error("{}: byte {}: reading stopped, {} bytes expected", path.string(), stream.gcount(), size);
  return bytes;
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  const CountAsBeingWritten count;
  const auto temporary = temporary_name_beside(path);
  std::error_code error;
  errno = 0;
  std::ofstream stream(temporary, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (stream)
    std::filesystem::rename(temporary, path, error);
  else
    error = std::error_code(errno != 0 ? errno : EIO, std::generic_category());
  if (!error) return;

  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  throw Error("{}: cannot be written: {}", path.string(), error.message());
}

int files_being_written() noexcept { return being_written; }

}  // namespace partpose
