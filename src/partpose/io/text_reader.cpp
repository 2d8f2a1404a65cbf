// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/text_reader.hpp"

#include "partpose/io/bytes.hpp"

#include <algorithm>
#include <charconv>

namespace partpose {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
bool is_space(char c) { return is_blank(c) || c == '\n'; }

/// ASCII only: what the formats' keywords need, and independent of the locale.
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::optional<float> parse_float(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);  // from_chars knows no plus sign
  const char* const end = word.data() + word.size();
  const auto is_whole = [end](const std::from_chars_result& r) { return r.ec == std::errc{} && r.ptr == end; };
  float value = 0;
  const auto result = std::from_chars(word.data(), end, value);
  if (is_whole(result)) return value;
  double wide = 0;
  if (result.ec == std::errc::result_out_of_range && is_whole(std::from_chars(word.data(), end, wide)))
    return narrowed(wide);
  return std::nullopt;
}

std::optional<std::size_t> parse_count(std::string_view word, std::size_t largest) {
  std::size_t value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || stop != word.data() + word.size() || value > largest) return std::nullopt;
  return value;
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string out = "'";
  for (const char c : word.substr(0, longest)) out += c >= ' ' && c <= '~' ? c : '?';
  out += word.size() > longest ? "...'" : "'";
  return out;
}

bool equal_ignoring_case(std::string_view a, std::string_view b) { return std::ranges::equal(a, b, {}, lower, lower); }

std::string_view TextReader::word() {
  while (end_ < text_.size() && is_space(text_[end_])) ++end_;
  return word_in_line();
}

std::string_view TextReader::word_in_line() {
  while (end_ < text_.size() && is_blank(text_[end_])) ++end_;
  start_ = end_;
  while (end_ < text_.size() && !is_space(text_[end_])) ++end_;
  return text_.substr(start_, end_ - start_);
}

void TextReader::skip_line() {
  const auto newline = text_.find('\n', end_);
  end_ = newline == std::string_view::npos ? text_.size() : newline + 1;
}

void TextReader::end_line() {
  if (const auto left = word_in_line(); !left.empty()) fail("{} where the line's end is expected", in_quotes(left));
  skip_line();
}

bool TextReader::at_end() const { return std::ranges::all_of(text_.substr(end_), is_space); }

std::string TextReader::place_of(std::size_t byte) const {
  const auto before = text_.substr(0, byte);
  return fmt::format("{}: line {}, byte {}", file_name_, 1 + std::ranges::count(before, '\n'), byte);
}

}  // namespace partpose
