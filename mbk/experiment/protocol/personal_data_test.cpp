#include "mbk/experiment/protocol/personal_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::protocol {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(PersonalData, AReferenceThatIsANameIsFound) {
  for (const char* text : {"Jane Doe", "Doe, Jane", "J. Doe", "J.Doe", "Anna Maria Müller", "Émile Zola", "Öztürk, A.",
                           "Łukasz Nowak", "signed by Jane Doe", "O'Neill, Pat", "form 12, Jane Doe"}) {
    EXPECT_EQ(personal_detail(text, true), PersonalDetail::person) << text;
  }
}

TEST(PersonalData, AReferenceToADocumentIsNone) {
  for (const char* text : {"form 12",
                           "Form A",
                           "Consent Form 12",
                           "Informed Consent v2",
                           "IRB 2026-017",
                           "BASEC 2026-00123",
                           "Ethics Committee Zürich",
                           "Kantonale Ethikkommission",
                           "University Hospital, Binder 3",
                           "Written Consent",
                           "March 2026",
                           "12 May 2026",
                           "C-017",
                           "EK-2026/12",
                           "KEK Zürich",
                           "Version B",
                           "",
                           "Participant Seven",
                           "form A. 12",
                           "A. B.",
                           "Patient Information 3",
                           "Unterschriebene Einwilligung"}) {
    EXPECT_EQ(personal_detail(text, true), PersonalDetail::none) << text;
  }
}

TEST(PersonalData, CapitalsAreNoNamesElsewhere) {
  for (const char* text : {"Relaxed Arm", "Left Hand", "relaxed", "Abnormal Tone", "Pulled hard, then let go",
                           "Force Task 2", "repeated because of a cough", "MS patients", "a 12.5 N pulse at 3.4.2 s",
                           "Dr", "5 min @ 2 N", "Right Arm, Day 2", "stillborn idea of 1999 trials", "2026-03-01",
                           "birth of an idea", "see p. 12", "born tired"}) {
    EXPECT_EQ(personal_detail(text, false), PersonalDetail::none) << text;
  }
}

TEST(PersonalData, EmailsTitlesAndBirthsAreFoundEverywhere) {
  for (const bool reference : {false, true}) {
    for (const char* text : {"ask jane.doe@hospital.org", "j@x.ch", "<a_b+c@sub.uni-x.de>"}) {
      EXPECT_EQ(personal_detail(text, reference), PersonalDetail::email) << text;
    }
    for (const char* text : {"Mrs Doe was tired", "Dr. Doe", "Prof. J. Doe", "Herr Müller", "Frau Özil"}) {
      EXPECT_EQ(personal_detail(text, reference), PersonalDetail::title) << text;
    }
    for (const char* text : {"born 1.2.1984", "DOB 1984-02-01", "d.o.b. 01/02/84", "geb. 12.3.70", "born in May 1984",
                             "Date of birth: 12 March 1984", "née en 1984"}) {
      EXPECT_EQ(personal_detail(text, reference), PersonalDetail::birth) << text;
    }
  }
}

TEST(PersonalData, AnyBytesAreLookedAt) {
  std::string text;
  for (int i = 0; i < 2048; ++i) text += static_cast<char>((i * 37 + i / 7) % 256);
  for (std::size_t begin = 0; begin < text.size(); begin += 13) {
    (void)personal_warning("note", std::string_view(text).substr(begin, 40), begin % 2 == 0);
  }
}

TEST(PersonalData, EveryFreeTextOfAnExperimentIsLookedAtOnce) {
  auto trials = read_experiment(
      "[recording]\ncondition = \"Relaxed Arm of Mrs Doe\"\n[person]\nnumber = 7\nconsent = \"Jane Doe\"\n"
      "[control]\nkind = \"position\"\n[perturbation]\nkind = \"multisine\"\npeak_deg = 1\nduration_s = 3\n"
      "moving_in_s = 1\n[[trial]]\nname = \"one\"\n[[trial]]\nname = \"two\"\n",
      "study.toml");
  ASSERT_TRUE(trials) << trials.error().line();
  EXPECT_THAT(personal_warnings(*trials),
              ElementsAre(AllOf(HasSubstr("[person] consent"), HasSubstr("'Jane Doe'"), HasSubstr("name")),
                          AllOf(HasSubstr("[recording] condition"), HasSubstr("'Relaxed Arm of Mrs Doe'"),
                                HasSubstr("title"))));
}

}  // namespace
}  // namespace mbk::protocol
