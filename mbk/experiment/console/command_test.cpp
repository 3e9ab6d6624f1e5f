#include "mbk/experiment/console/command.h"

#include <gtest/gtest.h>

#include "mbk/experiment/console/messages.h"

namespace mbk::console {
namespace {

TEST(Command, EveryActionIsReadAsItsSchemaHasIt) {
  for (const auto& [action, word] : kWords<Action>) {
    Command command{action, "because", 3, {}};
    if (action == Action::exclude) command.window = Window{1.5, 4.0};
    const std::string text = *message(command);
    const auto parsed = parse_command(text);
    ASSERT_TRUE(parsed) << text << ": " << parsed.error().line();
    EXPECT_EQ(*message(*parsed), text);
  }
}

TEST(Command, ANoteCarriesItsTextAndAResetItsCode) {
  EXPECT_EQ(parse_command(R"({"command":"note","text":"talked"})")->text, "talked");
  EXPECT_EQ(parse_command(R"({"command":"reset","code":"7"})")->text, "7");
}

TEST(Command, AnExclusionCarriesItsAttemptItsReasonAndItsWindow) {
  const auto whole = parse_command(R"({"command":"exclude","attempt":3,"text":"coughed"})");
  ASSERT_TRUE(whole) << whole.error().line();
  EXPECT_EQ(whole->attempt, 3);
  EXPECT_EQ(whole->text, "coughed");
  EXPECT_FALSE(whole->window);
  const auto part = parse_command(R"({"command":"exclude","attempt":1,"text":"coughed","from_s":1.5,"to_s":4})");
  ASSERT_TRUE(part) << part.error().line();
  EXPECT_EQ(part->window->from, 1.5);
  EXPECT_EQ(part->window->to, 4.0);
  EXPECT_EQ(parse_command(R"({"command":"include","attempt":2})")->attempt, 2);
}

TEST(Command, AnExclusionThatIsNotWholeIsRefused) {
  const std::string begin = R"({"command":"exclude","attempt":)";
  for (const std::string& message :
       {begin + "1}", begin + R"(1,"text":" "})", begin + R"(0,"text":"a"})", begin + R"(-1,"text":"a"})",
        begin + R"(1.5,"text":"a"})", begin + R"("1","text":"a"})", begin + R"(1000000000000,"text":"a"})",
        begin + R"(1,"text":"a","from_s":1})", begin + R"(1,"text":"a","to_s":1})",
        begin + R"(1,"text":"a","from_s":2,"to_s":2})", begin + R"(1,"text":"a","from_s":-1,"to_s":2})",
        std::string(R"({"command":"exclude","text":"a"})"), std::string(R"({"command":"include"})"),
        std::string(R"({"command":"include","attempt":1,"text":"a"})")}) {
    EXPECT_FALSE(parse_command(message)) << message;
  }
}

TEST(Command, WhatIsNoCommandIsRefused) {
  for (const char* const message :
       {"", "{", "[]", "null", "\"stop\"", "{}", R"({"command":1})", R"({"command":"jump"})", R"({"command":"note"})",
        R"({"command":"note","text":" \n"})", R"({"command":"note","text":7})", R"({"command":"stop","code":"1"})",
        R"({"command":"reset","text":"1"})", R"({"command":"stop")", "\xff\xfe"}) {
    EXPECT_FALSE(parse_command(message)) << message;
  }
  EXPECT_FALSE(parse_command(R"({"command":"note","text":")" + std::string(kLongestNote + 1, 'a') + R"("})"));
  EXPECT_FALSE(parse_command(std::string(100'000, '[')));
}

TEST(Command, AKeyThatIsThereTwiceIsRefusedInEachForm) {
  for (const char* const message :
       {R"({"command":"stop","command":"start"})", R"({"command":"start","command":"stop"})",
        R"({"command":"stop","command":"stop"})", R"({"command":"start","com\u006dand":"stop"})",
        R"({"command":"note","text":"a","text":"b"})", R"({"command":"reset","code":"1","command":"note"})"}) {
    const auto command = parse_command(message);
    ASSERT_FALSE(command) << message;
    EXPECT_NE(command.error().message.find("twice"), std::string::npos) << command.error().line();
  }
}

TEST(Command, NothingIsNested) {
  for (const char* const message :
       {R"({"command":{"command":"stop"}})", R"({"command":"stop","more":[]})", R"([{"command":"stop"}])",
        R"({"a":{"command":"stop","command":"start"},"command":"start"})"}) {
    EXPECT_FALSE(parse_command(message)) << message;
  }
}

}  // namespace
}  // namespace mbk::console
