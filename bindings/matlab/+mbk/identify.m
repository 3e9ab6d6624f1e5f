function [result, info] = identify(varargin)
% mbk.identify  Model only: M, B, K and x0 with intervals and fit.
%
%   RESULT = mbk.identify(...) returns the JSON document of 'mbk identify --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.identify(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.identify(FILE)                   a file name, or a cell array of several
%   [...] = mbk.identify(T, X, F)                time [s], position [m or rad], force [N or N.m]: one column per axis,
%                                           one or two axes
%   [...] = mbk.identify(T, X, F, XR)            also the reference; a fifth array is the acceleration
%   [...] = mbk.identify(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           timetable or iddata; units in the field 'units' or in the table
%   [...] = mbk.identify(..., NAME, VALUE, ...)  options of 'mbk identify' with _ for -, such as
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.measure
  [result, info] = mbk.internal.run('identify', varargin);
end
