classdef columns_by_name
% Columns by name, and Properties: what a table and a timetable have in common.
  properties
    columns
    described
  end
  methods
    function this = columns_by_name(columns, units)
      this.columns = columns;
      this.described = struct('VariableNames', {fieldnames(columns)'}, 'VariableUnits', {units});
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
