function [result, info] = explore(varargin)
% mbk.explore  Frequency response with noise and nonlinearity apart, impulse response, reflexes.
%
%   RESULT = mbk.explore(...) is the document that 'mbk explore --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.explore(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.explore(FILE)                   the name of a file, or a cell of several
%   [...] = mbk.explore(T, X, F)                time in s, position in m (rad), force in N (N.m): columns, one axis
%                                           or two
%   [...] = mbk.explore(T, X, F, XR)            with the reference of the perturbation; then perhaps acceleration
%   [...] = mbk.explore(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           a timetable or iddata; units as the field units, or the table, says
%   [...] = mbk.explore(..., NAME, VALUE, ...)  options of 'mbk explore' on the command line, as in
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.tf
  [result, info] = mbk.internal.run('explore', varargin);
end
