function [result, info] = info(varargin)
% mbk.info  What is in a recording: channels, rate, gaps, problems.
%
%   RESULT = mbk.info(...) is the document that 'mbk info --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.info(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.info(FILE)                   the name of a file, or a cell of several
%   [...] = mbk.info(T, X, F)                time in s, position in m (rad), force in N (N.m): columns, one axis
%                                           or two
%   [...] = mbk.info(T, X, F, XR)            with the reference of the perturbation; then perhaps acceleration
%   [...] = mbk.info(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           a timetable or iddata; units as the field units, or the table, says
%   [...] = mbk.info(..., NAME, VALUE, ...)  options of 'mbk info' on the command line, as in
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.read
  [result, info] = mbk.internal.run('info', varargin);
end
