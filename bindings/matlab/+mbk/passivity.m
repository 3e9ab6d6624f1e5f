function [result, info] = passivity(varargin)
% mbk.passivity  Energy that the limb absorbed, and the prediction of its model.
%
%   RESULT = mbk.passivity(...) returns the JSON document of 'mbk passivity --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.passivity(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.passivity(FILE)                   a file name, or a cell array of several
%   [...] = mbk.passivity(T, X, F)                time [s], position [m or rad], force [N or N.m]: one column per axis,
%                                           one or two axes
%   [...] = mbk.passivity(T, X, F, XR)            also the reference; a fifth array is the acceleration
%   [...] = mbk.passivity(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           timetable or iddata; units in the field 'units' or in the table
%   [...] = mbk.passivity(..., NAME, VALUE, ...)  options of 'mbk passivity' with _ for -, such as
%                                           'axes', 1; flags take true
%
%   [...] = mbk.passivity(INFO)  for a result: the second output of mbk.measure
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.measure, mbk.teleop
  [result, info] = mbk.internal.run('passivity', varargin);
end
