classdef iddata
% What mbk reads of MATLAB's iddata, for tests in Octave.
  properties
    OutputData
    InputData
    Ts
    Tstart
    TimeUnit
    OutputName
    InputName
    OutputUnit
    InputUnit
    Domain = 'Time';
  end
end
