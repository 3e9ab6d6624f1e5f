#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/experiment/protocol/experiment.h"

namespace mbk::protocol {

/// What in a text looks as if it said who somebody is.
enum class PersonalDetail {
  none,
  email,   ///< jane.doe@hospital.org
  title,   ///< a title before a capitalised word: "Mrs Doe", "Dr. J. Doe"
  birth,   ///< a word of birth and a date or year: "born 1.2.1984", "DOB 1984-02-01"
  person,  ///< first and last name, or initial and last name: "Jane Doe", "Doe, Jane", "J. Doe"
};

/// Looks for a detail by its form alone; who somebody is cannot be decided by a program. Letters are those of Latin
/// scripts.
/// @param reference  the text is to refer to a document ("form 12"): here two words in a row that begin with a capital,
///                   neither of them a word of documents, offices or dates, are a person. Elsewhere they are not looked
///                   at: "Relaxed Arm", "Left Hand".
[[nodiscard]] PersonalDetail personal_detail(std::string_view text, bool reference);

/// A warning and what to do about it; empty where nothing was found.
/// @param where  "[person] consent"
[[nodiscard]] std::string personal_warning(std::string_view where, std::string_view text, bool reference);

/// Of every free text of an experiment that goes into its recordings: the reference of the consent form, conditions,
/// names of trials, the file's own name. Each once.
[[nodiscard]] std::vector<std::string> personal_warnings(const std::vector<Trial>& trials);

}  // namespace mbk::protocol
