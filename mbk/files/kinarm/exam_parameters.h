#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/files/c3d/c3d_parameters.h"

namespace mbk::recording {

/// What stands behind a GROUP:NAME of an exam.
struct ExamValue {
  bool is_text = false;
  std::vector<std::string> texts;  ///< printable
  std::vector<double> numbers;
};

/// The parameters of an exam or of a trial, by group and name in capitals. The first of a name counts.
class ExamParameters {
 public:
  /// Groups whose USED is 0 are left out.
  [[nodiscard]] static ExamParameters of(const C3dParameters& parameters);

  void add(std::string_view group, std::string_view name, ExamValue value);
  /// Takes over what `others` have and these do not.
  void add(const ExamParameters& others);
  /// Takes groups out whose USED is 0.
  void drop_unused();

  /// Takes out what the file of an exam says of signals that it does not hold, and its name.
  void remove_signals();

  [[nodiscard]] const ExamValue* find(std::string_view group, std::string_view name) const;
  /// The first number; nothing where there is none.
  [[nodiscard]] std::optional<double> number(std::string_view group, std::string_view name) const;
  /// The first text; "" where there is none.
  [[nodiscard]] std::string text(std::string_view group, std::string_view name) const;

  /// Texts that may say who the person is, as GROUP:NAME; those that are empty are not among them.
  [[nodiscard]] std::vector<std::string> personal_texts() const;

  /// Puts everything that cannot say who the person is into `metadata`, as GROUP_NAME, and names what stays in the file
  /// in a note. Numbers are taken unless group or name speak of a person; texts only from groups that describe robot,
  /// task and trial, since anything can stand in a text.
  void describe(std::map<std::string, std::string>& metadata, std::vector<std::string>& notes) const;

 private:
  std::map<std::string, std::map<std::string, ExamValue, std::less<>>, std::less<>> groups_;
};

}  // namespace mbk::recording
