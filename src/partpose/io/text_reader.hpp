// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/error.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace partpose {

/// The number that the whole word is, in any locale; "nan" and "inf" count, in any case. Numbers too small for a 32-bit
/// float become zero. Nothing for a number too large for it and for any other word.
std::optional<float> parse_float(std::string_view word);

/// The decimal number from 0 to `largest` that the whole word is.
std::optional<std::size_t> parse_count(std::string_view word, std::size_t largest);

/// A word of a file made fit for a one-line message: in quotes, unprintable characters as '?', cut after 40 characters.
std::string in_quotes(std::string_view word);

bool equal_ignoring_case(std::string_view a, std::string_view b);

/// Walks a text word by word (words are separated by white space) or line by line, without copying it.
/// Its errors name the file, and the line (from 1) and byte (from 0) of the word read last.
class TextReader {
 public:
  /// Both views must outlive the reader.
  TextReader(std::string_view text, std::string_view file_name, std::size_t first_byte = 0)
      : text_(text), file_name_(file_name), start_(first_byte), end_(first_byte) {}

  /// The next word, also beyond line ends; empty at the end of the text.
  std::string_view word();

  /// The next word of this line; empty at its end.
  std::string_view word_in_line();

  /// Moves to the next line, whatever is left in this one.
  void skip_line();

  /// Moves to the next line; Error when a word is left in this one.
  void end_line();

  /// Whether only white space is left.
  bool at_end() const;

  /// The byte after the last one read.
  std::size_t offset() const { return end_; }

  /// "part.stl: line 3, byte 40": where the word read last begins.
  std::string place() const { return place_of(start_); }
  std::string place_of(std::size_t byte) const;

  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw Error("{}: {}", place(), fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  std::string_view text_;
  std::string_view file_name_;
  std::size_t start_;  ///< of the word read last
  std::size_t end_;    ///< the byte after it
};

}  // namespace partpose
