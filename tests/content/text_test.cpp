#include "content/text.h"

#include <gtest/gtest.h>

namespace probewalk {
namespace {

std::string shortened(std::string text, std::size_t bytes) {
  shorten_text(text, bytes);
  return text;
}

TEST(Text, IsCutOnlyWhereItIsTooLong) {
  EXPECT_EQ(shortened("short", 5), "short");
  EXPECT_EQ(shortened("longer", 5), "lo...");
  EXPECT_EQ(shortened("longer", 3), "...");
  EXPECT_EQ(shortened("longer", 2), "");
}

TEST(Text, IsNeverCutInsideACharacter) {
  const std::string text = "a\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80z";  // 1 + 2 + 3 + 4 + 1 bytes
  EXPECT_EQ(shortened(text, 10), "a\xc3\xa9\xe2\x82\xac...");
  EXPECT_EQ(shortened(text, 8), "a\xc3\xa9...");
  EXPECT_EQ(shortened(text, 5), "a...");
  EXPECT_EQ(shortened(std::string(9, '\x80'), 6), "...") << "what is no UTF-8 ends, too";
}

TEST(Text, WhatSteersATerminalBecomesASpace) {
  EXPECT_EQ(printable("red \x1b[31m text"), "red [31m text");
  EXPECT_EQ(printable("a\nb\r\nc\x7f\x64"), "a b c d");
  EXPECT_EQ(printable("\x07title"), "title");
  EXPECT_EQ(printable("C1 \xc2\x9b" "31m"), "C1 31m");
  EXPECT_EQ(printable("txt\xe2\x80\xae" "fdp"), "txt fdp") << "no right-to-left override";
  EXPECT_EQ(printable("a\xe2\x81\xa6" "b"), "a b");
  EXPECT_EQ(printable("Zo\xc3\xab \xe2\x80\x94 5 \xe2\x82\xac"), "Zo\xc3\xab \xe2\x80\x94 5 \xe2\x82\xac");
  EXPECT_EQ(printable(std::string("nul\0s", 5)), "nul s");
  EXPECT_EQ(printable("cut \xe2\x80"), "cut \xe2\x80");
}

}  // namespace
}  // namespace probewalk
