#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/files/recording/si_units.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// A channel that mbk knows: one row of the channel table of the documentation.
struct ChannelKind {
  std::string_view name;
  std::string_view alias;  ///< "x" and "xr" are aliases of two kinds: of one axis and of two
  std::span<const Dimension>
      measures;                    ///< possible quantities; if there are several, the file must state which; none: any
  std::string_view frame;          ///< "base", "joint" or ""
  int axes;                        ///< 1: of one axis, 2: of several, 3: of the third axis; 0: of any number
  int logs_row;                    ///< 1-based row of the 19-row `logs` matrix; 0: it has none
  bool first_unless_said = false;  ///< of several quantities, the first is the default: joints turn
  bool only_if_asked = false;      ///< not recognised by name alone: input and output are ambiguous names

  /// SI unit, or "" if several are possible and there is no default.
  [[nodiscard]] std::string_view default_unit() const {
    return measures.size() == 1 || first_unless_said ? si_unit(measures.front()) : std::string_view();
  }
  [[nodiscard]] bool accepts(const Unit& unit) const;
};

inline constexpr int kLogsRows = 19;
inline constexpr int kMaxJoints = 8;

/// Every kind, time first, in the order of the documentation.
[[nodiscard]] std::span<const ChannelKind> channel_kinds();

/// The channels in the order of the documentation, then other names alphabetically: the order in which files are
/// written.
[[nodiscard]] std::vector<const Channel*> in_order(const std::vector<Channel>& channels);

/// The kinds that a name or alias can mean: none, one, or two ("x", "xr"). Case is ignored, except in names of one
/// letter and in Vx and Vy: vx is a velocity. A name such as emg_biceps is of the kind "emg".
[[nodiscard]] std::vector<const ChannelKind*> kinds_called(std::string_view name);

/// The channel of a column whose name contains the word EMG, "emg_biceps" of "Biceps EMG" and "emg_1" of "EMG1",
/// without the unit that the name may end with; "" of any other. It is of the kind "emg", whatever follows.
[[nodiscard]] std::string emg_channel(std::string_view name);

/// The known name or alias most similar to `name`.
[[nodiscard]] std::string_view nearest_channel_name(std::string_view name);

/// 1 or 2, from unambiguous names: `F` means one axis, `y` or `Fx` two; two by default. A third axis is never implied:
/// a column `z` may be anything.
[[nodiscard]] int axes_of(std::span<const std::vector<const ChannelKind*>> meanings);

/// The one of `kinds` for this number of axes, or nullptr. With two axes also that of a third one.
[[nodiscard]] const ChannelKind* kind_for_axes(std::span<const ChannelKind* const> kinds, int axes);

/// Whether a column name denotes a current: "i1 [A]", "motor_mA", "current_1", "Iq". A "current_torque"
/// does not.
[[nodiscard]] bool names_a_current(std::string_view name);

/// A column name taken apart: "hand_x_mm", "hand_x [mm]", "hand_x (mm)", "hand_x in mm", "hand_x mm" and "hand_x/mm"
/// are hand_x in mm.
struct ColumnName {
  std::vector<const ChannelKind*> kinds;  ///< empty: unknown name
  const Unit* unit = nullptr;             ///< nullptr: no unit in the name
};
[[nodiscard]] ColumnName parse_column_name(std::string_view name);

}  // namespace mbk::recording
