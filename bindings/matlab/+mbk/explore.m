function [result, info] = explore(varargin)
% mbk.explore  Frequency response with noise and nonlinear distortion, impulse response, reflexes.
%
%   RESULT = mbk.explore(...) returns the JSON document of 'mbk explore --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.explore(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.explore(FILE)                   a file name, or a cell array of several
%   [...] = mbk.explore(T, X, F)                time [s], position [m or rad], force [N or N.m]: one column per axis,
%                                           one or two axes
%   [...] = mbk.explore(T, X, F, XR)            also the reference; a fifth array is the acceleration
%   [...] = mbk.explore(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           timetable or iddata; units in the field 'units' or in the table
%   [...] = mbk.explore(..., NAME, VALUE, ...)  options of 'mbk explore' with _ for -, such as
%                                           'axes', 1; flags take true
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.tf
  [result, info] = mbk.internal.run('explore', varargin);
end
