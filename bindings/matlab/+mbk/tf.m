function [result, info] = tf(varargin)
% mbk.tf  Transfer function of one input and one output.
%
%   RESULT = mbk.tf(...) returns the JSON document of 'mbk tf --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.tf(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.tf(FILE)                   a file name, or a cell array of several
%   [...] = mbk.tf(T, X, F)                time [s], position [m or rad], force [N or N.m]: one column per axis,
%                                           one or two axes
%   [...] = mbk.tf(T, X, F, XR)            also the reference; a fifth array is the acceleration
%   [...] = mbk.tf(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           timetable or iddata; units in the field 'units' or in the table
%   [...] = mbk.tf(..., NAME, VALUE, ...)  options of 'mbk tf' with _ for -, such as
%                                           'axes', 1; flags take true
%
%   Example
%     result = mbk.tf(data, 'input', 'torque', 'output', 'angle', 'poles', 4, 'zeros', 3);
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.explore
  [result, info] = mbk.internal.run('tf', varargin);
end
