// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
// What the tests of this folder share.
#pragma once

#include "partpose/core/error.hpp"
#include "partpose/core/point_cloud.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace partpose::testing {

/// A new empty folder that is gone at the end of the test.
class TempFolder {
 public:
  TempFolder() {
    static std::atomic<int> counter = 0;
    path_ = std::filesystem::temp_directory_path() / fmt::format("partpose-io-{}-{}", getpid(), counter++);
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// The path of a file with this content.
  std::filesystem::path file(const std::string& name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }

  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string content(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The message of the Error that `call` throws.
template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

#define EXPECT_CONTAINS(text, part) EXPECT_PRED2(::partpose::testing::contains, text, part)

/// Whether two vectors of plain values are the same bit for bit (NaN included).
template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// `text` with its first `from` replaced, which must be there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("nothing to replace: " + from);
  return text.replace(at, from.size(), to);
}

template <typename T>
std::string as_bytes(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

/// Random points of all magnitudes with every 7th missing (NaN).
inline PointCloud random_cloud(int width, int height, bool normals, bool curvatures, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-30, 20);
  const auto number = [&] { return std::ldexp(mantissa(random), exponent(random)); };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  PointCloud cloud;
  cloud.width = width;
  cloud.height = height;
  for (int i = 0; i < width * height; ++i) {
    if (i % 7 == 3)
      cloud.points.emplace_back(nan, nan, nan);
    else
      cloud.points.emplace_back(number(), number(), number());
    if (normals) cloud.normals.emplace_back(Eigen::Vector3f(number(), number(), number()).normalized());
    if (curvatures) cloud.curvatures.push_back(number());
  }
  return cloud;
}

inline void expect_same_cloud(const PointCloud& a, const PointCloud& b) {
  EXPECT_TRUE(same_bits(a.points, b.points));
  EXPECT_TRUE(same_bits(a.normals, b.normals));
  EXPECT_TRUE(same_bits(a.curvatures, b.curvatures));
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
}

/// `read(path)` of these bytes either succeeds (true) or throws an Error of one printable line that begins with the
/// path.
template <typename Read>
bool reads_or_complains(const TempFolder& folder, const std::string& bytes, const Read& read) {
  std::filesystem::remove(folder / "damaged");  // overwriting is slow on some file systems
  const auto path = folder.file("damaged", bytes);
  try {
    read(path);
    return true;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    EXPECT_TRUE(std::ranges::all_of(message, [](char c) { return c >= ' ' && c <= '~'; })) << message;
    return false;
  }
}

/// Cuts a valid file at every length, and flips bits and bytes of it; returns how many of the cut ones could be read.
template <typename Read>
int survive_damage(const std::string& bytes, const Read& read, int damaged_copies = 2000) {
  const TempFolder folder;
  EXPECT_TRUE(reads_or_complains(folder, bytes, read)) << "the undamaged file must be readable";
  int readable_cuts = 0;
  for (std::size_t length = 0; length < bytes.size(); ++length)
    readable_cuts += reads_or_complains(folder, bytes.substr(0, length), read);

  std::mt19937 random(20260101);
  for (int copy = 0; copy < damaged_copies; ++copy) {
    std::string damaged = bytes;
    for (unsigned changes = 1 + random() % 3; changes > 0; --changes) {
      char& byte = damaged[random() % damaged.size()];
      byte = static_cast<char>(random() % 2 == 0 ? byte ^ (1 << random() % 8) : random());
    }
    reads_or_complains(folder, damaged, read);
  }
  return readable_cuts;
}

}  // namespace partpose::testing
