function [result, info] = info(varargin)
% mbk.info  Contents of a recording: channels, rate, gaps, problems.
%
%   RESULT = mbk.info(...) returns the JSON document of 'mbk info --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.info(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.info(FILE)                   a file name, or a cell array of several
%   [...] = mbk.info(T, X, F)                time [s], position [m or rad], force [N or N.m]: one column per axis,
%                                           one or two axes
%   [...] = mbk.info(T, X, F, XR)            also the reference; a fifth array is the acceleration
%   [...] = mbk.info(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           timetable or iddata; units in the field 'units' or in the table
%   [...] = mbk.info(..., NAME, VALUE, ...)  options of 'mbk info' with _ for -, such as
%                                           'axes', 1; flags take true
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.read
  [result, info] = mbk.internal.run('info', varargin);
end
