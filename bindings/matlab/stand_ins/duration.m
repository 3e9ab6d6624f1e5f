classdef duration
% What mbk reads of MATLAB's duration, for tests in Octave: seconds(duration).
  properties
    milliseconds
  end
  methods
    function this = duration(milliseconds)
      this.milliseconds = milliseconds;
    end
    function value = seconds(this)
      value = this.milliseconds / 1000;
    end
  end
end
