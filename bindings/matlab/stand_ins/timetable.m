classdef timetable
% What mbk reads of MATLAB's timetable, for tests in Octave, which has none: columns by name, and Properties.
  properties
    columns
    described
  end
  methods
    function this = timetable(times, columns, units)
      this.columns = columns;
      this.described = struct('RowTimes', times, 'VariableNames', {fieldnames(columns)'}, 'VariableUnits', {units});
    end
    function value = subsref(this, path)
      if strcmp(path(1).subs, 'Properties')
        value = this.described;
      else
        value = this.columns.(path(1).subs);
      end
      if numel(path) > 1
        value = subsref(value, path(2:end));
      end
    end
  end
end
