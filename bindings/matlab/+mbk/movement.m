function [result, info] = movement(varargin)
% mbk.movement  Smoothness, path and speed of reaches.
%
%   RESULT = mbk.movement(...) is the document that 'mbk movement --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.movement(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.movement(FILE)                   the name of a file, or a cell of several
%   [...] = mbk.movement(T, X, F)                time in s, position in m (rad), force in N (N.m): columns, one axis
%                                           or two
%   [...] = mbk.movement(T, X, F, XR)            with the reference of the perturbation; then perhaps acceleration
%   [...] = mbk.movement(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           a timetable or iddata; units as the field units, or the table, says
%   [...] = mbk.movement(..., NAME, VALUE, ...)  options of 'mbk movement' on the command line, as in
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run('movement', varargin);
end
