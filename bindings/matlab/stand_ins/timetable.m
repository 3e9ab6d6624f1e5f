classdef timetable < columns_by_name
% What mbk reads of MATLAB's timetable, for tests in Octave, which has none.
  methods
    function this = timetable(times, columns, units)
      this@columns_by_name(columns, units);
      this.described.RowTimes = times;
    end
  end
end
