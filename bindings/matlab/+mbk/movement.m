function [result, info] = movement(varargin)
% mbk.movement  Smoothness, path and speed of reaches.
%
%   RESULT = mbk.movement(...) returns the JSON document of 'mbk movement --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.movement(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.movement(FILE)                   a file name, or a cell array of several
%   [...] = mbk.movement(T, X, F)                time [s], position [m or rad], force [N or N.m]: one column per axis,
%                                           one or two axes
%   [...] = mbk.movement(T, X, F, XR)            also the reference; a fifth array is the acceleration
%   [...] = mbk.movement(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           timetable or iddata; units in the field 'units' or in the table
%   [...] = mbk.movement(..., NAME, VALUE, ...)  options of 'mbk movement' with _ for -, such as
%                                           'axes', 1; flags take true
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run('movement', varargin);
end
