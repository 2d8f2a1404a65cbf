// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/text_reader.hpp"

#include "partpose/io/testing.hpp"

#include <cmath>

namespace partpose {
namespace {

using namespace testing;

TEST(ParseFloat, ReadsEveryNotation) {
  EXPECT_EQ(parse_float("1.5"), 1.5f);
  EXPECT_EQ(parse_float("-.5e+02"), -50.0f);
  EXPECT_EQ(parse_float("+7."), 7.0f);
  EXPECT_EQ(parse_float("3.4028235e38"), std::numeric_limits<float>::max());
  EXPECT_EQ(parse_float("1e-45"), std::numeric_limits<float>::denorm_min());
  EXPECT_EQ(parse_float("1e-60"), 0.0f);
  EXPECT_TRUE(std::isnan(parse_float("NaN").value()));
  EXPECT_TRUE(std::isnan(parse_float("-nan(ind)").value()));
  EXPECT_EQ(parse_float("-inf"), -std::numeric_limits<float>::infinity());
}

TEST(ParseFloat, RefusesWhatIsNoNumberOrTooLarge) {
  for (const char* word : {"", "+", "-", "+-1", "1,5", "1.5mm", "0x10", "1e", "e5", "--1", "1e39", "1e400", "1.#QNAN"})
    EXPECT_EQ(parse_float(word), std::nullopt) << word;
}

TEST(ParseCount, TakesDecimalNumbersUpToTheLargest) {
  EXPECT_EQ(parse_count("0", 10), 0);
  EXPECT_EQ(parse_count("10", 10), 10);
  for (const char* word : {"", "11", "-1", "+1", "1.0", "99999999999999999999999", "ten"})
    EXPECT_EQ(parse_count(word, 10), std::nullopt) << word;
}

TEST(InQuotes, MakesAnyWordFitForALine) {
  EXPECT_EQ(in_quotes("facet"), "'facet'");
  EXPECT_EQ(in_quotes(std::string("a\n") + '\0'),
            "'a?"
            "?'");
  EXPECT_EQ(in_quotes(std::string(1000, 'x')), "'" + std::string(40, 'x') + "...'");
}

TEST(TextReader, WalksWordsAndLines) {
  TextReader text(" one two\r\n\n three \n4", "t");
  EXPECT_EQ(text.word_in_line(), "one");
  EXPECT_EQ(text.word_in_line(), "two");
  EXPECT_EQ(text.word_in_line(), "");
  EXPECT_EQ(text.word_in_line(), "");
  EXPECT_EQ(text.word(), "three");
  EXPECT_EQ(text.place(), "t: line 3, byte 12");
  text.end_line();
  EXPECT_EQ(text.offset(), 19);
  EXPECT_FALSE(text.at_end());
  EXPECT_EQ(text.word(), "4");
  EXPECT_TRUE(text.at_end());
  EXPECT_EQ(text.word(), "");
}

TEST(TextReader, SaysWhatIsLeftInALine) {
  TextReader text("a b\nc", "t");
  text.word();
  EXPECT_EQ(error_of([&] { text.end_line(); }), "t: line 1, byte 2: 'b' where the line's end is expected");
}

}  // namespace
}  // namespace partpose
