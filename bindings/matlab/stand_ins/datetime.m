classdef datetime
% What mbk reads of MATLAB's datetime, for tests in Octave: the first of several, and their differences.
  properties
    milliseconds
  end
  methods
    function this = datetime(milliseconds)
      this.milliseconds = milliseconds;
    end
    function value = subsref(this, path)
      if strcmp(path(1).type, '()')
        value = datetime(this.milliseconds(path(1).subs{:}));
      else
        value = this.milliseconds;
      end
    end
    function value = minus(this, other)
      value = duration(this.milliseconds - other.milliseconds);
    end
  end
end
