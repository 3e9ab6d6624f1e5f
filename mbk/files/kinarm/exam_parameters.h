#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/files/c3d/c3d_parameters.h"

namespace mbk::recording {

/// The value of a GROUP:NAME of an exam.
struct ExamValue {
  bool is_text = false;
  std::vector<std::string> texts;  ///< printable
  std::vector<double> numbers;
};

/// The parameters of an exam or of a trial, by group and name in capitals. The first of several equal names is used.
class ExamParameters {
 public:
  /// Groups whose USED is 0 are omitted.
  [[nodiscard]] static ExamParameters of(const C3dParameters& parameters);

  void add(std::string_view group, std::string_view name, ExamValue value);
  /// Adds the parameters of `others` that these lack.
  void add(const ExamParameters& others);
  /// Removes groups whose USED is 0.
  void drop_unused();

  /// Removes statements about signals that are not in the file, and the name of the file.
  void remove_signals();

  [[nodiscard]] const ExamValue* find(std::string_view group, std::string_view name) const;
  /// The first number, if any.
  [[nodiscard]] std::optional<double> number(std::string_view group, std::string_view name) const;
  /// The first text; "" if there is none.
  [[nodiscard]] std::string text(std::string_view group, std::string_view name) const;

  /// Non-empty texts that may identify the participant, as GROUP:NAME.
  [[nodiscard]] std::vector<std::string> personal_texts() const;

  /// Copies everything that cannot identify the participant into `metadata`, as GROUP_NAME, and lists the rest in a
  /// note. Numbers are copied unless group or name refer to a person; texts only from groups that describe robot, task
  /// and trial, because a text can contain anything.
  void describe(std::map<std::string, std::string>& metadata, std::vector<std::string>& notes) const;

 private:
  std::map<std::string, std::map<std::string, ExamValue, std::less<>>, std::less<>> groups_;
};

}  // namespace mbk::recording
