#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/reproduction.h"

namespace mbk::thesis {

/// A number as it stands in print.
struct PrintedNumber {
  std::string text;     ///< with every digit: "4.0"
  double value = 0;     ///< NaN where the cell holds words
  double rounding = 0;  ///< half a unit of its last digit

  [[nodiscard]] double low() const { return value - rounding; }
  [[nodiscard]] double high() const { return value + rounding; }
};

/// A printed table, by the names of its rows and columns.
class PrintedTable {
 public:
  std::vector<std::string> columns;
  std::map<std::string, std::vector<PrintedNumber>> rows;

  [[nodiscard]] const PrintedNumber* find(const std::string& row, const std::string& column) const;
};

/// A, R and θ of one printed ellipse (Dyck 2013, tables 3.3 and 3.5).
struct PrintedEllipse {
  PrintedNumber area, shape, orientation;  ///< orientation in degrees
};

/// One participant's row of those tables: inertia, damping, stiffness.
struct PrintedArm {
  std::string name;  ///< "P1"
  std::array<PrintedEllipse, 3> ellipses;
};

/// One stiffness (k_xx, k_yy, k_s) or one mass of tables 5.1 and 5.4.
struct PrintedRig {
  std::string name;  ///< "K1", "M1"
  std::vector<PrintedNumber> theoretical, error_method_1, error_method_2;
};

/// Printed numbers from which others follow. What is computed from the source rests on these alone.
struct Given {
  std::vector<PrintedArm> sinusoidal, underdamped;
  std::vector<PrintedRig> stiffnesses, masses;
  std::map<std::string, PrintedTable> tables;  ///< all of them as they stand, by their ids

  /// The number in the column "value" of a given table; NaN where there is none.
  [[nodiscard]] double number(const std::string& table, const std::string& row) const;
};

/// What the source printed.
struct Source {
  std::string name;
  Given given;
  std::map<std::string, PrintedTable> printed;  ///< by the id of ReproducedTable; only ever compared with
};

/// thesis/source.json as it stood when the program was built.
[[nodiscard]] std::string_view source_text();

/// @fails  data: not JSON of that shape; a given table is missing.
[[nodiscard]] Result<Source> read_source(std::string_view json);

/// Puts the printed numbers beside ours and says how they stand to each other; touches nothing of ours.
void compare(const Source& source, Exhibit& exhibit);

}  // namespace mbk::thesis
