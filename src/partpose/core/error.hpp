// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace partpose {

/// Bad input or a wrong argument: the message is one line that says where (file, and byte or key), what is wrong and
/// what would be right. "Nothing recognized" is never an Error.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string message) : std::runtime_error(one_line(std::move(message))) {}

  template <typename... Args>
  explicit Error(fmt::format_string<Args...> format, Args&&... args)
    requires(sizeof...(Args) > 0)
      : Error(fmt::format(format, std::forward<Args>(args)...)) {}

 private:
  /// Whatever a file, or its name, brought into the message.
  static std::string one_line(std::string text) {
    for (char& c : text)
      if (static_cast<unsigned char>(c) < ' ') c = ' ';
    return text;
  }
};

}  // namespace partpose
