#include "mbk/experiment/console/texts.h"

#include <gtest/gtest.h>

namespace mbk::console {
namespace {

std::string whole(const std::string& more = "") {
  std::string text = "language = \"fr\"\n";
  for (const std::string_view key : kTextKeys) text += std::string(key) + " = \"«" + std::string(key) + "»\"\n";
  return text + more;
}

TEST(Texts, TheReadyOnesAreEnglishAndGerman) {
  for (const auto& [name, word] : {std::pair{"en", "Relax"}, {"de", "locker"}}) {
    const auto texts = find_texts(name, {"relaxed"});
    ASSERT_TRUE(texts) << texts.error().line();
    EXPECT_EQ(texts->language, name);
    EXPECT_NE(texts->sentences.at("relax").find(word), std::string::npos);
    EXPECT_EQ(texts->sentences.size(), kTextKeys.size());
  }
}

TEST(Texts, AStudyHasItsOwnWordsForATrial) {
  const auto texts = read_texts(whole("[trial.rigid]\nhold = \"Résistez.\"\n"), "fr.toml", {"relaxed", "rigid"});
  ASSERT_TRUE(texts) << texts.error().line();
  EXPECT_EQ(texts->sentences.at("hold"), "«hold»");
  EXPECT_EQ(texts->trials.at("rigid").at("hold"), "Résistez.");
  EXPECT_FALSE(texts->trials.contains("relaxed"));
}

TEST(Texts, WhatIsMissingEmptyOrNotKnownIsRefusedWithItsPlace) {
  const auto refused = [](const std::string& text, std::string_view what) {
    const auto texts = read_texts(text, "fr.toml", {"rigid"});
    ASSERT_FALSE(texts) << text;
    EXPECT_NE(texts.error().line().find(what), std::string::npos) << texts.error().line();
  };
  refused("language = \"fr\"\n", "wait");
  refused(whole("hols = \"\"\n"), "hols");
  refused(whole("[trial.rigid]\nhold = \"\"\n"), "hold");
  refused(whole("[trial.ridgid]\nhold = \"Résistez.\"\n"), "ridgid");
  refused(whole("hold = \"twice\"\n"), "hold");
  refused("language = 7\n", "language");
}

TEST(Texts, ANameThatIsNeitherReadyNorAFileIsSaidWithTheReadyOnes) {
  const auto texts = find_texts("/nowhere/fr.toml", {});
  ASSERT_FALSE(texts);
  EXPECT_NE(texts.error().line().find("de, en"), std::string::npos) << texts.error().line();
}

}  // namespace
}  // namespace mbk::console
