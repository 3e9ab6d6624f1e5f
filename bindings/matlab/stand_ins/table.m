classdef table < columns_by_name
% What mbk reads of MATLAB's table, for tests in Octave, which has none.
  methods
    function this = table(columns, units)
      this@columns_by_name(columns, units);
    end
  end
end
